//! Edges that lie on each other without being one, where bodies touch: they are divided alike, so that their pieces do not cross.
use crate::geometry::{Evaluate, Geometry, OcctModel};
use crate::mesh::vector::distance;
use std::collections::BTreeMap;

/// How near twins are, as a share of the model's diagonal.
const NEAR: f64 = 1e-7;
/// Shares of an edge's range at which two are compared.
const SHARES: [f64; 3] = [0.27, 0.5, 0.81];

/// Which edge another follows.
#[derive(Clone, Debug, Default)]
pub struct Twins {
    /// For each edge the one that it follows, and whether against its direction.
    pub follows: Vec<Option<(u32, bool)>>,
    /// For each vertex the first at its place.
    pub first: Vec<u32>,
}

impl Twins {
    /// Finds the twins of a model.
    pub fn of(model: &OcctModel) -> Self {
        let topology = model.topology();
        let near = NEAR * topology.diagonal();
        let count = topology.vertices.len();
        let mut first: Vec<u32> = (0..count as u32).collect();
        let mut order: Vec<usize> = (0..count).collect();
        let at = |v: usize| topology.vertices[v].point;
        order.sort_by(|&v, &w| at(v)[0].total_cmp(&at(w)[0]).then(v.cmp(&w)));
        for (i, &v) in order.iter().enumerate() {
            for &w in order[i + 1..].iter().take_while(|&&w| at(w)[0] - at(v)[0] <= near) {
                if distance(at(v), at(w)) <= near {
                    let [a, b] = [first[v], first[w]];
                    let least = a.min(b);
                    (first[v], first[w]) = (least, least);
                }
            }
        }
        let mut twins = Self { follows: vec![None; topology.edges.len()], first };
        let mut groups: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (i, edge) in topology.edges.iter().enumerate().filter(|(_, edge)| !edge.degenerate) {
            if let [Some(a), Some(b)] = edge.vertices {
                let [a, b] = [a, b].map(|v| twins.first[v as usize]);
                groups.entry([a.min(b), a.max(b)]).or_default().push(i as u32);
            }
        }
        let mut on = model.evaluator();
        for group in groups.values().filter(|group| group.len() > 1) {
            for (i, &edge) in group.iter().enumerate() {
                let entity = &topology.edges[edge as usize];
                twins.follows[edge as usize] = group[..i].iter().find_map(|&other| {
                    let of = &topology.edges[other as usize];
                    if twins.follows[other as usize].is_some()
                        || of.faces.iter().any(|face| entity.faces.contains(face))
                    {
                        return None;
                    }
                    let t = SHARES.map(|s| {
                        let point = on.edge_frame(edge, entity.range[0] * (1.0 - s) + entity.range[1] * s).point;
                        let foot = on.closest_on_edge(other, point, None);
                        (foot.t, foot.distance)
                    });
                    let is_on = t.iter().all(|(_, off)| *off <= near);
                    let rises = t[0].0 < t[1].0 && t[1].0 < t[2].0;
                    let falls = t[0].0 > t[1].0 && t[1].0 > t[2].0;
                    (is_on && (rises || falls)).then_some((other, falls))
                });
            }
        }
        twins
    }

    /// The edge that leads, and a piece of it, for a piece of an edge of so many.
    pub fn leader(&self, edge: u32, piece: u32, count: usize) -> (u32, u32) {
        match self.follows[edge as usize] {
            Some((other, true)) => (other, (count as u32).saturating_sub(piece + 1)),
            Some((other, false)) => (other, piece),
            None => (edge, piece),
        }
    }
}
