//! Why a mesh does not fit a model.

/// Why a mesh does not fit a model: which, where, how far, and the remedy. Numbers count from 1, as in files.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is no surface to classify.
    #[error("the mesh has no boundary triangles; give it triangles on the boundary of its tetrahedra")]
    NoTriangles,
}
