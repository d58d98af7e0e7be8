//! Domain decomposition: a mesh is cut into parts, each part is adapted by the kernel as it is while its faces to other parts stay, and the
//! cuts move, until no tetrahedron has felt a cut. Where the cuts lie depends on the mesh alone, so the result does too.
//!
//! [`rounds`] says what is done when. A [`piece`] is some of the mesh with all that is known there; vertices of several pieces are known by ids
//! that last. [`cuts`] finds planes that cross few tetrahedra, [`split`] and [`join`] bring the tetrahedra to their parts, [`part`] adapts
//! one, [`zones`] finds what the cuts have left to be done, and [`outline`] numbers the vertices as one mesh. Pieces lie on a [`shelf`], in
//! memory or on a disk, and go from rank to rank as [`bytes`]. [`times`] says what parts took.
mod adapting;
mod bytes;
mod cuts;
mod deal;
mod finished;
mod join;
mod journal;
mod manifold;
mod maps;
mod outline;
mod part;
mod piece;
mod rounds;
mod run;
mod shelf;
mod sizes;
mod slices;
mod split;
#[cfg(test)]
mod tests;
mod threads;
mod times;
mod zones;

pub use rounds::Common;
pub use run::{Adapted, adapt};
pub use shelf::{JOURNAL, Shelf};
pub use sizes::{Sizes, wanted_vertices};
pub use slices::{Measured, Slice};
pub use times::{Numbered, Told};

/// A run by parts that failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The kernel refuses the mesh.
    #[error(transparent)]
    Kernel(#[from] crate::adapt::Error),
    /// A piece could not be kept.
    #[error(transparent)]
    Shelf(#[from] shelf::Error),
    /// Another rank's error, or one of the caller's.
    #[error("{0}")]
    Told(String),
    /// Another rank sent what this one does not understand.
    #[error("a message of another process is not understood: do all run the same program on machines of one kind?")]
    Message,
}
