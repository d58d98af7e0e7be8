//! Vertices and edges of a model that lie on each other.
use crate::geometry::{Evaluate, Geometry, Model, Topology};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::vector::distance;

/// For each vertex and each edge the first one that lies where it does: itself, but where there are several.
pub struct Twins {
    pub vertices: Vec<u32>,
    pub edges: Vec<u32>,
}

impl Twins {
    /// Vertices nearer than the tolerance are at one place; so are edges with the same ends whose middles are that near.
    pub fn new(model: &Model, tolerance: f64) -> Self {
        let topology = model.topology();
        let vertices = firsts(topology.vertices.len(), tolerance, |v| Some((topology.vertices[v].point, [0; 2])));
        let mut evaluator = model.evaluator();
        let edges = firsts(topology.edges.len(), tolerance, |e| {
            let edge = &topology.edges[e];
            let mut ends = edge.vertices.map(|end| end.map_or(u32::MAX, |v| vertices[v as usize]));
            ends.sort_unstable();
            let middle = 0.5 * (edge.range[0] + edge.range[1]);
            (!edge.degenerate).then(|| (evaluator.edge_frame(e as u32, middle).point, ends))
        });
        Self { vertices, edges }
    }

    /// First twins of the ends of an edge.
    pub fn ends(&self, topology: &Topology, edge: u32) -> impl Iterator<Item = u32> + use<'_> {
        topology.edges[edge as usize].vertices.into_iter().flatten().map(|v| self.vertices[v as usize])
    }
}

/// The first item at the place of each, with the same mark; items without a place are alone.
fn firsts(
    count: usize,
    tolerance: f64,
    mut place: impl FnMut(usize) -> Option<(crate::mesh::vector::Vec3, [u32; 2])>,
) -> Vec<u32> {
    let mut parts = DisjointSets::new(count);
    let mut items: Vec<_> = (0..count).filter_map(|i| place(i).map(|(point, mark)| (point, mark, i as u32))).collect();
    items.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.2.cmp(&b.2)));
    for (k, a) in items.iter().enumerate() {
        let near = items[k + 1..].iter().take_while(|b| b.0[0] - a.0[0] <= tolerance);
        for b in near.filter(|b| b.1 == a.1 && distance(a.0, b.0) <= tolerance) {
            parts.join(a.2, b.2);
        }
    }
    (0..count as u32).map(|i| parts.first(i)).collect()
}
