//! Errors of metrics of meshes larger than memory.
use crate::metric::multiscale::{self, Unreachable};

/// Why there is no metric.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The mesh or a field cannot be read, or the scratch folder not be written.
    #[error(transparent)]
    File(#[from] crate::mesh::io::Error),
    /// The metric cannot be written.
    #[error(transparent)]
    Metric(#[from] crate::metric::Error),
    /// No metric follows from the fields.
    #[error(transparent)]
    Multiscale(#[from] multiscale::Error),
    /// A piece of the mesh has too few vertices for any fit.
    #[error(
        "vertex {} is in a piece of the mesh with too few points to tell second derivatives anywhere; take such pieces away, or leave --memory out",
        vertex + 1
    )]
    TooFew {
        /// The vertex, from 0.
        vertex: u32,
    },
    /// Some bytes a vertex are held, and do not fit.
    #[error(
        "{} MB of memory are too few for this mesh of {vertices} vertices: give --memory {}MB or more{}",
        .memory / 1_000_000, .needed.div_ceil(1_000_000), if *threads > 1 { ", or fewer --threads" } else { "" }
    )]
    Memory {
        /// Vertices of the mesh.
        vertices: usize,
        /// Threads.
        threads: usize,
        /// Bytes that may be used.
        memory: usize,
        /// Bytes that are needed.
        needed: usize,
    },
    /// More than can be told apart.
    #[error("the mesh has {tets} tetrahedra, but with --memory only {} can be", u32::MAX - 1)]
    Tetrahedra {
        /// Its tetrahedra.
        tets: usize,
    },
}

impl From<Unreachable> for Error {
    fn from(why: Unreachable) -> Self {
        Self::Multiscale(why.into())
    }
}
