//! Walls: surfaces of a mesh that an option names, and the faces of the model under them.
use super::adapt::parts::{Found, Part};
use crate::geometry::classify::Classification;
use crate::geometry::{Model, Names, on_mesh};
use crate::mesh::TetMesh;
use crate::sizing::layer::{Asked, Walls};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// A mesh and what is known of it.
pub struct Places<'a> {
    pub mesh: &'a TetMesh,
    pub place: &'a Classification,
    pub model: &'a Model,
    pub names: &'a Names,
}

impl Places<'_> {
    /// The faces of the model under surfaces of the mesh, ascending.
    pub fn faces(&self, references: &[i32]) -> Vec<u32> {
        let all = self.place.faces.iter().zip(&self.mesh.triangles.refs);
        let faces: BTreeSet<u32> =
            all.filter(|(_, reference)| references.contains(reference)).map(|(&face, _)| face).collect();
        faces.into_iter().collect()
    }

    /// The walls of --wall, with their faces.
    ///
    /// # Errors
    /// When the mesh has no such surface.
    pub fn walls(&self, walls: &[Walls]) -> Result<Vec<Asked>, String> {
        let each = walls.iter().flat_map(|walls| &walls.0);
        let asked = each.map(|wall| {
            let references = surfaces("--wall", &[wall.place.parse()?], self.mesh, self.names)?;
            Ok(Asked { wall: wall.clone(), faces: self.faces(&references) })
        });
        asked.collect()
    }
}

/// The names of a mesh's references: its own, else those of its model.
pub fn names_on<'n>(own: &'n Names, mesh: &TetMesh, place: &Classification, model: &Model) -> Cow<'n, Names> {
    if own.is_empty() { Cow::Owned(on_mesh(mesh, place, model)) } else { Cow::Borrowed(own) }
}

/// The references of the surfaces that an option names.
///
/// # Errors
/// When the mesh has no such surface, or it is a region.
pub fn surfaces(by: &str, parts: &[Part], mesh: &TetMesh, names: &Names) -> Result<Vec<i32>, String> {
    let mut references = Vec::new();
    for part in parts {
        for found in part.find(mesh, names).map_err(|error| format!("{by}: {error}"))? {
            match found {
                Found::Surface(reference) => references.push(reference),
                Found::Region(reference) => {
                    return Err(format!("{by}: {reference} is a region; name a surface of the mesh"));
                }
            }
        }
    }
    Ok(references)
}
