//! The edges of a set of triangles, each once, with the triangles around it.
use crate::tasks::Team;

/// Edges of triangles. Side s = 3·t + k is the edge from corner k to corner k + 1 of triangle t.
pub(crate) struct EdgeTable {
    /// Ends of each edge, the smaller index first, in increasing order; shape (n, 2).
    pub nodes: Vec<[u32; 2]>,
    /// Edge of each side, shape (3·triangles,).
    pub of_side: Vec<u32>,
    starts: Vec<u32>,
    sides: Vec<u32>,
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
        let mut table = Self {
            nodes: Vec::with_capacity(keys.len() / 2),
            of_side: vec![0; keys.len()],
            starts: Vec::with_capacity(keys.len() / 2 + 1),
            sides: Vec::with_capacity(keys.len()),
        };
        for (a, b, side) in keys {
            if table.nodes.last() != Some(&[a, b]) {
                table.nodes.push([a, b]);
                table.starts.push(table.sides.len() as u32);
            }
            table.of_side[side as usize] = (table.nodes.len() - 1) as u32;
            table.sides.push(side);
        }
        table.starts.push(table.sides.len() as u32);
        table
    }

    /// Number of edges.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Sides of an edge: two inside a manifold surface, one at its border, more where sheets meet.
    pub fn sides(&self, edge: usize) -> &[u32] {
        &self.sides[self.starts[edge] as usize..self.starts[edge + 1] as usize]
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
