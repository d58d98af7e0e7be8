//! The edges of the mesh that are too long or too short: what is to be split and collapsed.
use super::ids::{TetId, VertexId};
use super::insert::EdgeItem;
use super::store::Store;
use crate::mesh::vector::sub;

/// An edge and the class of its length in the metric.
pub struct Classed {
    /// The edge, the lesser vertex first, with the least of its tetrahedra.
    pub item: EdgeItem,
    /// Less than [`CLASSES`]: the longer the greater.
    pub class: u16,
}

/// Number of classes of lengths.
pub const CLASSES: u32 = 1 << 11;

/// Class of an edge whose fourth power of the length is given: lengths in one class differ by less than a fifth.
#[inline(always)]
fn class(fourth_power: f64) -> u16 {
    (fourth_power.max(0.0).to_bits() >> 52) as u16
}

/// The edges in the order of their ranks; those of one rank, whose lengths hardly differ, stay in the order of the mesh, so that what
/// is done next is near in memory. A counting sort.
pub fn in_order(edges: &[Classed], rank: impl Fn(&Classed) -> u32) -> Vec<EdgeItem> {
    let greatest = edges.iter().map(&rank).max().unwrap_or(0) as usize;
    let mut places = vec![0usize; greatest + 2];
    edges.iter().for_each(|edge| places[rank(edge) as usize + 1] += 1);
    for at in 1..places.len() {
        places[at] += places[at - 1];
    }
    let nothing = EdgeItem { a: VertexId::NONE, b: VertexId::NONE, tet: TetId::NONE };
    let mut items = vec![nothing; edges.len()];
    for edge in edges {
        let place = &mut places[rank(edge) as usize];
        items[*place] = edge.item;
        *place += 1;
    }
    items
}

/// The edges that pass the test of their squared lengths in the metrics of both ends, each once, in no particular order; of those
/// that have an end where something changed (`changed`, by vertex). Between sweeps only.
///
/// Each vertex is asked for its edges to greater ones, so that no list of all edges of all tetrahedra is made and sorted.
pub fn listed(store: &Store, changed: &[bool], wanted: impl Fn(f64, f64) -> bool) -> Vec<Classed> {
    let mut found = Vec::new();
    let mut ball = Ball::new(store);
    for a in store.live_vertices().filter(|a| changed[a.index()]) {
        ball.gather(a);
        for &(b, tet) in &ball.edges {
            // Both ends changed: the edge is found at the lesser one.
            if b < a && changed[b.index()] {
                continue;
            }
            let v = sub(store.position(b), store.position(a));
            let (at_a, at_b) = (store.metric(a).quadratic(v), store.metric(b).quadratic(v));
            if wanted(at_a, at_b) {
                found.push(Classed { item: EdgeItem { a: a.min(b), b: a.max(b), tet }, class: class(at_a * at_b) });
            }
        }
    }
    found
}

/// The edges at one vertex.
struct Ball<'s> {
    store: &'s Store,
    /// By tetrahedron, a bit in words of 64, whether it is in `tets`: small enough to stay near the processor.
    seen: Vec<u64>,
    /// By vertex its place in `edges`, counted from 1; 0 when it is not there.
    places: Vec<u32>,
    tets: Vec<TetId>,
    /// The other ends, each with the least tetrahedron.
    edges: Vec<(VertexId, TetId)>,
}

impl<'s> Ball<'s> {
    fn new(store: &'s Store) -> Self {
        Self {
            store,
            seen: vec![0; store.tet_bound().div_ceil(64)],
            places: vec![0; store.vertex_bound()],
            tets: Vec::new(),
            edges: Vec::new(),
        }
    }

    /// Takes a tetrahedron in, if it is not there yet.
    fn take(&mut self, t: TetId) {
        let (word, bit) = (&mut self.seen[t.index() / 64], 1 << (t.index() % 64));
        if *word & bit == 0 {
            *word |= bit;
            self.tets.push(t);
        }
    }

    /// Collects the edges at a.
    fn gather(&mut self, a: VertexId) {
        self.edges.drain(..).for_each(|(b, _)| self.places[b.index()] = 0);
        self.take(self.store.tet_of(a));
        let mut next = 0;
        while let Some(&t) = self.tets.get(next) {
            next += 1;
            let (vertices, neighbours) = (self.store.vertices(t), self.store.neighbours(t));
            for (b, n) in vertices.into_iter().zip(neighbours).filter(|&(b, _)| b != a) {
                if n.is_some() {
                    self.take(n);
                }
                let place = &mut self.places[b.index()];
                if *place == 0 {
                    self.edges.push((b, t));
                    *place = self.edges.len() as u32;
                } else {
                    let tet = &mut self.edges[*place as usize - 1].1;
                    *tet = t.min(*tet);
                }
            }
        }
        self.tets.drain(..).for_each(|t| self.seen[t.index() / 64] = 0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::build::{self, Filled};
    use super::*;
    use crate::geometry::Discrete;
    use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
    use crate::mesh::adjacency::unique_edges;
    use crate::mesh::samples::cube;
    use crate::metric::{Background, Source, Sym3};
    use std::collections::BTreeSet;

    fn ends_of(item: &EdgeItem) -> [VertexId; 2] {
        [item.a, item.b]
    }

    #[test]
    fn every_wanted_edge_once_with_its_least_tetrahedron() {
        let mesh = cube(3);
        let (_, place) = Discrete::from_mesh(&mesh, DEFAULT_RIDGE_ANGLE).unwrap();
        let logs = vec![Sym3::ZERO; mesh.vertices.len()];
        let source = Source::Background(Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs));
        let Filled { store, ids, .. } = build::fill(&mesh, &place, &source).unwrap();
        let ends = |[a, b]: [u32; 2]| {
            let (a, b) = (ids[a as usize], ids[b as usize]);
            [a.min(b), a.max(b)]
        };
        let is_short = |a: f64, b: f64| a < 0.16 && b < 0.16;
        let all: BTreeSet<_> = unique_edges(&mesh.tets.nodes).into_iter().map(ends).collect();
        let length = |[a, b]: [VertexId; 2]| crate::mesh::vector::distance(store.position(a), store.position(b));
        for changed in [vec![true; ids.len()], (0..ids.len()).map(|v| v % 5 == 0).collect()] {
            let touched = |edge: &&[VertexId; 2]| edge.iter().any(|v| changed[v.index()]);
            let expected: BTreeSet<_> = all.iter().filter(touched).copied().filter(|&e| length(e) < 0.4).collect();
            let found = listed(&store, &changed, is_short);
            assert_eq!(found.len(), expected.len());
            assert_eq!(found.iter().map(|edge| ends_of(&edge.item)).collect::<BTreeSet<_>>(), expected);
            for Classed { item, class: of } in &found {
                assert_eq!(*of, class(length(ends_of(item)).powi(4)));
                let holds = |t: &TetId| ends_of(item).iter().all(|v| store.vertices(*t).contains(v));
                assert_eq!(store.live_tets().find(holds), Some(item.tet));
            }
        }
    }

    #[test]
    fn classes_follow_the_lengths() {
        let lengths: [f64; 7] = [0.3, 2.0, 0.1, 0.301, 7.5, 0.0, 0.1];
        let vertex = |k: usize| VertexId(k as u32);
        let item = |k| EdgeItem { a: vertex(k), b: vertex(k + 1), tet: TetId(0) };
        let classed = |(k, length): (usize, &f64)| Classed { item: item(k), class: class(length.powi(4)) };
        let edges: Vec<_> = lengths.iter().enumerate().map(classed).collect();
        let order = |items: Vec<EdgeItem>| items.iter().map(|item| item.a.0).collect::<Vec<_>>();
        assert_eq!(order(in_order(&edges, |edge| u32::from(edge.class))), [5, 2, 6, 0, 3, 1, 4]);
        assert_eq!(order(in_order(&edges, |edge| CLASSES - 1 - u32::from(edge.class))), [4, 1, 0, 3, 2, 6, 5]);
        assert!(edges.iter().all(|edge| u32::from(edge.class) < CLASSES));
        assert!(in_order(&[], |edge| u32::from(edge.class)).is_empty());
        // A fifth more is another class.
        assert_ne!(class(1.2f64.powi(4)), class(1.0));
    }
}
