//! Writing the features of a discrete geometry back into a mesh.
use super::Discrete;
use crate::geometry::Entity;
use crate::geometry::classify::Classification;
use crate::mesh::adjacency::sorted2;
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

    /// Takes over the references of a mesh that is put on this geometry, for each face and edge on which it has but one: so they come back
    /// where [`Discrete::restore`] writes them.
    pub fn adopt_references(&mut self, mesh: &TetMesh, place: &Classification) {
        let mut found: Vec<Option<Option<i32>>> = vec![None; self.face_refs.len()];
        for (&reference, &face) in mesh.triangles.refs.iter().zip(&place.faces) {
            note(&mut found[face as usize], reference);
        }
        for (own, found) in self.face_refs.iter_mut().zip(found) {
            *own = found.flatten().unwrap_or(*own);
        }
        let mut listed: Vec<([u32; 2], i32)> = mesh.edges.iter().map(|(nodes, r)| (sorted2(nodes), r)).collect();
        listed.sort_unstable();
        let mut found = vec![None; self.edge_refs.len()];
        for &(nodes, edge) in &place.ridges {
            if let Ok(at) = listed.binary_search_by_key(&sorted2(nodes), |entry| entry.0) {
                note(&mut found[edge as usize], listed[at].1);
            }
        }
        for (own, found) in self.edge_refs.iter_mut().zip(found) {
            *own = found.flatten().or(*own);
        }
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

/// Notes a reference: nothing yet, one, or several.
fn note(found: &mut Option<Option<i32>>, reference: i32) {
    *found = match *found {
        None => Some(Some(reference)),
        Some(one) => Some(one.filter(|&one| one == reference)),
    };
}
