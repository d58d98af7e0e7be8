//! A model's names on a mesh of it.
use super::classify::Classification;
use super::{Geometry, Model, Names};
use crate::mesh::TetMesh;
use std::collections::{BTreeMap, BTreeSet};

/// The model's names by the references of a mesh that lies on it.
pub fn on_mesh(mesh: &TetMesh, place: &Classification, model: &Model) -> Names {
    let own = model.names();
    let mut names = Names::default();
    for (&face, &reference) in place.faces.iter().zip(&mesh.triangles.refs) {
        if let Some(label) = own.triangles.get(&(face as i32 + 1)) {
            names.triangles.entry(reference).or_insert_with(|| label.clone());
        }
    }
    let listed: BTreeMap<[u32; 2], i32> = if own.edges.is_empty() {
        BTreeMap::new()
    } else {
        mesh.edges.iter().map(|([a, b], reference)| ([a.min(b), a.max(b)], reference)).collect()
    };
    for &([a, b], edge) in place.ridges.iter().filter(|_| !own.edges.is_empty()) {
        let number = edge as i32 + 1;
        let reference = listed.get(&[a.min(b), a.max(b)]).copied().unwrap_or(number);
        if let Some(label) = own.edges.get(&number) {
            names.edges.entry(reference).or_insert_with(|| label.clone());
        }
    }
    // Regions are solids where they are numbered so.
    let regions: BTreeSet<i32> = mesh.tets.refs.iter().copied().collect();
    if regions.iter().copied().eq(1..=model.topology().solids as i32) {
        names.tetrahedra = own.tetrahedra.clone();
    }
    names
}
