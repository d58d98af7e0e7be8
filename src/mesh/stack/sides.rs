//! The faces of the cells, matched.
use super::Stack;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::{FACES, sorted3};
use std::collections::HashSet;

/// A face of a cell.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// Its nodes, ascending.
    key: Vec<u32>,
    /// The cell.
    pub cell: usize,
    /// Its nodes, as the cell has them.
    pub nodes: Vec<u32>,
}

/// The faces of all cells, equal ones together.
pub(super) struct Sides(Vec<Side>);

impl Sides {
    /// Of a stack.
    pub fn of(stack: &Stack) -> Self {
        let mut sides = Vec::new();
        for (cell, of) in stack.cells.iter().enumerate() {
            for nodes in of.faces() {
                let mut key = nodes.clone();
                key.sort_unstable();
                sides.push(Side { key, cell, nodes });
            }
        }
        sides.sort_unstable();
        Self(sides)
    }

    /// The cells at each face.
    pub fn groups(&self) -> impl Iterator<Item = &[Side]> {
        self.0.chunk_by(|a, b| a.key == b.key)
    }

    /// The faces of one cell alone.
    pub fn open(&self) -> impl Iterator<Item = &Side> {
        self.groups().filter(|group| group.len() == 1).map(|group| &group[0])
    }

    /// Whether there is a face of these nodes.
    pub fn has(&self, nodes: &[u32]) -> bool {
        let mut key = nodes.to_vec();
        key.sort_unstable();
        self.0.binary_search_by(|side| side.key.cmp(&key)).is_ok()
    }
}

/// Of the triangles those that are faces of the mesh's own tetrahedra: by their nodes, ascending.
pub(super) fn against_tets(stack: &Stack, mesh: &TetMesh, triangles: &HashSet<[u32; 3]>) -> HashSet<[u32; 3]> {
    let mut near = vec![false; mesh.vertices.len()];
    triangles.iter().flatten().for_each(|&v| near[v as usize] = true);
    let is_near = |v: u32| near.get(v as usize).copied().unwrap_or(false);
    let own = &mesh.tets.nodes[..stack.own[0]];
    let faces = own.iter().filter(|nodes| nodes.iter().filter(|&&v| is_near(v)).count() > 2);
    faces
        .flat_map(|nodes| FACES.map(|face| sorted3(face.map(|i| nodes[i]))))
        .filter(|face| triangles.contains(face))
        .collect()
}
