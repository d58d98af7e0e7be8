//! Classification: which B-rep entity each boundary vertex, ridge edge and triangle of a mesh lies on.
use super::Entity;

/// A mesh put on a model. Entity indices count from 0, as in [`super::Topology`].
#[derive(Clone, Debug, Default)]
pub struct Classification {
    /// For each mesh vertex its entity of lowest dimension.
    pub entities: Vec<Entity>,
    /// For each mesh vertex its parameters on that entity: (t, 0) on an edge, (u, v) on a face, zeros else.
    pub parameters: Vec<[f64; 2]>,
    /// Mesh edges on model edges: the nodes, and the model edge. Holds every one that the mesh has, listed in the file or not.
    pub ridges: Vec<([u32; 2], u32)>,
    /// For each triangle of the mesh the model face.
    pub faces: Vec<u32>,
}

/// Why a mesh does not fit a model.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// To be refined by the classification.
    #[error("{0}")]
    Unfit(String),
}
