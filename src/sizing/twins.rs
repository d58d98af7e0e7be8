//! Vertices and edges of a model that lie on each other.
use crate::geometry::{Evaluate, Geometry, Model, Topology};
use crate::mesh::disjoint_sets::DisjointSets;
use crate::mesh::vector::{Vec3, distance};

/// For each vertex and each edge the first one at the same place; itself where it is alone.
pub struct Twins {
    pub vertices: Vec<u32>,
    pub edges: Vec<u32>,
}

impl Twins {
    /// Vertices within the tolerance of each other are at one place. So are edges with the same ends whose middles are that near. (The tolerances that
    /// a model states are no measure: a thin part may be thinner.)
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
fn firsts(count: usize, tolerance: f64, mut place: impl FnMut(usize) -> Option<(Vec3, [u32; 2])>) -> Vec<u32> {
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

#[cfg(test)]
mod tests {
    use super::super::touch::Touch;
    use super::*;
    use crate::geometry::{Discrete, Entity};
    use crate::mesh::samples::cube;
    use crate::tasks::Team;

    /// Two cubes that meet in the edge x = y = 1, each with its own edge there.
    #[test]
    fn edges_that_lie_on_each_other_are_one() {
        let (mut mesh, other) = (cube(2), cube(2));
        let count = mesh.vertices.len() as u32;
        mesh.vertices.extend(other.vertices.iter().map(|p| [p[0] + 1.0, p[1] + 1.0, p[2]]));
        mesh.vertex_refs.extend(&other.vertex_refs);
        other.tets.iter().for_each(|(nodes, reference)| mesh.tets.push(nodes.map(|v| v + count), reference));
        let moved = other.triangles.iter().map(|(nodes, reference)| (nodes.map(|v| v + count), reference + 6));
        moved.for_each(|(nodes, reference)| mesh.triangles.push(nodes, reference));
        let (model, _) = Discrete::from_mesh(Team::alone(), &mesh, 30.0).unwrap();
        let model = Model::Discrete(model);
        let topology = model.topology();
        assert_eq!((topology.vertices.len(), topology.edges.len()), (16, 24));
        let twins = Twins::new(&model, 1e-9);
        let second = |firsts: &[u32]| (0..).zip(firsts).filter(|(i, first)| *i != **first).map(|pair| pair.0).collect();
        let (vertices, edges): (Vec<u32>, Vec<u32>) = (second(&twins.vertices), second(&twins.edges));
        assert_eq!((vertices.len(), edges.len()), (2, 1), "{vertices:?} {edges:?}");
        // So do the faces beside them touch, and faces that only meet there; faces that do not meet are apart.
        let touch = Touch::new(&model, 1e-9);
        let [own, of_other] = [twins.edges[edges[0] as usize], edges[0]];
        for f in topology.edges[own as usize].faces.iter() {
            assert!(touch.touches(Entity::Edge(of_other), Entity::Face(*f)));
            for g in topology.edges[of_other as usize].faces.iter() {
                assert!(touch.touches(Entity::Face(*f), Entity::Face(*g)));
            }
        }
        let far = |own: f64, all: f64| {
            (0..12).find(|f| {
                let [low, high] = topology.faces[*f as usize].bounds;
                low[0] == own && high[0] == own && low[1].floor() == all
            })
        };
        let (left, right) = (far(0.0, 0.0).unwrap(), far(2.0, 1.0).unwrap());
        assert!(!touch.touches(Entity::Face(left), Entity::Face(right)));
    }
}
