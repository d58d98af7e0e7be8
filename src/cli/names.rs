//! The names file beside a mesh or a BREP model: MESH.names.json for MESH.meshb.
//!
//! It says for triangles, edges and tetrahedra what each reference is called, and its colour:
//! `{"triangles": {"3": {"name": "inlet", "colour": "#FF0000"}}, "edges": {}, "tetrahedra": {"1": {"name": "fluid"}}}`.
use crate::geometry::classify::Classification;
use crate::geometry::{Geometry, Model, Names};
use crate::mesh::{TetMesh, io};
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The names file of a mesh or model.
pub fn path(of: &Path) -> PathBuf {
    of.with_extension("names.json")
}

/// Reads the names of a mesh or model; none where there is no such file.
///
/// # Errors
/// When the file cannot be read, or holds something else.
pub fn read(of: &Path) -> Result<Names, String> {
    let path = path(of);
    let name = path.display();
    match std::fs::read(&path) {
        Ok(bytes) => serde_json::from_slice(&bytes).map_err(|error| {
            format!("{name}: no names of references ({error}); write it as geo-adapt bootstrap does, or move it away")
        }),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Names::default()),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// Writes the names of a mesh beside it. Where there are none nothing is written, and the file of an older mesh is made empty.
///
/// # Errors
/// When the file cannot be written.
pub fn write(of: &Path, names: &Names) -> Result<(), Box<dyn std::error::Error>> {
    let path = path(of);
    if names.is_empty() && !path.exists() {
        return Ok(());
    }
    let text = serde_json::to_vec_pretty(names)?;
    Ok(io::write_beside(&path, |file| file.write_all(&text).and_then(|()| file.write_all(b"\n")))?)
}

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
