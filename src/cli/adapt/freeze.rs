//! What the user wants left as it is.
use crate::adapt::Freeze;
use crate::mesh::TetMesh;
use std::collections::BTreeSet;
use std::str::FromStr;

/// A surface or a region of a mesh, by its reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Triangles of that reference.
    Surface(i32),
    /// Tetrahedra of that reference.
    Region(i32),
}

impl FromStr for Part {
    type Err = String;

    /// `3` or `surface:3` for a surface, `region:2` for a region.
    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, number) = text.split_once(':').unwrap_or(("surface", text));
        let reference =
            number.trim().parse().map_err(|_| format!("`{number}` is no reference: write 3, surface:3 or region:2"))?;
        match kind.trim() {
            "surface" => Ok(Self::Surface(reference)),
            "region" => Ok(Self::Region(reference)),
            other => Err(format!("`{other}` is neither surface nor region: write 3, surface:3 or region:2")),
        }
    }
}

/// The parts, each of which the mesh has.
///
/// # Errors
/// When it has not; tells what there is.
pub fn frozen(parts: &[Part], mesh: &TetMesh) -> Result<Freeze, String> {
    let mut freeze = Freeze::default();
    for &part in parts {
        let (reference, name, refs, list) = match part {
            Part::Surface(reference) => (reference, "surface", &mesh.triangles.refs, &mut freeze.surfaces),
            Part::Region(reference) => (reference, "region", &mesh.tets.refs, &mut freeze.regions),
        };
        if !refs.contains(&reference) {
            let there: BTreeSet<i32> = refs.iter().copied().collect();
            let there: Vec<String> = there.iter().take(20).map(i32::to_string).collect();
            return Err(format!(
                "the mesh has no {name} with reference {reference}; its {name}s are {}",
                there.join(", ")
            ));
        }
        list.push(reference);
    }
    Ok(freeze)
}
