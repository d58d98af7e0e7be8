//! The faces of a mesh in OpenFOAM's order.
use super::boundary::Patch;
use super::unnamed_surface;
use super::words::words;
use crate::formats::Dataset;
use crate::geometry::Names;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, TriangleIndex};
use crate::mesh::io::Error;
use crate::tasks::Team;
use std::collections::BTreeMap;
use std::path::Path;

/// A face of three or four nodes; behind the third of three there is none.
pub(super) type Face = [u32; 4];

/// The faces in OpenFOAM's order: inner ones by owner, then neighbour ("upper triangular"), then those of each patch. Of the cells the tetrahedra
/// come first.
#[derive(Default)]
pub(super) struct Ordered {
    pub nodes: Vec<Face>,
    pub owner: Vec<u32>,
    pub neighbour: Vec<u32>,
    pub patches: Vec<Patch>,
    /// Inner faces that are triangles or quadrilaterals of the mesh, with the reference, ascending.
    pub inside: Vec<(u32, i32)>,
}

/// Faces on the boundary by their references, each with its cell.
type Boundary = BTreeMap<i32, Vec<(Face, u32)>>;

/// What is wrong with a mesh.
type Wrong<'a> = &'a dyn Fn(String) -> Error;

impl Ordered {
    /// Of a mesh without the pieces of its stack.
    pub fn of(
        team: Team<'_>,
        folder: &Path,
        data: &Dataset,
        kind: &dyn Fn(i32, &str) -> String,
    ) -> Result<Self, Error> {
        let wrong =
            |message: String| Error::Content { path: folder.to_owned(), place: "mesh to write".to_owned(), message };
        let mut faces = Self::default();
        let boundary = if data.stack.is_empty() {
            faces.inner_of_tets(team, &data.mesh, &wrong)?
        } else {
            faces.inner_of_cells(data, &wrong)?
        };
        faces.add_patches(&boundary, &data.names, kind);
        Ok(faces)
    }

    /// Adds the faces between tetrahedra.
    fn inner_of_tets(&mut self, team: Team<'_>, mesh: &TetMesh, wrong: Wrong<'_>) -> Result<Boundary, Error> {
        let matched = MatchedFaces::of(team, &mesh.tets.nodes);
        if let Some(crowd) = matched.crowded {
            return Err(wrong(format!(
                "{} tetrahedra share the face of the nodes {:?} (from 0): `geo-adapt inspect` has more",
                crowd.tets, crowd.nodes
            )));
        }
        let tets = &mesh.tets.nodes;
        let around = &matched.neighbours;
        let sides = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len()).sides(team, tets);
        // In the order of the tetrahedra, and so are the sides.
        let mut sides = sides.into_iter().peekable();
        let mut boundary = Boundary::new();
        for (tet, around) in around.iter().enumerate() {
            let nodes = |face: usize| {
                let [a, b, c] = FACES[face].map(|i| tets[tet][i]);
                [a, b, c, NONE]
            };
            let mut of_face = [None; 4];
            while let Some(side) = sides.next_if(|side| side.tet as usize == tet) {
                of_face[side.face as usize] = Some(mesh.triangles.refs[side.triangle as usize]);
            }
            let mut upper: Vec<_> =
                (0..4).filter(|&face| around[face] != NONE && around[face] as usize > tet).collect();
            upper.sort_unstable_by_key(|&face| around[face]);
            for face in upper {
                self.inside.extend(of_face[face].map(|reference| (self.nodes.len() as u32, reference)));
                self.nodes.push(nodes(face));
                self.owner.push(tet as u32);
                self.neighbour.push(around[face]);
            }
            for face in (0..4).filter(|&face| around[face] == NONE) {
                let Some(reference) = of_face[face] else {
                    return Err(wrong(format!(
                        "face {face} of tetrahedron {} has no neighbour and no triangle: `geo-adapt inspect` has more",
                        tet + 1
                    )));
                };
                boundary.entry(reference).or_default().push((nodes(face), tet as u32));
            }
        }
        Ok(boundary)
    }

    /// Adds the faces between cells of any kind.
    fn inner_of_cells(&mut self, Dataset { mesh, stack, .. }: &Dataset, wrong: Wrong<'_>) -> Result<Boundary, Error> {
        let mut sides: Vec<(Face, u32, Face)> = Vec::new();
        for (cell, nodes) in (0..).zip(&mesh.tets.nodes) {
            let faces = FACES.map(|face| whole(&face.map(|i| nodes[i])));
            sides.extend(faces.map(|face| (sorted(face), cell, face)));
        }
        for (cell, of) in (mesh.tets.len() as u32..).zip(&stack.cells) {
            sides.extend(
                of.outward_faces(&mesh.vertices).map(|face| whole(&face)).map(|face| (sorted(face), cell, face)),
            );
        }
        sides.sort_unstable();
        let triangles = mesh.triangles.iter().map(|(nodes, reference)| (sorted(whole(&nodes)), reference));
        let quads = stack.quads.iter().map(|(nodes, reference)| (sorted(nodes), reference));
        let listed: BTreeMap<Face, i32> = triangles.chain(quads).collect();
        let mut inner = Vec::new();
        let mut boundary = Boundary::new();
        for group in sides.chunk_by(|a, b| a.0 == b.0) {
            let reference = listed.get(&group[0].0);
            match (group, reference) {
                ([(_, owner, nodes), (_, neighbour, _)], _) => inner.push((*owner, *neighbour, *nodes, reference)),
                ([(_, owner, nodes)], Some(&reference)) => {
                    boundary.entry(reference).or_default().push((*nodes, *owner))
                }
                ([(nodes, ..)], None) => {
                    return Err(wrong(format!(
                        "the face of the nodes {:?} (from 0) has one cell and is in no boundary: list it there",
                        nodes.iter().filter(|&&node| node != NONE).collect::<Vec<_>>()
                    )));
                }
                _ => {
                    return Err(wrong(format!(
                        "{} cells share the face of the nodes {:?} (from 0)",
                        group.len(),
                        group[0].0
                    )));
                }
            }
        }
        boundary.values_mut().for_each(|faces| faces.sort_by_key(|(_, owner)| *owner));
        inner.sort_unstable();
        for (owner, neighbour, nodes, reference) in inner {
            self.inside.extend(reference.map(|&reference| (self.nodes.len() as u32, reference)));
            self.nodes.push(nodes);
            self.owner.push(owner);
            self.neighbour.push(neighbour);
        }
        Ok(boundary)
    }

    fn add_patches(&mut self, boundary: &Boundary, names: &Names, kind: &dyn Fn(i32, &str) -> String) {
        let joined = joined(boundary.keys().copied(), names, kind);
        let words = words(&joined.keys().copied().collect(), &names.triangles, unnamed_surface);
        for (reference, of_name) in joined {
            let start = self.nodes.len();
            for (nodes, owner) in of_name.iter().flat_map(|reference| &boundary[reference]) {
                self.nodes.push(*nodes);
                self.owner.push(*owner);
            }
            let name = words[&reference].clone();
            let kind = kind(reference, &name);
            let mut parts: Vec<_> = of_name.iter().map(|reference| (*reference, boundary[reference].len())).collect();
            if parts.len() == 1 {
                parts.clear();
            }
            self.patches.push(Patch { name, reference, kind, faces: start..self.nodes.len(), parts });
        }
    }
}

/// Three or four nodes as a face.
fn whole(nodes: &[u32]) -> Face {
    [nodes[0], nodes[1], nodes[2], nodes.get(3).copied().unwrap_or(NONE)]
}

fn sorted(mut face: Face) -> Face {
    face.sort_unstable();
    face
}

/// References by the first of the same name and type, which become one patch: a name stays one name.
fn joined(
    references: impl Iterator<Item = i32>,
    names: &Names,
    kind: &dyn Fn(i32, &str) -> String,
) -> BTreeMap<i32, Vec<i32>> {
    let mut first: BTreeMap<(&str, String), i32> = BTreeMap::new();
    let mut joined: BTreeMap<i32, Vec<i32>> = BTreeMap::new();
    for reference in references {
        let name = names.triangles.get(&reference).and_then(|label| label.name.as_deref());
        let to = name.map_or(reference, |name| *first.entry((name, kind(reference, name))).or_insert(reference));
        joined.entry(to).or_default().push(reference);
    }
    joined
}
