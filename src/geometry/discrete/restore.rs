//! Writing the features of a discrete geometry back into a mesh.
use super::Discrete;
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::{Association, TetMesh};

impl Discrete {
    /// Reference of a face's triangles in the mesh that the geometry was made of.
    pub fn face_reference(&self, face: u32) -> i32 {
        self.face_refs[face as usize]
    }

    /// Reference of the listed mesh edges that an edge was made of; none if the file did not list it.
    pub fn edge_reference(&self, edge: u32) -> Option<i32> {
        self.edge_refs[edge as usize]
    }

    /// Writes the features into a mesh that is classified on this geometry, as the first mesh had them: the references of triangles, the
    /// ridges as edges (with reference 0 where the file had not listed them), and the corners. Required
    /// edges stay. There is no association: the entities of a discrete geometry mean nothing outside this run.
    pub fn restore(&self, mesh: &mut TetMesh, classification: &Classification) {
        mesh.association = Association::default();
        mesh.triangles.refs = classification.faces.iter().map(|&face| self.face_reference(face)).collect();
        let ridges = classification.ridges.iter();
        mesh.replace_edges(ridges.map(|&(nodes, edge)| (nodes, self.edge_reference(edge).unwrap_or(0))));
        let is_corner = |v: &u32| matches!(classification.entities[*v as usize], Entity::Vertex(_));
        mesh.corners = (0..mesh.vertices.len() as u32).filter(is_corner).collect();
    }
}
