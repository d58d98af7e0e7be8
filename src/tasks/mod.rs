//! Threads and the trace of a run; knows nothing of meshes.
mod pool;
mod stage;

pub use pool::{Error, Pool};
pub use stage::stage;
