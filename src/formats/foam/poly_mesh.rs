//! From faces with the cells on both sides (polyMesh) to tetrahedra.
use super::boundary::{Patch, Zone, patches, zones};
use super::file::{FoamFile, find};
use super::list;
use crate::geometry::{Label, Names};
use crate::mesh::io::Error;
use crate::mesh::{Elements, TetMesh};
use std::path::Path;

/// No node, and no face.
const NONE: u32 = u32::MAX;

/// The content of a polyMesh folder; all numbers are in range.
struct Faces {
    points: Vec<[f64; 3]>,
    nodes: Vec<[u32; 3]>,
    /// The cell that a face's normal points out of, of each face.
    owner: Vec<u32>,
    /// The cell that it points into, of the inner faces, which come first.
    neighbour: Vec<u32>,
    patches: Vec<Patch>,
    cell_zones: Vec<Zone>,
    face_zones: Vec<Zone>,
}

/// Reads a polyMesh folder: the mesh and the names of its references. Tetrahedra and vertices are in the order of cells and points.
pub(super) fn read(folder: &Path) -> Result<(TetMesh, Names), Error> {
    let faces = Faces::read(folder)?;
    let tets = faces.tets(folder)?;
    let mut mesh = TetMesh { vertex_refs: vec![0; faces.points.len()], ..TetMesh::default() };
    let mut names = Names::default();
    let label = |name: &str| Label { name: Some(name.to_owned()), colour: None };
    for patch in &faces.patches {
        let mut left = patch.faces.clone();
        let whole = [(patch.reference, patch.faces.len())];
        for &(reference, count) in if patch.parts.is_empty() { &whole[..] } else { &patch.parts } {
            left.by_ref().take(count).for_each(|face| mesh.triangles.push(faces.nodes[face], reference));
            names.triangles.insert(reference, label(&patch.name));
        }
    }
    for zone in &faces.face_zones {
        // Faces of the boundary are there already.
        let inner = zone.members.iter().filter(|&&face| (face as usize) < faces.neighbour.len());
        inner.for_each(|&face| mesh.triangles.push(faces.nodes[face as usize], zone.reference));
        names.triangles.insert(zone.reference, label(&zone.name));
    }
    let mut refs = vec![if faces.cell_zones.is_empty() { 1 } else { 0 }; tets.len()];
    for zone in &faces.cell_zones {
        zone.members.iter().for_each(|&cell| refs[cell as usize] = zone.reference);
        names.tetrahedra.insert(zone.reference, label(&zone.name));
    }
    mesh.tets = Elements { nodes: tets, refs };
    mesh.vertices = faces.points;
    let is_named = |name: String, label: &Label| label.name.as_deref() != Some(&name);
    names.triangles.retain(|reference, label| is_named(super::unnamed_surface(*reference), label));
    names.tetrahedra.retain(|reference, label| is_named(super::unnamed_region(*reference), label));
    Ok((mesh, names))
}

/// Owner and neighbour of the inner faces.
pub(super) fn inner_faces(folder: &Path) -> Result<Vec<[u32; 2]>, Error> {
    let read = |name: &str| {
        let file = open(folder, name)?;
        let (head, mut scanner) = file.parts()?;
        list::labels(&mut scanner, &head, None)
    };
    let (owner, neighbour) = (read("owner")?, read("neighbour")?);
    Ok(owner.into_iter().zip(neighbour).map(|(owner, neighbour)| [owner, neighbour]).collect())
}

/// The file of that name of the folder.
fn open(folder: &Path, name: &str) -> Result<FoamFile, Error> {
    // Where neither is there the error names the plain file.
    FoamFile::open(&find(folder, name).unwrap_or_else(|| folder.join(name)))
}

fn content(folder: &Path, place: &str, message: String) -> Error {
    Error::Content { path: folder.to_owned(), place: place.to_owned(), message }
}

impl Faces {
    fn read(folder: &Path) -> Result<Self, Error> {
        let file = open(folder, "points")?;
        let (head, mut scanner) = file.parts()?;
        let points = list::reals(&mut scanner, &head, 3, None)?.as_chunks().0.to_vec();
        let file = open(folder, "faces")?;
        let (head, mut scanner) = file.parts()?;
        let nodes = list::triangles(&mut scanner, &head)?;
        if let Some(face) = nodes.iter().position(|nodes| nodes.iter().any(|&node| node as usize >= points.len())) {
            return Err(scanner.fail(format!(
                "face {face} has points {:?}, but there are {} points, counted from 0",
                nodes[face],
                points.len()
            )));
        }
        let file = open(folder, "owner")?;
        let (head, mut scanner) = file.parts()?;
        let owner = list::labels(&mut scanner, &head, Some(nodes.len()))?;
        let file = open(folder, "neighbour")?;
        let (head, mut scanner) = file.parts()?;
        let mut neighbour = list::labels(&mut scanner, &head, None)?;
        // Old versions fill the list up with −1, which `labels` refuses; those are long gone.
        if neighbour.len() > nodes.len() {
            return Err(scanner.fail(format!("there are {} neighbours for {} faces", neighbour.len(), nodes.len())));
        }
        neighbour.shrink_to_fit();
        let file = open(folder, "boundary")?;
        let (_, mut scanner) = file.parts()?;
        let patches = patches(&mut scanner, nodes.len())?;
        if let Some(patch) = patches.iter().find(|patch| patch.faces.start < neighbour.len() && !patch.faces.is_empty())
        {
            return Err(
                scanner.fail(format!("patch {} begins at face {}, which lies inside", patch.name, patch.faces.start))
            );
        }
        let cells = owner.iter().chain(&neighbour).max().map_or(0, |&cell| cell as usize + 1);
        let sides = owner.len() + neighbour.len();
        if cells.checked_mul(4) != Some(sides) {
            let message = format!(
                "{cells} cells have {sides} faces together: only meshes of tetrahedra are read; split the cells first"
            );
            return Err(content(folder, "owner and neighbour", message));
        }
        let zone = |name, list, items| -> Result<Vec<Zone>, Error> {
            let Some(path) = find(folder, name) else { return Ok(Vec::new()) };
            let file = FoamFile::open(&path)?;
            let (head, mut scanner) = file.parts()?;
            zones(&mut scanner, &head, list, items)
        };
        let cell_zones = zone("cellZones", b"cellLabels", cells)?;
        let face_zones = zone("faceZones", b"faceLabels", nodes.len())?;
        Ok(Self { points, nodes, owner, neighbour, patches, cell_zones, face_zones })
    }

    /// The nodes of the cells, positive where the normals of the faces point from owner to neighbour.
    fn tets(&self, folder: &Path) -> Result<Vec<[u32; 4]>, Error> {
        let cells = (self.owner.len() + self.neighbour.len()) / 4;
        let mut of_cell = vec![[NONE; 4]; cells];
        let fail = |cell: u32, what: &str| {
            content(folder, &format!("cell {cell}"), format!("{what}: only tetrahedra are read; split the cells first"))
        };
        for (face, &cell) in self.owner.iter().enumerate().chain(self.neighbour.iter().enumerate()) {
            let slots = &mut of_cell[cell as usize];
            let Some(free) = slots.iter_mut().find(|slot| **slot == NONE) else {
                return Err(fail(cell, "it has more than four faces"));
            };
            *free = face as u32;
        }
        (0..cells as u32).map(|cell| self.tet(cell, of_cell[cell as usize]).map_err(|what| fail(cell, what))).collect()
    }

    /// The nodes of the cell between four faces.
    fn tet(&self, cell: u32, faces: [u32; 4]) -> Result<[u32; 4], &'static str> {
        if faces.contains(&NONE) {
            return Err("it has fewer than four faces");
        }
        let [first, others @ ..] = faces.map(|face| self.nodes[face as usize]);
        let apex =
            others[0].into_iter().find(|node| !first.contains(node)).ok_or("two of its faces have the same points")?;
        let mut nodes = [first[0], first[1], first[2], apex];
        let [a, b, c] = first;
        if a == b || b == c || c == a {
            return Err("one of its faces has a point twice");
        }
        // Each of the others leaves out another of the first face's nodes.
        let mut left_out = [false; 3];
        for other in others {
            let distinct = other[0] != other[1] && other[1] != other[2] && other[2] != other[0];
            let absent = (0..3).find(|&i| !other.contains(&first[i]));
            match absent {
                Some(i) if distinct && !left_out[i] && other.iter().all(|node| nodes.contains(node)) => {
                    left_out[i] = true
                }
                _ => return Err("its faces do not fit together"),
            }
        }
        // The normal of an owner's face points away from the apex.
        if self.owner[faces[0] as usize] == cell {
            nodes.swap(1, 2);
        }
        Ok(nodes)
    }
}
