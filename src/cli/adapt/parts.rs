//! Surfaces and regions of a mesh by reference: what the user wants left as it is, or of another size.
use crate::adapt::Freeze;
use crate::mesh::TetMesh;
use crate::metric::Sym3;
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

impl Part {
    /// Refuses a part that the mesh has not, and tells what there is.
    fn check(self, mesh: &TetMesh) -> Result<(), String> {
        let (reference, name, refs) = match self {
            Self::Surface(reference) => (reference, "surface", &mesh.triangles.refs),
            Self::Region(reference) => (reference, "region", &mesh.tets.refs),
        };
        if refs.contains(&reference) {
            return Ok(());
        }
        let there: BTreeSet<i32> = refs.iter().copied().collect();
        let there: Vec<String> = there.iter().take(20).map(i32::to_string).collect();
        Err(format!("the mesh has no {name} with reference {reference}; its {name}s are {}", there.join(", ")))
    }

    /// Its vertices, some repeatedly.
    fn vertices(self, mesh: &TetMesh) -> Vec<u32> {
        match self {
            Self::Surface(wanted) => mesh.triangles.iter().filter(|e| e.1 == wanted).flat_map(|e| e.0).collect(),
            Self::Region(wanted) => mesh.tets.iter().filter(|e| e.1 == wanted).flat_map(|e| e.0).collect(),
        }
    }
}

/// The parts, each of which the mesh has.
pub fn frozen(parts: &[Part], mesh: &TetMesh) -> Result<Freeze, String> {
    let mut freeze = Freeze::default();
    for &part in parts {
        part.check(mesh)?;
        match part {
            Part::Surface(reference) => freeze.surfaces.push(reference),
            Part::Region(reference) => freeze.regions.push(reference),
        }
    }
    Ok(freeze)
}

/// A greatest size on a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    part: Part,
    /// In model units.
    size: f64,
}

impl FromStr for Local {
    type Err = String;

    /// `3:h=0.01`, `region:2:h=0.05`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (part, size) =
            text.rsplit_once(":h=").ok_or_else(|| format!("`{text}`: write 3:h=0.01 or region:2:h=0.05"))?;
        Ok(Self { part: part.parse()?, size: crate::cli::positive(size)? })
    }
}

/// Lets ln M at the vertices ask for no more than the sizes on their parts.
pub fn apply(locals: &[Local], mesh: &TetMesh, logs: &mut [Sym3]) -> Result<(), String> {
    for local in locals {
        local.part.check(mesh)?;
        let size = Sym3::ZERO.plus_identity(-2.0 * local.size.ln());
        for v in local.part.vertices(mesh) {
            logs[v as usize] = logs[v as usize].intersect_logs(&size);
        }
    }
    Ok(())
}
