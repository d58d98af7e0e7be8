//! The edges of the mesh that are too long or too short: what is to be split and collapsed.
use super::ids::{EDGE, TetId, VertexId};
use super::insert::EdgeItem;
use super::store::Store;
use crate::mesh::vector::sub;

/// An edge and the class of its length in the metric.
#[derive(Clone, Copy)]
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

/// Edges listed before those that were listed twice are taken out: with each of its tetrahedra an edge comes again, and what is near in
/// memory is near in space.
const AT_ONCE: usize = 1 << 16;

/// The edges of tetrahedra that changed at or after a time, as far as they pass the test of their squared lengths in the metrics of both
/// ends; a few of them twice. In the order of their vertices within blocks. Between sweeps only.
pub fn listed(store: &Store, since: u32, wanted: impl Fn(f64, f64) -> bool) -> Vec<Classed> {
    let mut found: Vec<Classed> = Vec::new();
    let mut sorted = 0;
    for t in store.live_tets().filter(|&t| store.stamp(t) >= since) {
        let v = store.vertices(t);
        let (p, m) = (v.map(|x| store.position(x)), v.map(|x| store.metric(x)));
        for [i, j] in EDGE {
            let e = sub(p[j], p[i]);
            let (at_i, at_j) = (m[i].quadratic(e), m[j].quadratic(e));
            if wanted(at_i, at_j) {
                let item = EdgeItem { a: v[i].min(v[j]), b: v[i].max(v[j]), tet: t };
                found.push(Classed { item, class: class(at_i * at_j) });
            }
        }
        if found.len() >= sorted + AT_ONCE {
            sorted = without_doubles(&mut found, sorted);
        }
    }
    without_doubles(&mut found, sorted);
    found
}

/// Sorts what comes after `sorted` and takes doubles out of it; returns the length.
fn without_doubles(edges: &mut Vec<Classed>, sorted: usize) -> usize {
    let key = |edge: &Classed| (edge.item.a, edge.item.b, edge.item.tet);
    edges[sorted..].sort_unstable_by_key(key);
    let mut length = sorted;
    for i in sorted..edges.len() {
        let (edge, last) = (edges[i], length.checked_sub(1).map(|last| edges[last].item));
        if length == sorted || last.is_none_or(|last| (last.a, last.b) != (edge.item.a, edge.item.b)) {
            edges[length] = edge;
            length += 1;
        }
    }
    edges.truncate(length);
    length
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
    fn every_wanted_edge_with_its_least_tetrahedron() {
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
        let before = store.clock() + 1;
        store.tick();
        store.live_tets().filter(|t| t.0 % 5 == 0).for_each(|t| store.touch(t));
        for since in [0, before] {
            let touched = |edge: &&[VertexId; 2]| {
                let holds = |t: &TetId| edge.iter().all(|v| store.vertices(*t).contains(v));
                store.live_tets().filter(|&t| store.stamp(t) >= since).any(|t| holds(&t))
            };
            let expected: BTreeSet<_> = all.iter().filter(touched).copied().filter(|&e| length(e) < 0.4).collect();
            let found = listed(&store, since, is_short);
            assert_eq!(found.len(), expected.len());
            assert_eq!(found.iter().map(|edge| ends_of(&edge.item)).collect::<BTreeSet<_>>(), expected);
            for Classed { item, class: of } in &found {
                assert_eq!(*of, class(length(ends_of(item)).powi(4)));
                let holds = |t: &TetId| ends_of(item).iter().all(|v| store.vertices(*t).contains(v));
                let mut fresh = store.live_tets().filter(|&t| store.stamp(t) >= since);
                assert_eq!(fresh.find(holds), Some(item.tet));
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
