//! Errors of the inspection of files.

/// Why a mesh cannot be inspected from its file.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The mesh cannot be read.
    #[error(transparent)]
    Mesh(#[from] crate::mesh::io::Error),
    /// The metric cannot be read.
    #[error(transparent)]
    Metric(#[from] crate::metric::Error),
    /// The boundary is held as a whole, and does not fit.
    #[error(
        "{} MB of memory are too few for this mesh, with a boundary of {triangles} triangles that is held as a whole: give --memory {}MB or more",
        .memory / 1_000_000, .needed.div_ceil(1_000_000)
    )]
    Memory {
        /// Triangles of the boundary, and inside.
        triangles: usize,
        /// Bytes that may be used.
        memory: usize,
        /// Bytes that are needed.
        needed: usize,
    },
    /// More than can be told apart.
    #[error("the mesh has {tets} tetrahedra, but only {} can be inspected", u32::MAX - 1)]
    Tetrahedra {
        /// Its tetrahedra.
        tets: usize,
    },
}
