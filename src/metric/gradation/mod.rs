//! Gradation: sizes grow from vertex to vertex at a bounded rate. Mixed-space homogeneous (Alauzet 2010, §6.2.1; METHOD.md §1.7).
//!
//! For an edge pq with vector e the metric of p grows to q: G has the eigenvectors of M_p and the eigenvalues
//! λ_i · [(1 + √λ_i |e| ln r)^t (1 + L_p(e) ln r)^(1−t)]^(−2), t = 1/8; M_q ← M_q ∩ G, both ways, until nothing changes.
//!
//! Only vertices that have changed are sources of a round, those with the least changed size first, since sizes only grow on their way (as
//! Δ-stepping does for shortest paths: Meyer & Sanders 2003). A round takes all changed vertices whose least changed sizes are within a
//! class. Each neighbour of a source intersects its metric with those grown from its sources, in the order of their numbers, from the
//! values of the round before. So the result is the same bit for bit on any number of threads.
mod growth;
mod measure;
#[cfg(test)]
mod tests;

use super::Sym3;
use super::frame::{Frame, Relative};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::{GRAIN, Team};
pub use measure::{Growths, measure};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering::Relaxed};

/// An intersection that raises no eigenvalue by more than this share (a size by half of it) is no change. With 1e-6 a field of strong and
/// turning anisotropy takes half as many updates more, for sizes that no mesh can tell apart.
const TOLERANCE: f64 = 1e-3;

/// Changed sizes within this factor of the least one are one class.
const CLASS: f64 = 1.25;

/// Vertices a task: one takes a microsecond or two.
const FEW: usize = 1 << 8;

/// Words of 64 vertices a task of the search for targets. Most words are zero.
const WORDS: usize = 1 << 14;

/// What grading did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Graded {
    /// Rounds of the front.
    pub rounds: usize,
    /// Metrics that were replaced, in all rounds.
    pub updates: usize,
    /// Vertices that have another metric than before.
    pub changed: usize,
}

/// Grades ln M at the vertices, shape (n,), by a ratio r > 1, along the edges of the
/// tetrahedra, or of the triangles where there is no tetrahedron. Vertices without an edge stay as they are. So does, bit for bit, every
/// metric that is graded already.
///
/// # Panics
/// When there are not as many metrics as vertices.
pub fn grade(team: Team<'_>, mesh: &TetMesh, logs: &mut [Sym3], ratio: f64) -> Graded {
    grade_with(team, &mesh.vertices, &VertexNeighbours::of_mesh(team, mesh), logs, ratio)
}

/// As [`grade`], with the neighbours of the vertices along the edges.
///
/// # Panics
/// As [`grade`].
pub fn grade_with(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    ratio: f64,
) -> Graded {
    assert_eq!(vertices.len(), logs.len(), "one ln M a vertex");
    Grading::new(team, vertices, around, logs, ratio.ln()).run(|_, _| true)
}

/// As [`grade_with`], where all but the vertices from `first` on were graded together before the others came between them.
pub fn grade_added(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    (ratio, first): (f64, usize),
) -> Graded {
    let is_added = |v: u32| v as usize >= first;
    Grading::new(team, vertices, around, logs, ratio.ln()).run(|p, q| is_added(p) || is_added(q))
}

/// As [`grade_with`], where only the metrics of some vertices have become finer since all were graded.
pub fn grade_again(
    team: Team<'_>,
    vertices: &[Vec3],
    around: &VertexNeighbours,
    logs: &mut [Sym3],
    (ratio, finer): (f64, &[u32]),
) -> Graded {
    let mut is_finer = vec![false; logs.len()];
    finer.iter().for_each(|&v| is_finer[v as usize] = true);
    Grading::new(team, vertices, around, logs, ratio.ln()).run(|p, _| is_finer[p as usize])
}

/// The list in which a vertex waits to be a source.
const NOWHERE: u8 = 0;
const NEAR: u8 = 1;
const FAR: u8 = 2;

/// A new metric of a vertex.
#[derive(Clone, Copy)]
struct Update {
    vertex: u32,
    log: Sym3,
    frame: Frame,
    /// The least size that has changed.
    least_changed: f64,
}

struct Grading<'a> {
    team: Team<'a>,
    vertices: &'a [Vec3],
    around: &'a VertexNeighbours,
    logs: &'a mut [Sym3],
    /// The frames of `logs`, always made by [`Frame::of_log`], so that a second grading starts from the same bits.
    frames: Vec<Frame>,
    /// ln r.
    growth: f64,
    /// [`NOWHERE`], [`NEAR`] or [`FAR`].
    places: Vec<AtomicU8>,
    /// For each vertex that waits, its least changed size.
    least_changed: Vec<f64>,
    /// Whether a vertex is a source of this round.
    is_source: Vec<AtomicBool>,
    /// Whether a vertex is a neighbour of a source, a bit each.
    targets: Vec<AtomicU64>,
    changed: Vec<bool>,
}

impl<'a> Grading<'a> {
    fn new(
        team: Team<'a>,
        vertices: &'a [Vec3],
        around: &'a VertexNeighbours,
        logs: &'a mut [Sym3],
        growth: f64,
    ) -> Self {
        let count = logs.len();
        Self {
            team,
            vertices,
            around,
            frames: team.map(GRAIN, count, |v| Frame::of_log(&logs[v])),
            logs,
            growth,
            places: team.map_with(GRAIN, count, || (), |(), _| AtomicU8::new(NOWHERE)),
            least_changed: vec![0.0; count],
            is_source: team.map_with(GRAIN, count, || (), |(), _| AtomicBool::new(false)),
            targets: (0..count.div_ceil(64)).map(|_| AtomicU64::new(0)).collect(),
            changed: vec![false; count],
        }
    }

    /// Grades all, where only edges from p to q that are `open` need to be looked at.
    fn run(mut self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Graded {
        let mut graded = Graded::default();
        let mut waiting = self.violators(is_open);
        loop {
            let [rounds, updates] = self.propagate(&waiting);
            graded.rounds += rounds;
            graded.updates += updates;
            if updates == 0 {
                break;
            }
            // A last look at all edges that may have changed makes sure that the metric is graded, whatever the rounding.
            let mut is_open = self.changed.clone();
            waiting.iter().for_each(|&(p, _)| is_open[p as usize] = true);
            waiting = self.violators(|p, q| is_open[p as usize] || self.changed[q as usize]);
        }
        graded.changed = self.changed.iter().filter(|&&changed| changed).count();
        graded
    }

    /// The vertices whose metric, grown along an edge, is finer than that at the other end, with the least size that changes there. Only
    /// edges from p to q that are `is_open` are looked at: all others are known to be graded.
    fn violators(&self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Vec<(u32, f64)> {
        self.team.collect(FEW, self.logs.len(), |range, found| {
            for p in range.start as u32..range.end as u32 {
                let least = self.around.of_vertex(p).iter().filter(|&&q| is_open(p, q)).filter_map(|&q| {
                    let of_q = &self.frames[q as usize];
                    self.excess(p, of_q, q).map(|relative| of_q.least_excess(&relative))
                });
                found.extend(least.reduce(f64::min).map(|least| (p, least)));
            }
        })
    }

    /// The metric of p grown to q, relative to `of_q`, the metric of q; none when it is nowhere finer.
    #[inline]
    fn excess(&self, p: u32, of_q: &Frame, q: u32) -> Option<Relative> {
        let of_p = &self.frames[p as usize];
        // A metric that is nowhere finer changes nothing.
        if of_p.roots[2] <= of_q.roots[0] {
            return None;
        }
        let e = sub(self.vertices[q as usize], self.vertices[p as usize]);
        let grown = of_p.grown(e, self.growth);
        if grown[2] <= of_q.roots[0] {
            return None;
        }
        let relative = of_q.relative(of_p, grown);
        (!relative.is_below(1.0 + TOLERANCE)).then_some(relative)
    }

    /// Grows the metrics of these vertices to their neighbours, and on from there, until nothing changes. Returns the numbers of rounds and updates.
    fn propagate(&mut self, waiting: &[(u32, f64)]) -> [usize; 2] {
        let (mut near, mut far) = (Vec::new(), Vec::with_capacity(waiting.len()));
        for &(v, least_changed) in waiting {
            *self.places[v as usize].get_mut() = FAR;
            self.least_changed[v as usize] = least_changed;
            far.push(v);
        }
        let mut limit = 0.0;
        let [mut rounds, mut updates] = [0; 2];
        loop {
            if near.is_empty() {
                let Some(least) = self.least_waiting(&far) else { return [rounds, updates] };
                limit = least * CLASS;
                [near, far] = self.split(&far, limit);
            }
            let updated = self.round(&near);
            rounds += 1;
            updates += updated.len();
            let [more_near, more_far] = self.write_back(&updated, limit);
            near = more_near;
            far.extend(more_far);
        }
    }

    /// Splits the vertices that wait into near and far ones. A vertex that has been near meanwhile may be in the list twice, or be far no more.
    fn split(&self, waiting: &[u32], limit: f64) -> [Vec<u32>; 2] {
        let parts = self.team.chunks(GRAIN, waiting.len(), |range| {
            let (mut near, mut far) = (Vec::new(), Vec::new());
            for &v in &waiting[range] {
                let place = &self.places[v as usize];
                if self.least_changed[v as usize] > limit {
                    far.extend((place.load(Relaxed) == FAR).then_some(v));
                } else {
                    // Of two entries of a vertex only one finds it far.
                    near.extend(place.compare_exchange(FAR, NEAR, Relaxed, Relaxed).is_ok().then_some(v));
                }
            }
            [near, far]
        });
        self.joined(parts)
    }

    /// Lists of chunks one after the other, the first ones and the second ones.
    fn joined(&self, parts: Vec<[Vec<u32>; 2]>) -> [Vec<u32>; 2] {
        [0, 1].map(|which| self.team.join_slices(parts.iter().map(|lists| lists[which].as_slice())))
    }

    /// Writes these updates, which ascend by vertex. Returns the vertices that are now near, and those that are now far.
    fn write_back(&mut self, updated: &[Update], limit: f64) -> [Vec<u32>; 2] {
        // A task owns the vertices of a chunk, with all that is kept for them.
        let tasks = if updated.len() < 2 * FEW || self.team.threads() == 1 { 1 } else { 4 * self.team.threads() };
        let own = self.logs.len().div_ceil(tasks).max(1);
        let kept = self.logs.chunks_mut(own).zip(self.frames.chunks_mut(own));
        let kept = kept.zip(self.least_changed.chunks_mut(own)).zip(self.changed.chunks_mut(own));
        let kept = kept.zip(self.places.chunks_mut(own));
        let mut parts: Vec<_> = kept.map(|kept| (kept, [Vec::new(), Vec::new()])).collect();
        self.team.fill(1, &mut parts, |chunk, parts| {
            for (chunk, ((((logs, frames), least_changed), changed), places), [near, far]) in
                parts.iter_mut().zip(chunk..).map(|((kept, lists), chunk)| (chunk, kept, lists))
            {
                let place_of = |vertex: usize| updated.partition_point(|update| (update.vertex as usize) < vertex);
                for update in &updated[place_of(chunk * own)..place_of((chunk + 1) * own)] {
                    let at = update.vertex as usize - chunk * own;
                    (logs[at], frames[at], changed[at]) = (update.log, update.frame, true);
                    let place = places[at].get_mut();
                    least_changed[at] = if *place == NOWHERE {
                        update.least_changed
                    } else {
                        update.least_changed.min(least_changed[at])
                    };
                    let now = if least_changed[at] <= limit { NEAR } else { FAR };
                    if *place != now {
                        *place = now;
                        if now == NEAR { near.push(update.vertex) } else { far.push(update.vertex) }
                    }
                }
            }
        });
        let lists = parts.into_iter().map(|(_, lists)| lists).collect();
        self.joined(lists)
    }

    /// The least changed size of these vertices.
    fn least_waiting(&self, vertices: &[u32]) -> Option<f64> {
        let least_changed = |&v: &u32| self.least_changed[v as usize];
        let least = |range: Range<usize>| vertices[range].iter().map(least_changed).fold(f64::INFINITY, f64::min);
        self.team.chunks(GRAIN, vertices.len(), least).into_iter().reduce(f64::min)
    }

    /// The changed metrics of the neighbours of `sources`, in the order of the vertices.
    fn round(&self, sources: &[u32]) -> Vec<Update> {
        self.team.for_each(FEW, sources.len(), |range| {
            for &p in &sources[range] {
                self.places[p as usize].store(NOWHERE, Relaxed);
                self.is_source[p as usize].store(true, Relaxed);
                for &q in self.around.of_vertex(p) {
                    let (word, bit) = (&self.targets[q as usize / 64], 1 << (q % 64));
                    if word.load(Relaxed) & bit == 0 {
                        word.fetch_or(bit, Relaxed);
                    }
                }
            }
        });
        let targets = self.team.collect(WORDS, self.targets.len(), |range, targets| {
            for at in range {
                let mut word = self.targets[at].load(Relaxed);
                if word == 0 {
                    continue;
                }
                self.targets[at].store(0, Relaxed);
                while word != 0 {
                    targets.push(64 * at as u32 + word.trailing_zeros());
                    word &= word - 1;
                }
            }
        });
        let updated = self.team.collect(FEW, targets.len(), |range, updated| {
            updated.extend(targets[range].iter().filter_map(|&q| self.updated(q)));
        });
        self.team.for_each(GRAIN, sources.len(), |range| {
            sources[range].iter().for_each(|&p| self.is_source[p as usize].store(false, Relaxed));
        });
        updated
    }

    /// The intersection of the metric of q with those grown from the sources among its neighbours; none when that is no change.
    fn updated(&self, q: u32) -> Option<Update> {
        let before = self.frames[q as usize];
        let (mut now, mut least_changed) = (before, f64::INFINITY);
        for &p in self.around.of_vertex(q).iter().filter(|&&p| self.is_source[p as usize].load(Relaxed)) {
            let excess = self.excess(p, &now, q);
            if let Some((both, least)) = excess.and_then(|relative| now.intersection(&relative, 1.0 + TOLERANCE)) {
                (now, least_changed) = (both, least_changed.min(least));
            }
        }
        let log = (least_changed < f64::INFINITY).then(|| now.log())?;
        // An intersection raises ln det M. What does not is rounding, of sizes that differ too much for double precision.
        let rises = log.trace() - self.logs[q as usize].trace() > 0.5 * TOLERANCE;
        rises.then(|| Update { vertex: q, log, frame: Frame::of_log(&log), least_changed })
    }
}
