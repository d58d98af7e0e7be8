//! The back-ends, which run the tasks: one file each, behind one trait.
#[cfg(any(feature = "tbb", feature = "openmp"))]
mod foreign;
#[cfg(feature = "openmp")]
mod openmp;
mod rayon;
mod stealing;
#[cfg(feature = "tbb")]
mod tbb;

pub use self::stealing::Stealing;

use super::core::Core;

use super::group::Group;
use super::job::{Queue, Submit};
use super::plan::Backend;
use std::io;
use std::sync::Arc;

/// A back-end's threads.
pub trait Engine: Submit + Send + Sync {
    /// Calls `body`, which does not panic, with the queue for the tasks of the group; returns when all of them have ended.
    /// Of a pool's engines one is in this call at a time.
    fn region(&self, group: &Group, body: &mut dyn FnMut(&dyn Queue));
}

/// The threads of a back-end other than our own; nothing where it was not built in.
pub fn engine(backend: Backend, core: &Arc<Core>) -> io::Result<Option<Box<dyn Engine>>> {
    Ok(match backend {
        Backend::Rayon => Some(Box::new(rayon::Rayon::new(core)?)),
        #[cfg(feature = "tbb")]
        Backend::Tbb => Some(Box::new(tbb::new(core))),
        #[cfg(feature = "openmp")]
        Backend::OpenMp => Some(Box::new(openmp::new(core))),
        _ => None,
    })
}
