//! Errors of metric fields.
use std::path::PathBuf;

/// What is wrong with a metric, where, and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file could not be read or written.
    #[error(transparent)]
    File(#[from] crate::mesh::io::Error),
    /// The file has another number of vertices than the mesh.
    #[error(
        "{}: metric at {found} vertices, but the mesh has {expected}: give the metric that was made for this mesh",
        path.display()
    )]
    Count {
        /// The metric file.
        path: PathBuf,
        /// Vertices in the file.
        found: usize,
        /// Vertices of the mesh.
        expected: usize,
    },
    /// The file holds no metric, or several.
    #[error(
        "{}: {found}; a metric file holds one field of symmetric tensors (libMeshb type 3) at the vertices",
        path.display()
    )]
    Kind {
        /// The metric file.
        path: PathBuf,
        /// What it holds.
        found: String,
    },
    /// A tensor is not positive definite.
    #[error(
        "{}: metric of vertex {vertex} is not positive definite (eigenvalues {:.3e}, {:.3e}, {:.3e}): every eigenvalue must be \
         positive and finite (1/size²), the six terms in the order 11 12 22 13 23 33; limit the largest size where the metric was made",
        path.display(), eigenvalues[0], eigenvalues[1], eigenvalues[2]
    )]
    NotPositive {
        /// The metric file.
        path: PathBuf,
        /// Vertex, from 1.
        vertex: usize,
        /// Its eigenvalues.
        eigenvalues: [f64; 3],
    },
    /// No analytic field of that name.
    #[error("no analytic field is called '{0}': choose linear, polar-1 or polar-2")]
    Name(String),
}
