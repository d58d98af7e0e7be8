//! The edges of the mesh that are too long or too short: what is to be split and collapsed.
use super::ids::{TetId, VertexId};
use super::measure::{is_longer, is_shorter};
use super::store::Store;
use crate::mesh::adjacency::EDGES;
use crate::metric::edges::TetLanes;
use crate::metric::lanes::{LANES, Lanes};
use crate::tasks::Team;
use std::ops::Range;

/// An edge to be looked at, and a tetrahedron that held it when it was listed.
#[derive(Clone, Copy, Debug)]
pub struct EdgeItem {
    /// One end.
    pub a: VertexId,
    /// The other end.
    pub b: VertexId,
    /// Where to find the edge.
    pub tet: TetId,
}

/// An edge and the class of its length in the metric.
#[derive(Clone, Copy)]
pub struct Classed {
    /// The edge, the lesser vertex first, with the least of its tetrahedra.
    pub item: EdgeItem,
    /// Less than [`CLASSES`]: the longer the greater.
    pub class: u16,
}

/// Which edges are listed.
#[derive(Clone, Copy)]
pub enum Wanted {
    /// Those longer than this.
    Longer(f64),
    /// Those shorter than this.
    Shorter(f64),
}

impl Wanted {
    /// Whether an edge is, by its squared lengths in the metrics of both ends.
    #[inline(always)]
    fn is(self, a: f64, b: f64) -> bool {
        match self {
            Self::Longer(limit) => is_longer(a, b, limit),
            Self::Shorter(limit) => is_shorter(a, b, limit),
        }
    }

    /// Whether one of several edges may be: its length lies between those in both metrics.
    #[inline(always)]
    fn may_be(self, a: Lanes, b: Lanes) -> bool {
        match self {
            Self::Longer(limit) => a.max(b).any_above(limit * limit),
            Self::Shorter(limit) => a.min(b).any_below(limit * limit),
        }
    }
}

/// Number of classes of lengths.
pub const CLASSES: u32 = 1 << 11;

/// The class of an edge, by the fourth power of its length. Lengths in one class differ by less than a fifth.
#[inline(always)]
fn class(fourth_power: f64) -> u16 {
    (fourth_power.max(0.0).to_bits() >> 52) as u16
}

/// Ranks that [`in_order`] tells apart.
pub const RANKS: usize = 4 * CLASSES as usize;

/// Edges that a thread sorts at the least.
const SHARE: usize = if cfg!(test) { 64 } else { 1 << 13 };

/// Ranges of the ranks that are looked through side by side.
const RANGES: usize = 64;

/// The edges in the order of their ranks, which are less than [`RANKS`]. Edges of one rank, whose lengths hardly differ, stay in the
/// order of the mesh, so that consecutive items are near in memory. Each thread sorts a part of the edges by counting.
pub fn in_order(team: Team<'_>, edges: &[Classed], rank: impl Fn(&Classed) -> u32 + Sync) -> Vec<EdgeItem> {
    let share = edges.len().div_ceil(team.threads()).max(SHARE);
    let parts = team.chunks(share, edges.len(), |range| sorted_by_rank(&edges[range], &rank));
    if let [_] = parts[..] {
        return parts.into_iter().flat_map(|(_, items)| items).collect();
    }
    let of_rank = |rank: usize| parts.iter().map(move |(starts, items)| &items[starts[rank]..starts[rank + 1]]);
    let slices = team.collect(RANKS / RANGES, RANKS, |ranks, found| {
        found.extend(ranks.flat_map(of_rank).filter(|items| !items.is_empty()));
    });
    team.join_slices(slices.iter().copied())
}

/// The edges in the order of their ranks, and where each rank begins.
fn sorted_by_rank(edges: &[Classed], rank: impl Fn(&Classed) -> u32) -> (Vec<usize>, Vec<EdgeItem>) {
    let ranks: Vec<u16> = edges.iter().map(|edge| rank(edge) as u16).collect();
    // Counted two places on: while the edges are dealt out, each start moves to the next one's place.
    let mut starts = vec![0; RANKS + 2];
    ranks.iter().for_each(|&rank| starts[rank as usize + 2] += 1);
    for at in 1..starts.len() {
        starts[at] += starts[at - 1];
    }
    let nothing = EdgeItem { a: VertexId::NONE, b: VertexId::NONE, tet: TetId::NONE };
    let mut items = vec![nothing; edges.len()];
    for (edge, &rank) in edges.iter().zip(&ranks) {
        let place = &mut starts[rank as usize + 1];
        items[*place] = edge.item;
        *place += 1;
    }
    (starts, items)
}

/// The vertices of a tetrahedron are asked for when it is so many places ahead.
const FETCHED_AHEAD: u32 = 16;

/// Least number of tetrahedra in a part. An edge is met once for each of its tetrahedra, and these are near each other in memory, so
/// most duplicates are in the same part.
const PART: usize = 1 << 14;

/// Most parts of the tetrahedra, and most ranges of the vertices.
const PARTS: usize = 256;

/// The edges of tetrahedra that changed at or after a time and that are `wanted`, in the order of their vertices. Between sweeps only.
pub fn listed(team: Team<'_>, store: &Store, since: u32, wanted: Wanted) -> Vec<Classed> {
    let [tets, vertices] = [store.tet_bound(), store.vertex_bound()];
    let mut parts = team.chunks(PART.max(tets.div_ceil(PARTS)), tets, |range| listed_in(store, range, since, wanted));
    if parts.len() < 2 {
        return parts.pop().unwrap_or_default();
    }
    let range = vertices.div_ceil(PARTS).max(PART / 4);
    let merged = team.chunks(range, vertices, |range| merged(&parts, range));
    drop(parts);
    team.join(merged)
}

/// Places of edges that were found last, to know them again: most that are met twice are met soon.
const RECENT: usize = 1 << 10;

/// Where an edge is among those, by Knuth's multiplicative hashing.
#[inline(always)]
fn place_of([a, b]: [VertexId; 2]) -> usize {
    let mixed = (u64::from(a.0) << 32 | u64::from(b.0)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (mixed >> (u64::BITS - RECENT.ilog2())) as usize
}

/// The wanted edges of some tetrahedra, in the order of their vertices.
fn listed_in(store: &Store, tets: Range<usize>, since: u32, wanted: Wanted) -> Vec<Classed> {
    let mut found: Vec<Classed> = Vec::new();
    let mut recent = [u32::MAX; RECENT];
    let mut changed = store.live_tets_in(tets).filter(|&t| store.stamp(t) >= since).fuse();
    let (mut lanes, mut lengths) = (TetLanes::default(), [[Lanes::ZERO; 2]; 6]);
    let mut some = [TetId::NONE; LANES];
    loop {
        let mut count = 0;
        for (slot, t) in some.iter_mut().zip(&mut changed) {
            store.fetch_vertices(TetId(t.0.wrapping_add(FETCHED_AHEAD)));
            for (k, x) in store.vertices(t).into_iter().enumerate() {
                let (p, m) = (store.position(x), store.metric(x).0);
                (0..3).for_each(|i| lanes.points[k][i].0[count] = p[i]);
                (0..6).for_each(|i| lanes.metrics[k][i].0[count] = m[i]);
            }
            *slot = t;
            count += 1;
        }
        // Lanes beyond the count hold tetrahedra of before.
        lanes.squared_lengths(&mut lengths);
        for ([i, j], [at_i, at_j]) in EDGES.into_iter().zip(&lengths) {
            if !wanted.may_be(*at_i, *at_j) {
                continue;
            }
            for (lane, &t) in some[..count].iter().enumerate() {
                let (at_i, at_j) = (at_i.0[lane], at_j.0[lane]);
                if wanted.is(at_i, at_j) {
                    let v = store.vertices(t);
                    let (a, b) = (v[i].min(v[j]), v[i].max(v[j]));
                    let known = &mut recent[place_of([a, b])];
                    match found.get_mut(*known as usize) {
                        Some(Classed { item, .. }) if (item.a, item.b) == (a, b) => item.tet = item.tet.min(t),
                        _ => {
                            *known = found.len() as u32;
                            found.push(Classed { item: EdgeItem { a, b, tet: t }, class: class(at_i * at_j) });
                        }
                    }
                }
            }
        }
        if count < LANES {
            break;
        }
    }
    found.sort_unstable_by_key(key);
    found.dedup_by_key(ends);
    found.shrink_to_fit();
    found
}

/// The edges of all parts whose lesser vertex is in a range.
fn merged(parts: &[Vec<Classed>], vertices: Range<usize>) -> Vec<Classed> {
    let of_part = |part: &'_ Vec<Classed>| {
        let [start, end] = [vertices.start, vertices.end].map(|v| part.partition_point(|edge| edge.item.a.index() < v));
        start..end
    };
    let mut found: Vec<Classed> = Vec::new();
    parts.iter().for_each(|part| found.extend_from_slice(&part[of_part(part)]));
    // Sorted pieces: this sort merges them.
    found.sort_by_key(key);
    found.dedup_by_key(ends);
    found
}

fn key(edge: &Classed) -> u128 {
    u128::from(edge.item.a.0) << 64 | u128::from(edge.item.b.0) << 32 | u128::from(edge.item.tet.0)
}

fn ends(edge: &mut Classed) -> (VertexId, VertexId) {
    (edge.item.a, edge.item.b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::fill::{self, Filled};
    use crate::geometry::Discrete;
    use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
    use crate::mesh::adjacency::unique_edges;
    use crate::mesh::samples::cube;
    use crate::metric::{Background, Source, Sym3};
    use crate::tasks::{Plan, Pool};
    use std::collections::BTreeSet;

    fn ends_of(item: &EdgeItem) -> [VertexId; 2] {
        [item.a, item.b]
    }

    #[test]
    fn every_wanted_edge_with_its_least_tetrahedron() {
        let mesh = cube(3);
        let (_, place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).unwrap();
        let logs = vec![Sym3::ZERO; mesh.vertices.len()];
        let source = Source::Background(Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs));
        let Filled { store, ids, .. } = fill::fill(Team::alone(), &mesh, &place, &source).unwrap();
        let ends = |[a, b]: [u32; 2]| {
            let (a, b) = (ids[a as usize], ids[b as usize]);
            [a.min(b), a.max(b)]
        };
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
            let found = listed(Team::alone(), &store, since, Wanted::Shorter(0.4));
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
        assert_eq!(order(in_order(Team::alone(), &edges, |edge| u32::from(edge.class))), [5, 2, 6, 0, 3, 1, 4]);
        assert_eq!(
            order(in_order(Team::alone(), &edges, |edge| CLASSES - 1 - u32::from(edge.class))),
            [4, 1, 0, 3, 2, 6, 5]
        );
        assert!(edges.iter().all(|edge| u32::from(edge.class) < CLASSES));
        assert!(in_order(Team::alone(), &[], |edge| u32::from(edge.class)).is_empty());
        // Shared out among threads, it is the same.
        let many: Vec<_> = (0..500).map(|k| Classed { item: item(k), class: (k * k % 701) as u16 }).collect();
        let alone = in_order(Team::alone(), &many, |edge| u32::from(edge.class));
        for threads in [2, 3, 8] {
            let pool = Pool::new(threads).unwrap();
            let found = in_order(Team::new(&pool, Plan::default()), &many, |edge| u32::from(edge.class));
            assert!(found.iter().map(ends_of).eq(alone.iter().map(ends_of)));
        }
        // A fifth more is another class.
        assert_ne!(class(1.2f64.powi(4)), class(1.0));
    }
}
