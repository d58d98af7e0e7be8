//! Jobs are taken from the queue, and each is run as a process.
mod events;
mod folder;
mod hub;
mod pool;
mod process;
pub mod protocol;
mod worker;

pub use folder::LOG_NAME;
pub use hub::{Hub, Seen};
pub use worker::{Shop, start};
