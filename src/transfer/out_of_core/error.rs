//! Errors of transfers between meshes larger than memory.

/// Why nothing was transferred.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A mesh cannot be read, or the scratch folder not be written.
    #[error(transparent)]
    File(#[from] crate::mesh::io::Error),
    /// The fields cannot be read, or are wrong.
    #[error(transparent)]
    Field(Box<dyn std::error::Error + Send + Sync>),
    /// A mesh cannot be used.
    #[error(transparent)]
    Mesh(#[from] crate::transfer::Error),
    /// Less than a part of a mesh takes.
    #[error(
        "{} MB of memory are too few for a transfer of {width} values a vertex on {threads} thread{}: give --memory {}MB or more{}",
        .memory / 1_000_000, if *threads > 1 { "s" } else { "" }, .needed.div_ceil(1_000_000), if *threads > 1 { ", or fewer --threads" } else { "" }
    )]
    Memory {
        /// Values of a vertex.
        width: usize,
        /// Threads.
        threads: usize,
        /// Bytes that may be used.
        memory: usize,
        /// Bytes that are needed.
        needed: usize,
    },
    /// More than can be told apart.
    #[error("the {mesh} mesh has {tets} tetrahedra, but with --memory only {} can be", u32::MAX - 1)]
    Tetrahedra {
        /// Which mesh.
        mesh: crate::transfer::Which,
        /// Its tetrahedra.
        tets: usize,
    },
}
