//! What a classification holds.
use crate::geometry::{Entity, Evaluate};
use crate::mesh::vector::Vec3;

/// A mesh put on a model. Entity indices count from 0, as in [`crate::geometry::Topology`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Classification {
    /// For each mesh vertex its entity of lowest dimension.
    pub entities: Vec<Entity>,
    /// For each mesh vertex its parameters on that entity: (t, 0) on an edge, (u, v) on a face, zeros else.
    pub parameters: Vec<[f64; 2]>,
    /// For each mesh vertex its closest point on its entity, model units; inside, the vertex itself. Starting from
    /// these puts the mesh exactly on the model.
    pub projected: Vec<Vec3>,
    /// Mesh edges on model edges: the nodes, and the model edge. Holds every one that the mesh has, listed in the file or not.
    pub ridges: Vec<([u32; 2], u32)>,
    /// For each triangle of the mesh the model face.
    pub faces: Vec<u32>,
}

impl Classification {
    /// Parameters of a mesh vertex on a face, for a guess: none at the vertices of the model.
    pub fn parameters_on(&self, evaluator: &mut impl Evaluate, vertex: u32, face: u32) -> Option<[f64; 2]> {
        let parameters = self.parameters[vertex as usize];
        match self.entities[vertex as usize] {
            Entity::Face(own) if own == face => Some(parameters),
            Entity::Edge(edge) => evaluator.edge_on_face(edge, parameters[0], face),
            _ => None,
        }
    }
}
