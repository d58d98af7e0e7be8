//! From faces with the cells on both sides (polyMesh) to cells with nodes.
use super::boundary::{Patch, Zone, patches, zones};
use super::file::{FoamFile, find};
use super::list;
use super::ordered::Face;
use crate::formats::{Dataset, stacks};
use crate::geometry::{Label, Names};
use crate::mesh::TetMesh;
use crate::mesh::io::Error;
use crate::mesh::stack::{Cell, Kind, Stack};
use std::path::Path;

/// No node, and no face.
const NONE: u32 = u32::MAX;

/// Most faces of a cell.
const MOST: usize = 6;

/// A cell by its nodes.
enum Shape {
    Tet([u32; 4]),
    Other(Kind, Vec<u32>),
}

/// The content of a polyMesh folder; all numbers are in range.
struct Faces {
    points: Vec<[f64; 3]>,
    nodes: Vec<Face>,
    /// The cell that a face's normal points out of, of each face.
    owner: Vec<u32>,
    /// The cell that it points into, of the inner faces, which come first.
    neighbour: Vec<u32>,
    patches: Vec<Patch>,
    cell_zones: Vec<Zone>,
    face_zones: Vec<Zone>,
}

/// A polyMesh as a mesh.
pub(super) struct PolyMesh {
    /// Mesh, stack and names; no fields.
    pub data: Dataset,
    /// For each tetrahedron and then each cell of the stack its number in the folder.
    pub cells: Vec<u32>,
    /// What the user should know.
    pub notices: Vec<String>,
}

/// Reads a polyMesh folder: the mesh and the names of its references. Tetrahedra, other cells and vertices are in the order of cells and points.
pub(super) fn read(folder: &Path) -> Result<PolyMesh, Error> {
    let faces = Faces::read(folder)?;
    let mut mesh = TetMesh { vertex_refs: vec![0; faces.points.len()], ..TetMesh::default() };
    let (mut stack, mut names) = (Stack::default(), Names::default());
    let label = |name: &str| Label { name: Some(name.to_owned()), colour: None };
    let mut add = |face: usize, reference: i32| match faces.nodes[face] {
        [a, b, c, NONE] => mesh.triangles.push([a, b, c], reference),
        quad => stack.quads.push(quad, reference),
    };
    for patch in &faces.patches {
        let mut left = patch.faces.clone();
        let whole = [(patch.reference, patch.faces.len())];
        for &(reference, count) in if patch.parts.is_empty() { &whole[..] } else { &patch.parts } {
            left.by_ref().take(count).for_each(|face| add(face, reference));
            names.triangles.insert(reference, label(&patch.name));
        }
    }
    for zone in &faces.face_zones {
        // Faces of the boundary are there already.
        let inner = zone.members.iter().filter(|&&face| (face as usize) < faces.neighbour.len());
        inner.for_each(|&face| add(face as usize, zone.reference));
        names.triangles.insert(zone.reference, label(&zone.name));
    }
    let mut refs = vec![if faces.cell_zones.is_empty() { 1 } else { 0 }; faces.cells()];
    for zone in &faces.cell_zones {
        zone.members.iter().for_each(|&cell| refs[cell as usize] = zone.reference);
        names.tetrahedra.insert(zone.reference, label(&zone.name));
    }
    let (mut tets, mut others) = (Vec::new(), Vec::new());
    for (cell, shape) in (0..).zip(faces.shapes(folder)?) {
        let reference = refs[cell as usize];
        match shape {
            Shape::Tet(nodes) => {
                mesh.tets.push(nodes, reference);
                tets.push(cell);
            }
            Shape::Other(kind, nodes) => {
                stack.cells.push(Cell::new(kind, &nodes, reference));
                others.push(cell);
            }
        }
    }
    mesh.vertices = faces.points;
    let is_named = |name: String, label: &Label| label.name.as_deref() != Some(&name);
    names.triangles.retain(|reference, label| is_named(super::unnamed_surface(*reference), label));
    names.tetrahedra.retain(|reference, label| is_named(super::unnamed_region(*reference), label));
    let mut notices = Vec::new();
    stacks::join(folder, &mut mesh, &mut stack, &mut notices)?;
    let data = Dataset { mesh, stack, names, fields: Vec::new() };
    Ok(PolyMesh { data, cells: [tets, others].concat(), notices })
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
        let nodes = list::faces(&mut scanner, &head)?;
        if let Some(face) =
            nodes.iter().position(|nodes| nodes.iter().any(|&node| node as usize >= points.len() && node != NONE))
        {
            return Err(scanner.fail(format!(
                "face {face} has points {:?}, but there are {} points, counted from 0",
                nodes[face].iter().filter(|&&node| node != NONE).collect::<Vec<_>>(),
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
        if cells.checked_mul(4).is_none_or(|least| least > sides) || cells.saturating_mul(MOST) < sides {
            let message = format!(
                "{cells} cells have {sides} faces together: only tetrahedra, prisms, pyramids and hexahedra are read; split the cells first"
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

    /// The number of cells.
    fn cells(&self) -> usize {
        self.owner.iter().chain(&self.neighbour).max().map_or(0, |&cell| cell as usize + 1)
    }

    /// The cells by their faces.
    fn shapes(&self, folder: &Path) -> Result<Vec<Shape>, Error> {
        let mut of_cell = vec![[NONE; MOST]; self.cells()];
        let fail = |cell: u32, what: &str| {
            let wanted = "only tetrahedra, prisms, pyramids and hexahedra are read; split the cells first";
            content(folder, &format!("cell {cell}"), format!("{what}: {wanted}"))
        };
        for (face, &cell) in self.owner.iter().enumerate().chain(self.neighbour.iter().enumerate()) {
            let slots = &mut of_cell[cell as usize];
            let Some(free) = slots.iter_mut().find(|slot| **slot == NONE) else {
                return Err(fail(cell, "it has more than six faces"));
            };
            *free = face as u32;
        }
        let shape = |cell: u32| match of_cell[cell as usize] {
            [a, b, c, d, NONE, NONE] if d != NONE => self.tet(cell, [a, b, c, d]).map(Shape::Tet),
            faces => self.other(faces),
        };
        (0..of_cell.len() as u32).map(|cell| shape(cell).map_err(|what| fail(cell, what))).collect()
    }

    /// The cell between these faces, which are not four. Which way its base is seen is told by its volume.
    fn other(&self, faces: [u32; MOST]) -> Result<Shape, &'static str> {
        let mut all: Vec<Vec<u32>> = faces
            .iter()
            .filter(|&&face| face != NONE)
            .map(|&face| self.nodes[face as usize].into_iter().filter(|&node| node != NONE).collect())
            .collect();
        let quads = all.iter().filter(|nodes| nodes.len() == 4).count();
        let (kind, base) = match (all.len(), quads) {
            (5, 1) => (Kind::Pyramid, 4),
            (5, 3) => (Kind::Prism, 3),
            (6, 6) => (Kind::Hexahedron, 4),
            (count, _) if count < 4 => return Err("it has fewer than four faces"),
            _ => return Err("it has faces as none of these has"),
        };
        let mut nodes = all.iter().find(|face| face.len() == base).cloned().unwrap_or_default();
        // The node above one of the base is beside it in a face of the side.
        let above = |below: u32| {
            all.iter().find_map(|face| {
                let at = face.iter().position(|&node| node == below)?;
                let beside = [face[(at + 1) % face.len()], face[(at + face.len() - 1) % face.len()]];
                beside.into_iter().find(|node| !nodes.contains(node))
            })
        };
        let tops = if kind == Kind::Pyramid { nodes[..1].to_vec() } else { nodes.clone() };
        let tops: Option<Vec<u32>> = tops.into_iter().map(above).collect();
        nodes.extend(tops.ok_or("its faces do not fit together")?);
        let mut wanted: Vec<Vec<u32>> = Cell::new(kind, &nodes, 0).faces().collect();
        for face in all.iter_mut().chain(&mut wanted) {
            face.sort_unstable();
        }
        all.sort_unstable();
        wanted.sort_unstable();
        if all == wanted { Ok(Shape::Other(kind, nodes)) } else { Err("its faces do not fit together") }
    }

    /// The nodes of the tetrahedron between four faces, positive where the normals of the faces point from owner to neighbour.
    fn tet(&self, cell: u32, faces: [u32; 4]) -> Result<[u32; 4], &'static str> {
        if faces.iter().any(|&face| self.nodes[face as usize][3] != NONE) {
            return Err("it has four faces, and not all are triangles");
        }
        let [first, others @ ..] = faces.map(|face| {
            let [a, b, c, _] = self.nodes[face as usize];
            [a, b, c]
        });
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
