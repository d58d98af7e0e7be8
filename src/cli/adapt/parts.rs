//! Surfaces and regions of a mesh by reference: what the user wants left as it is, or of another size ([`super::local`]).
use crate::adapt::Freeze;
use crate::geometry::{Label, Names, called};
use crate::mesh::TetMesh;
use std::collections::{BTreeMap, BTreeSet};
use std::str::FromStr;

/// How a part is named.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Key {
    Reference(i32),
    /// By a name in the names file of the mesh, or in its CAD model.
    Name(String),
}

/// Which parts may be meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Surface,
    Region,
    /// A name alone: surfaces of that name, else regions.
    Any,
}

/// Surfaces or regions of a mesh, by reference or by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    kind: Kind,
    key: Key,
}

/// Triangles or tetrahedra of a reference.
#[derive(Clone, Copy)]
pub enum Found {
    /// Triangles.
    Surface(i32),
    /// Tetrahedra.
    Region(i32),
}

impl FromStr for Part {
    type Err = String;

    /// `3`, `surface:3` or `inlet` for a surface, `region:2` or `region:steel` for a region.
    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, key) = match text.split_once(':').map(|(kind, key)| (kind.trim(), key)) {
            Some(("surface", key)) => (Kind::Surface, key),
            Some(("region", key)) => (Kind::Region, key),
            _ => (Kind::Any, text),
        };
        let key = key.trim();
        if key.is_empty() {
            return Err(format!("`{text}` names nothing: write 3, surface:3, region:2, or a name"));
        }
        Ok(match (kind, key.parse()) {
            (Kind::Any, Ok(reference)) => Self { kind: Kind::Surface, key: Key::Reference(reference) },
            (kind, Ok(reference)) => Self { kind, key: Key::Reference(reference) },
            (kind, Err(_)) => Self { kind, key: Key::Name(key.into()) },
        })
    }
}

impl Part {
    /// The parts that are meant. Refuses what the mesh does not have, and lists what it has.
    pub fn find(&self, mesh: &TetMesh, names: &Names) -> Result<Vec<Found>, String> {
        let name = match &self.key {
            Key::Reference(reference) if self.kind == Kind::Region => {
                return has("region", *reference, &mesh.tets.refs).map(|()| vec![Found::Region(*reference)]);
            }
            Key::Reference(reference) => {
                return has("surface", *reference, &mesh.triangles.refs).map(|()| vec![Found::Surface(*reference)]);
            }
            Key::Name(name) => name,
        };
        let mut found = Vec::new();
        if self.kind != Kind::Region {
            let there = called(&names.triangles, name).into_iter().filter(|r| mesh.triangles.refs.contains(r));
            found.extend(there.map(Found::Surface));
        }
        if self.kind == Kind::Region || self.kind == Kind::Any && found.is_empty() {
            let there = called(&names.tetrahedra, name).into_iter().filter(|r| mesh.tets.refs.contains(r));
            found.extend(there.map(Found::Region));
        }
        if found.is_empty() { Err(self.not_called(name, names)) } else { Ok(found) }
    }

    /// The error about a name that nothing has.
    fn not_called(&self, name: &str, names: &Names) -> String {
        let labels = |labels: &BTreeMap<i32, Label>| labels.values().filter_map(|label| label.name.clone()).collect();
        let mut there: BTreeSet<String> = BTreeSet::new();
        if self.kind != Kind::Region {
            there.append(&mut labels(&names.triangles));
        }
        if self.kind != Kind::Surface {
            there.append(&mut labels(&names.tetrahedra));
        }
        let what = match self.kind {
            Kind::Surface => "surface",
            Kind::Region => "region",
            Kind::Any => "surface or region",
        };
        if there.is_empty() {
            return format!(
                "the mesh has no {what} called {name}: neither a names file beside it nor the model has names; give a reference"
            );
        }
        let there: Vec<String> = there.into_iter().take(20).collect();
        format!("the mesh has no {what} called {name}; there are {}", there.join(", "))
    }
}

/// Refuses a reference that the mesh has not.
fn has(what: &str, reference: i32, refs: &[i32]) -> Result<(), String> {
    if refs.contains(&reference) {
        return Ok(());
    }
    let there: BTreeSet<i32> = refs.iter().copied().collect();
    let there: Vec<String> = there.iter().take(20).map(i32::to_string).collect();
    Err(format!("the mesh has no {what} with reference {reference}; its {what}s are {}", there.join(", ")))
}

impl Found {
    /// Its vertices, some repeatedly.
    pub(super) fn vertices(self, mesh: &TetMesh) -> Vec<u32> {
        match self {
            Self::Surface(wanted) => mesh.triangles.iter().filter(|e| e.1 == wanted).flat_map(|e| e.0).collect(),
            Self::Region(wanted) => mesh.tets.iter().filter(|e| e.1 == wanted).flat_map(|e| e.0).collect(),
        }
    }
}

/// The parts, each of which the mesh has.
pub fn frozen(parts: &[Part], mesh: &TetMesh, names: &Names) -> Result<Freeze, String> {
    let mut freeze = Freeze::default();
    for part in parts {
        for found in part.find(mesh, names)? {
            match found {
                Found::Surface(reference) => freeze.surfaces.push(reference),
                Found::Region(reference) => freeze.regions.push(reference),
            }
        }
    }
    Ok(freeze)
}
