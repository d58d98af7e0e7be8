//! Ridges and patches of a surface mesh, from references, listed edges and dihedral angles.
use super::EdgeTable;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, area2, dot, unit};
use crate::tasks::Team;

/// Edges that are features, and the patches between them.
pub(crate) struct Features {
    /// Edges of the triangles.
    pub edges: EdgeTable,
    /// Whether an edge is a ridge, per edge.
    pub ridge: Vec<bool>,
    /// Reference of the mesh edge listed in the file, per edge.
    pub listed: Vec<Option<i32>>,
    /// Patch of each triangle.
    pub patch: Vec<u32>,
    /// Number of patches.
    pub patches: usize,
}

impl Features {
    /// Finds the ridges: listed edges, edges between references, borders and non-manifold edges, and edges at
    /// which the normals turn by more than the angle; then the patches that they enclose.
    pub fn detect(team: Team<'_>, mesh: &TetMesh, ridge_angle_deg: f64) -> Self {
        let triangles = &mesh.triangles;
        let edges = EdgeTable::new(team, &triangles.nodes);
        let mut listed = vec![None; edges.len()];
        for (nodes, reference) in mesh.edges.iter() {
            if let Some(edge) = edges.find(nodes[0], nodes[1]) {
                listed[edge] = Some(reference);
            }
        }
        let normals: Vec<Vec3> = triangles.nodes.iter().map(|nodes| unit(area2_of(mesh, *nodes))).collect();
        let least_cosine = ridge_angle_deg.to_radians().cos();
        let ridge: Vec<bool> = (0..edges.len())
            .map(|edge| {
                let &[first, second] = edges.sides(edge) else { return true };
                let (t, s) = (first as usize / 3, second as usize / 3);
                listed[edge].is_some()
                    || triangles.refs[t] != triangles.refs[s]
                    || turn_cosine(triangles, &normals, first, second) < least_cosine
            })
            .collect();
        let (patch, patches) = flood(&edges, &ridge, triangles.len());
        Self { edges, ridge, listed, patch, patches }
    }

    /// Triangles of each patch.
    pub fn members(&self) -> Vec<Vec<u32>> {
        let mut members = vec![Vec::new(); self.patches];
        for (t, &patch) in self.patch.iter().enumerate() {
            members[patch as usize].push(t as u32);
        }
        members
    }
}

fn area2_of(mesh: &TetMesh, nodes: [u32; 3]) -> Vec3 {
    let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
    area2(a, b, c)
}

/// Cosine between the normals of the two triangles of an edge, whichever way each is listed.
fn turn_cosine(triangles: &crate::mesh::Elements<3>, normals: &[Vec3], first: u32, second: u32) -> f64 {
    let start = |side: u32| triangles.nodes[side as usize / 3][side as usize % 3];
    let cosine = dot(normals[first as usize / 3], normals[second as usize / 3]);
    // Neighbours that are oriented alike run along their common edge in opposite directions.
    if start(first) == start(second) { -cosine } else { cosine }
}

/// Connected triangles across edges that are no ridges: the component of each, and their number.
fn flood(edges: &EdgeTable, ridge: &[bool], triangles: usize) -> (Vec<u32>, usize) {
    let mut patch = vec![u32::MAX; triangles];
    let mut patches = 0;
    let mut stack = Vec::new();
    for seed in 0..triangles {
        if patch[seed] != u32::MAX {
            continue;
        }
        patch[seed] = patches;
        stack.push(seed);
        while let Some(t) = stack.pop() {
            for &edge in &edges.of_side[3 * t..3 * t + 3] {
                if ridge[edge as usize] {
                    continue;
                }
                for s in edges.triangles(edge as usize) {
                    if patch[s] == u32::MAX {
                        patch[s] = patches;
                        stack.push(s);
                    }
                }
            }
        }
        patches += 1;
    }
    (patch, patches as usize)
}
