//! Jobs are taken from the queue, and each is run as a process.
mod endings;
mod events;
mod folder;
mod hub;
mod job;
mod pool;
mod process;
pub mod protocol;
mod running;
mod worker;

pub use folder::LOG_NAME;
pub use hub::{Hub, Seen};
pub use worker::{Shop, start};
