//! The boundary of a tetrahedral mesh: its outward side, and triangles that the file left out.
use crate::mesh::TetMesh;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::volume6;
use std::collections::{BTreeMap, HashMap};

/// Nodes of the mesh's triangles, turned so that the right-hand normal leaves the tetrahedra; between two regions
/// it leaves the one with the smaller reference. A triangle without a tetrahedron, or inside one region, stays as it is.
pub fn outward_triangles(mesh: &TetMesh) -> Vec<[u32; 3]> {
    let mut triangles = mesh.triangles.nodes.clone();
    let mut on_surface = vec![false; mesh.vertices.len()];
    let mut index = HashMap::with_capacity(triangles.len());
    for (t, nodes) in triangles.iter().enumerate() {
        nodes.iter().for_each(|&v| on_surface[v as usize] = true);
        index.insert(sorted(*nodes), t);
    }
    // Per triangle the least region beside it with that tetrahedron's fourth vertex, and whether all regions agree.
    let mut inner: Vec<Option<(i32, u32, u8)>> = vec![None; triangles.len()];
    for (tet, region) in mesh.tets.iter() {
        for k in 0..4 {
            let face = FACES[k].map(|i| tet[i]);
            if !face.iter().all(|&v| on_surface[v as usize]) {
                continue;
            }
            let Some(&t) = index.get(&sorted(face)) else { continue };
            inner[t] = Some(match inner[t] {
                None => (region, tet[k], 1),
                Some((other, apex, _)) if other < region => (other, apex, 1),
                Some((other, ..)) if region < other => (region, tet[k], 1),
                Some((other, apex, _)) => (other, apex, 2),
            });
        }
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

fn sorted(mut nodes: [u32; 3]) -> [u32; 3] {
    nodes.sort_unstable();
    nodes
}

/// Adds the triangles that the mesh lacks on the boundary of its tetrahedra and between its regions, normals outward (of
/// the smaller region). New ones take references that the mesh does not use: one for the boundary of each region,
/// one for each pair of regions. Returns how many were added.
pub fn complete_boundary(mesh: &mut TetMesh) -> usize {
    let known: std::collections::HashSet<[u32; 3]> = mesh.triangles.nodes.iter().map(|n| sorted(*n)).collect();
    let mut missing: Vec<([u32; 3], [i32; 2])> = Vec::new();
    for_each_pair(mesh, |face, regions| {
        if regions[0] != regions[1] && !known.contains(&sorted(face)) {
            missing.push((face, regions));
        }
    });
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

/// Calls f with each face of the tetrahedra, once, and the regions of its two sides, the smaller first; the face's
/// normal leaves that one.
fn for_each_pair(mesh: &TetMesh, mut f: impl FnMut([u32; 3], [i32; 2])) {
    let least = |tet: [u32; 4], k: usize| FACES[k].map(|i| tet[i]).into_iter().min().unwrap_or(0);
    let mut starts = vec![0u32; mesh.vertices.len() + 1];
    for &tet in &mesh.tets.nodes {
        (0..4).for_each(|k| starts[least(tet, k) as usize + 1] += 1);
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut sides = vec![(0u32, 0u32, 0u32); 4 * mesh.tets.len()];
    for (i, &tet) in mesh.tets.nodes.iter().enumerate() {
        for k in 0..4 {
            let [a, b, c] = sorted(FACES[k].map(|i| tet[i]));
            sides[next[a as usize] as usize] = (b, c, (4 * i + k) as u32);
            next[a as usize] += 1;
        }
    }
    for v in 0..mesh.vertices.len() {
        let bucket = &mut sides[starts[v] as usize..starts[v + 1] as usize];
        bucket.sort_unstable();
        for pair in bucket.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)) {
            let region = |i: usize| pair.get(i).map_or(OUTSIDE, |side| mesh.tets.refs[side.2 as usize / 4]);
            let (first, second) = (region(0), region(1));
            let side = if first <= second { pair[0].2 } else { pair[1].2 };
            f(outward_face(mesh, side), [first.min(second), first.max(second)]);
        }
    }
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
