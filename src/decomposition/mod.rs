//! Domain decomposition: a mesh is cut into parts, each part is adapted by the kernel as it is while its faces to other parts stay, and the
//! cuts move, until no tetrahedron has felt a cut. Where the cuts lie depends on the mesh alone, so the result does too.
//!
//! The mesh is read a slice at a time ([`input`]), and its metric lies in blocks where it is larger than a part ([`ground`]).
//! [`rounds`] says what is done when. A [`piece`] is some of the mesh with all that is known there; vertices of several pieces are known by ids
//! that last. [`cuts`] finds planes that cross few tetrahedra, [`split`] and [`join`] bring the tetrahedra to their parts, [`part`] adapts
//! one, [`zones`] finds what the cuts have left to be done, and [`outline`] numbers the vertices as one mesh. Pieces lie on a [`shelf`], in
//! memory or on a disk, and go from rank to rank as [`bytes`]. [`times`] says what parts took, [`former`] how good the
//! mesh is where cuts were.
mod adapting;
mod begin;
mod bytes;
mod cuts;
mod deal;
mod finished;
mod former;
mod ground;
mod input;
mod join;
mod journal;
mod manifold;
mod maps;
mod outline;
mod part;
mod piece;
mod region;
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

pub use former::{NearCuts, Quality};
pub use input::{Files, InMemory, Input, MetricOf, Shell, Skin, logs_on};
pub use rounds::Common;
pub use run::{Adapted, Given, adapt};
pub use shelf::{JOURNAL, Shelf};
pub use sizes::{Sizes, wanted_vertices};
pub use slices::{Measured, Slice};
pub use times::{Numbered, Told};

use std::path::Path;

/// A run by parts that failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The kernel refuses the mesh.
    #[error(transparent)]
    Kernel(#[from] crate::adapt::Error),
    /// A piece could not be kept.
    #[error(transparent)]
    Shelf(#[from] shelf::Error),
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] crate::mesh::io::Error),
    /// A file of a metric cannot be read, or holds sizes that cannot be computed with.
    #[error(transparent)]
    Metric(#[from] crate::metric::Error),
    /// Triangles are missing.
    #[error(
        "triangles are missing on its boundary or between its regions, which are added where the mesh is read as a whole: give more --memory, or \
         adapt a result of geo-adapt"
    )]
    Incomplete,
    /// Another rank's error, or one of the caller's.
    #[error("{0}")]
    Told(String),
    /// Another rank sent what this one does not understand.
    #[error("a message of another process is not understood: do all run the same program on machines of one kind?")]
    Message,
}

impl Error {
    /// As it is told of the mesh in this file: some name their file themselves.
    pub fn of(&self, mesh: &Path) -> String {
        match self {
            Self::Kernel(_) | Self::Incomplete | Self::Metric(crate::metric::Error::Sizes { .. }) => {
                format!("{}: {self}", mesh.display())
            }
            _ => self.to_string(),
        }
    }
}
