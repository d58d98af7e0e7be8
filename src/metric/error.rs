//! Errors of metric fields.
use super::held::{GREATEST_RATIO, SIZES};
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
        "{}: {found}; a metric file holds one field at the vertices: symmetric tensors (libMeshb type 3), or scalars (type 1), which are \
         isotropic sizes",
        path.display()
    )]
    Kind {
        /// The metric file.
        path: PathBuf,
        /// What it holds.
        found: String,
    },
    /// A scalar of a metric file is no size.
    #[error(
        "{}: the size of vertex {vertex} is {size}: a scalar of a metric file is an isotropic size, a length from {:.0e} to {:.0e}; a \
         solution goes in by --field",
        path.display(), SIZES.start(), SIZES.end()
    )]
    NotASize {
        /// The metric file.
        path: PathBuf,
        /// Vertex, from 1.
        vertex: usize,
        /// What stands there.
        size: f64,
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
    /// A tensor that a file cannot hold.
    #[error(
        "{}: the metric of vertex {vertex} cannot be written: its sizes would be {:.3e}, {:.3e} and {:.3e}, and a tensor of doubles holds sizes \
         from {:.0e} to {:.0e}, in slanting directions no more than {:.0e} times the least; bound them by `geo-adapt metric limit` \
         (--hmin, --hmax, --aspect-ratio), or give another complexity",
        path.display(), sizes[0], sizes[1], sizes[2], SIZES.start(), SIZES.end(), GREATEST_RATIO
    )]
    NotHeld {
        /// The metric file.
        path: PathBuf,
        /// Vertex, from 1.
        vertex: usize,
        /// Its sizes.
        sizes: [f64; 3],
    },
    /// A metric beyond what can be computed with.
    #[error(
        "the metric of vertex {vertex} asks for sizes of {:.3e}, {:.3e} and {:.3e}: they must lie between {:.0e} and {:.0e}; are mesh and \
         metric in the same units? --hmin and --hmax bound them, here or in `geo-adapt metric limit`",
        sizes[0], sizes[1], sizes[2], SIZES.start(), SIZES.end()
    )]
    Sizes {
        /// Vertex, from 1.
        vertex: usize,
        /// Its sizes.
        sizes: [f64; 3],
    },
    /// No analytic field of that name.
    #[error("no analytic field is called '{0}': choose linear, polar-1 or polar-2")]
    Name(String),
}
