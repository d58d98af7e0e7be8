//! What `geo-adapt serve` promises, of the built program over its socket.
#![cfg(target_os = "linux")]
#[path = "../common/mod.rs"]
mod common;

#[path = "../suite/browser.rs"]
mod browser;
mod client;
mod damaged;
mod jobs;
mod kills;
mod load;
mod loops;
mod mutations;
mod owners;
mod postgres;
mod service;
mod uploads;
mod workbench;
