//! Corners of a surface: where its ridges end, branch or turn.
use super::Features;
use crate::mesh::TetMesh;
use crate::mesh::vector::{dot, sub, unit};

/// Which mesh vertices are corners of the surface.
pub(super) fn find_corners(mesh: &TetMesh, features: &Features, ridges: &[u32], angle_deg: f64) -> Vec<bool> {
    let count = mesh.vertices.len();
    let mut on_surface = vec![false; count];
    mesh.triangles.nodes.iter().flatten().for_each(|&v| on_surface[v as usize] = true);
    let mut corner = vec![false; count];
    for &v in mesh.corners.iter().chain(&mesh.required_vertices) {
        corner[v as usize] = on_surface[v as usize];
    }
    // Ridges at each vertex: how many, and the first two.
    let mut at = vec![(0u32, [0u32; 2]); count];
    for &edge in ridges {
        for v in features.edges.nodes[edge as usize] {
            let (n, first) = &mut at[v as usize];
            if *n < 2 {
                first[*n as usize] = edge;
            }
            *n += 1;
        }
    }
    let least_cosine = angle_deg.to_radians().cos();
    for v in 0..count {
        corner[v] |= match at[v] {
            (0, _) => false,
            (2, pair) => splits(mesh, features, v as u32, pair, least_cosine),
            _ => true,
        };
    }
    for v in touching_patches(mesh, features, &at) {
        corner[v] = true;
    }
    corner
}

/// Whether two ridges that meet at a vertex belong to different edges of the geometry.
fn splits(mesh: &TetMesh, features: &Features, v: u32, [e, f]: [u32; 2], least_cosine: f64) -> bool {
    let other = |edge: u32| {
        let [a, b] = features.edges.nodes[edge as usize];
        mesh.vertices[(a ^ b ^ v) as usize]
    };
    let here = mesh.vertices[v as usize];
    let turn = dot(unit(sub(here, other(e))), unit(sub(other(f), here)));
    turn < least_cosine
        || features.listed[e as usize] != features.listed[f as usize]
        || patches_beside(features, e) != patches_beside(features, f)
}

fn patches_beside(features: &Features, edge: u32) -> Vec<u32> {
    let mut patches: Vec<u32> = features.edges.triangles(edge as usize).map(|t| features.patch[t]).collect();
    patches.sort_unstable();
    patches.dedup();
    patches
}

/// Vertices at which a patch touches others without a ridge between them.
fn touching_patches(mesh: &TetMesh, features: &Features, at: &[(u32, [u32; 2])]) -> Vec<usize> {
    let mut found = Vec::new();
    let mut only = vec![u32::MAX; mesh.vertices.len()];
    for (nodes, &patch) in mesh.triangles.nodes.iter().zip(&features.patch) {
        for v in nodes.map(|v| v as usize) {
            let foreign = match at[v] {
                (0, _) => only[v] != u32::MAX && only[v] != patch,
                (2, [edge, _]) => !patches_beside(features, edge).contains(&patch),
                _ => false,
            };
            only[v] = patch;
            if foreign {
                found.push(v);
            }
        }
    }
    found
}
