//! The mesh's references of the model's faces and edges.
use crate::geometry::classify::Classification;
use crate::geometry::discrete::outward_triangles;
use crate::geometry::{Geometry, Model};
use crate::mesh::TetMesh;
use crate::tasks::Team;
use std::collections::HashMap;

/// The mesh's references of the model's faces and edges, and which way it turns a face's triangles.
#[derive(Clone)]
pub struct References {
    /// By face.
    pub faces: Vec<i32>,
    /// Whether the triangles of a face look into the domain (between regions: into the lesser one).
    pub inward: Vec<bool>,
    /// By edge.
    pub edges: Vec<i32>,
}

impl References {
    /// Those of a mesh on its model.
    pub fn of(team: Team<'_>, mesh: &TetMesh, place: &Classification, model: &Model) -> Self {
        Self {
            faces: face_refs(mesh, place, model),
            inward: inward_faces(team, mesh, place, model),
            edges: edge_refs(mesh, place, model),
        }
    }

    /// The same, with all triangles outwards.
    pub fn outwards(&self) -> Self {
        Self { inward: vec![false; self.inward.len()], ..self.clone() }
    }
}

/// The reference of each model face: that of its first triangle.
fn face_refs(mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<i32> {
    let mut refs: Vec<Option<i32>> = vec![None; model.topology().faces.len()];
    for (&face, &reference) in place.faces.iter().zip(&mesh.triangles.refs) {
        refs[face as usize].get_or_insert(reference);
    }
    refs.iter().enumerate().map(|(face, reference)| reference.unwrap_or(face as i32 + 1)).collect()
}

/// Whether most triangles of a face look into the domain, for each face. In the files of some programs all do.
fn inward_faces(team: Team<'_>, mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<bool> {
    let mut outward = vec![0i64; model.topology().faces.len()];
    for ((given, turned), &face) in mesh.triangles.nodes.iter().zip(outward_triangles(team, mesh)).zip(&place.faces) {
        outward[face as usize] += if *given == turned { 1 } else { -1 };
    }
    outward.into_iter().map(|balance| balance < 0).collect()
}

/// The reference of each model edge: that of its first listed mesh edge.
fn edge_refs(mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<i32> {
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let listed: HashMap<[u32; 2], i32> = mesh.edges.iter().map(|(nodes, r)| (sorted(nodes), r)).collect();
    let mut refs: Vec<Option<i32>> = vec![None; model.topology().edges.len()];
    for &(nodes, edge) in &place.ridges {
        if let (slot @ None, Some(&reference)) = (&mut refs[edge as usize], listed.get(&sorted(nodes))) {
            *slot = Some(reference);
        }
    }
    refs.iter().enumerate().map(|(edge, reference)| reference.unwrap_or(edge as i32 + 1)).collect()
}
