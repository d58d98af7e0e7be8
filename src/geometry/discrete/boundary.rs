//! The boundary of a tetrahedral mesh: its outward side, and triangles that the file lacks.
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, Side, TriangleIndex, sorted3};
use crate::mesh::vector::volume6;
use crate::tasks::{GRAIN, Team};
use std::collections::{BTreeMap, HashSet};

/// Nodes of the mesh's triangles, turned so that the right-hand normal leaves the tetrahedra; between two regions
/// it leaves the one with the smaller reference. A triangle without a tetrahedron, or inside one region, stays as it is.
pub fn outward_triangles(team: Team<'_>, mesh: &TetMesh) -> Vec<[u32; 3]> {
    let mut triangles = mesh.triangles.nodes.clone();
    // Per triangle the least region beside it with that tetrahedron's fourth vertex, and whether all regions agree.
    let mut inner: Vec<Option<(i32, u32, u8)>> = vec![None; triangles.len()];
    let index = TriangleIndex::new(team, &triangles, mesh.vertices.len());
    for Side { triangle, tet, face } in index.sides(team, &mesh.tets.nodes) {
        let (apex, region) = (mesh.tets.nodes[tet as usize][face as usize], mesh.tets.refs[tet as usize]);
        let inner = &mut inner[triangle as usize];
        *inner = Some(match *inner {
            None => (region, apex, 1),
            Some((other, apex, _)) if other < region => (other, apex, 1),
            Some((other, ..)) if region < other => (region, apex, 1),
            Some((other, apex, _)) => (other, apex, 2),
        });
    }
    for (nodes, inner) in triangles.iter_mut().zip(inner) {
        let Some((_, apex, 1)) = inner else { continue };
        let [a, b, c, d] = [nodes[0], nodes[1], nodes[2], apex].map(|v| mesh.vertices[v as usize]);
        if volume6(a, b, c, d) > 0.0 {
            nodes.swap(1, 2);
        }
    }
    triangles
}

/// Adds the triangles that the mesh lacks on the boundary of its tetrahedra and between its regions, normals outward (of
/// the smaller region). New ones take references that the mesh does not use: one for the boundary of each region,
/// one for each pair of regions. Returns how many were added.
pub fn complete_boundary(team: Team<'_>, mesh: &mut TetMesh) -> usize {
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    complete_matched(team, mesh, &faces)
}

/// [`complete_boundary`] of a mesh whose faces have been matched.
pub fn complete_matched(team: Team<'_>, mesh: &mut TetMesh, faces: &MatchedFaces) -> usize {
    let known: HashSet<[u32; 3]> = mesh.triangles.nodes.iter().map(|n| sorted3(*n)).collect();
    let mut missing = interfaces(team, mesh, faces);
    missing.retain(|(face, _)| !known.contains(&sorted3(*face)));
    missing.sort_unstable_by_key(|(face, _)| sorted3(*face));
    let mut fresh = BTreeMap::new();
    for (_, regions) in &missing {
        fresh.insert(*regions, 0);
    }
    let base = mesh.triangles.refs.iter().copied().max().unwrap_or(0).max(0);
    for (i, reference) in fresh.values_mut().enumerate() {
        *reference = base.saturating_add(1 + i as i32);
    }
    for (face, regions) in &missing {
        mesh.triangles.push(*face, fresh[regions]);
    }
    missing.len()
}

/// Marks the side of a face without a tetrahedron.
const OUTSIDE: i32 = i32::MAX;

/// Each face on the boundary or between regions, once, with the regions on its two sides, the smaller first. The face's normal points
/// out of that one.
fn interfaces(team: Team<'_>, mesh: &TetMesh, faces: &MatchedFaces) -> Vec<([u32; 3], [i32; 2])> {
    team.collect(GRAIN, mesh.tets.len(), |range, found| {
        for t in range {
            let region = mesh.tets.refs[t];
            for (k, &n) in faces.neighbours[t].iter().enumerate() {
                let beyond = if n == NONE { OUTSIDE } else { mesh.tets.refs[n as usize] };
                if region < beyond {
                    found.push((outward_face(mesh, (4 * t + k) as u32), [region, beyond]));
                }
            }
        }
    })
}

/// Nodes of a tetrahedron's face, normal outward also if the tetrahedron is listed inside out.
fn outward_face(mesh: &TetMesh, side: u32) -> [u32; 3] {
    let tet = mesh.tets.nodes[side as usize / 4];
    let mut face = FACES[side as usize % 4].map(|i| tet[i]);
    let [a, b, c, d] = tet.map(|v| mesh.vertices[v as usize]);
    if volume6(a, b, c, d) < 0.0 {
        face.swap(1, 2);
    }
    face
}
