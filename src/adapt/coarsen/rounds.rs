//! Items of a level done by all threads, with the same result whatever their number.
//!
//! In each round the level is cut into parts, which follow from the level and the items alone. A task does a part's items in their order, reads and
//! changes the map at vertices of its part alone, and leaves what needs others to the next round, which is cut elsewhere.
use super::level::{Balls, Level};
use crate::adapt::core::parts::{Parts, Sample};
use crate::tasks::{GRAIN, Rows, Team};
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// Most parts, whose numbers fit in a byte, and the least that are worth a round.
const MOST_PARTS: usize = 128;
const FEWEST_PARTS: usize = 4;

/// Least items a part. Few in the unit tests, whose meshes are small.
const ITEMS: usize = if cfg!(test) { 24 } else { 2048 };

/// The parts of so many vertices are found together.
const AT_ONCE: usize = 8;

/// Products with it are well mixed: 2³² over the golden ratio.
const MIXES: u32 = 0x9E37_79B9;

/// Where there are fewer tetrahedra an item than this, one pass over all of them tells which vertices have a neighbour in another part; else the
/// balls of those that are asked for are looked through.
const TETS_AN_ITEM: usize = 64;

/// What is known of a vertex: nothing; all its neighbours are in its part; one is in another.
const UNKNOWN: u8 = 0;
const INNER: u8 = 1;
const AT_ANOTHER: u8 = 2;

/// One part of a level.
pub struct Region<'r> {
    level: &'r Level<'r>,
    balls: &'r Balls,
    /// The part of each vertex; empty where all are in one.
    parts: &'r [u8],
    /// For each vertex [`UNKNOWN`], [`INNER`] or [`AT_ANOTHER`].
    known: &'r [AtomicU8],
    /// Whether all is known: what is still [`UNKNOWN`] is [`INNER`].
    is_known: bool,
    part: u8,
}

impl Region<'_> {
    /// Whether the part has a vertex.
    #[inline(always)]
    pub fn holds(&self, v: u32) -> bool {
        self.parts.is_empty() || self.parts[v as usize] == self.part
    }

    /// Whether the part has a vertex and all that are joined to it.
    #[inline]
    pub fn holds_ball(&self, v: u32) -> bool {
        if self.parts.is_empty() {
            return true;
        }
        if !self.holds(v) {
            return false;
        }
        let known = &self.known[v as usize];
        if self.is_known {
            return known.load(Relaxed) == UNKNOWN;
        }
        if known.load(Relaxed) == UNKNOWN {
            let is_inner = !self.balls.at(v).iter().any(|&t| is_between(self.parts, &self.level.tets[t as usize]));
            known.store(if is_inner { INNER } else { AT_ANOTHER }, Relaxed);
        }
        known.load(Relaxed) == INNER
    }
}

/// Whether a tetrahedron has vertices in different parts.
#[inline(always)]
fn is_between(parts: &[u8], nodes: &[u32; 4]) -> bool {
    let [a, b, c, d] = nodes.map(|v| parts[v as usize]);
    (a ^ b) | (a ^ c) | (a ^ d) != 0
}

/// Calls `work(part, items, left)` with the items of each part, round by round. It adds to `left` what needs vertices of other parts; in the last
/// round there is one part. `vertex` gives a vertex of an item. Returns all results, in the order of rounds and parts.
pub fn in_rounds<I: Copy + Ord + Send + Sync, T: Send>(
    team: Team<'_>,
    level: &Level,
    balls: &Balls,
    mut items: Vec<I>,
    vertex: impl Fn(I) -> u32 + Sync,
    work: impl Fn(&Region, &[I], &mut Vec<I>) -> T + Sync,
) -> Vec<T> {
    let mut results = Vec::new();
    let mut most = MOST_PARTS;
    loop {
        let count = (1 << (items.len() / ITEMS).max(1).ilog2()).min(most);
        if count < FEWEST_PARTS {
            let whole = Region { level, balls, parts: &[], known: &[], is_known: true, part: 0 };
            results.push(work(&whole, &items, &mut Vec::new()));
            return results;
        }
        let parts = parts(team, level, balls, items.len(), |at| vertex(items[at]), count);
        let known: Vec<AtomicU8> = bytemuck::allocation::zeroed_vec(parts.len());
        let is_known = level.tets.len() < TETS_AN_ITEM * items.len();
        if is_known {
            team.for_each(GRAIN, level.tets.len(), |range| {
                for nodes in level.tets[range].iter().filter(|nodes| is_between(&parts, nodes)) {
                    nodes.iter().for_each(|&v| known[v as usize].store(AT_ANOTHER, Relaxed));
                }
            });
        }
        let dealt = Rows::by_key(team, count, items.len(), |at| [u32::from(parts[vertex(items[at]) as usize])]);
        let done = team.chunks(1, count, |range| {
            let region = Region { level, balls, parts: &parts, known: &known, is_known, part: range.start as u8 };
            let own: Vec<I> = dealt.row(range.start).iter().map(|&at| items[at as usize]).collect();
            let mut left = Vec::new();
            (work(&region, &own, &mut left), left)
        });
        items.clear();
        for (result, left) in done {
            results.push(result);
            items.extend(left);
        }
        // Some were found bad more than once.
        team.sort(&mut items);
        items.dedup();
        // Fewer parts have less between them.
        most = count / 2;
    }
}

/// For each vertex of a level its part, of so many that hold about as many items each.
fn parts(
    team: Team<'_>,
    level: &Level,
    balls: &Balls,
    items: usize,
    vertex: impl Fn(usize) -> u32 + Sync,
    count: usize,
) -> Vec<u8> {
    let point = |v: u32| level.points[v as usize];
    let cuts = Parts::of(team, items, count, |at| {
        let v = vertex(at);
        let ball = balls.at(v);
        // Any of them: the first are all alike in a mesh that was made from a lattice.
        let t = ball.get(v.wrapping_mul(MIXES) as usize % ball.len().max(1))?;
        Some(Sample::of(point(v), level.tets[*t as usize].map(point)))
    });
    let mut parts = vec![0; level.points.len()];
    team.fill(GRAIN, &mut parts, |start, parts| {
        for (some, first) in parts.chunks_mut(AT_ONCE).zip((start..).step_by(AT_ONCE)) {
            let last = first + some.len() - 1;
            let held = cuts.hold::<AT_ONCE>(std::array::from_fn(|i| level.points[(first + i).min(last)]));
            some.iter_mut().zip(held).for_each(|(part, held)| *part = held as u8);
        }
    });
    parts
}
