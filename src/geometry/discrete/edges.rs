//! The edges of a set of triangles, each once, with the triangles around it.
use crate::tasks::{Rows, Team};

/// Edges of triangles. Side s = 3·t + k is the edge from corner k to corner k + 1 of triangle t.
pub(crate) struct EdgeTable {
    /// Ends of each edge, the smaller index first, in increasing order; shape (n, 2).
    pub nodes: Vec<[u32; 2]>,
    /// Edge of each side, shape (3·triangles,).
    pub of_side: Vec<u32>,
    /// The sides of each edge.
    sides: Rows,
}

impl EdgeTable {
    /// Collects the edges of the triangles.
    pub fn new(team: Team<'_>, triangles: &[[u32; 3]]) -> Self {
        let mut keys: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * triangles.len());
        for (t, nodes) in triangles.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (nodes[k], nodes[(k + 1) % 3]);
                keys.push((a.min(b), a.max(b), (3 * t + k) as u32));
            }
        }
        team.sort(&mut keys);
        let (mut nodes, mut of_side) = (Vec::with_capacity(keys.len() / 2), vec![0; keys.len()]);
        for (a, b, side) in keys {
            if nodes.last() != Some(&[a, b]) {
                nodes.push([a, b]);
            }
            of_side[side as usize] = (nodes.len() - 1) as u32;
        }
        let sides = Rows::by_key(team, nodes.len(), of_side.len(), |side| [of_side[side]]);
        Self { nodes, of_side, sides }
    }

    /// Number of edges.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Sides of an edge: two inside a manifold surface, one at its border, more where sheets meet.
    pub fn sides(&self, edge: usize) -> &[u32] {
        self.sides.row(edge)
    }

    /// Triangles around an edge.
    pub fn triangles(&self, edge: usize) -> impl Iterator<Item = usize> + '_ {
        self.sides(edge).iter().map(|&side| side as usize / 3)
    }

    /// The edge between two vertices, in either order.
    pub fn find(&self, a: u32, b: u32) -> Option<usize> {
        self.nodes.binary_search(&[a.min(b), a.max(b)]).ok()
    }
}
