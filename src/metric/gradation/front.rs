//! The front: which vertices tell their neighbours of their metrics, and when.
//!
//! Only vertices that have changed are sources of a round, those with the least changed size first, since sizes only grow on their way (as
//! Δ-stepping does for shortest paths: Meyer & Sanders 2003). A round takes all changed vertices whose least changed sizes are within a
//! class. Each neighbour of a source intersects its metric with those grown from its sources, in the order of their numbers, from the
//! values of the round before. So the result is the same bit for bit on any number of threads, and wherever the metrics are ([`Metrics`]).
use super::{CLASS, FEW, Graded, Sym3, WORDS};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering::Relaxed};

/// A new metric of a vertex.
#[derive(Clone, Copy)]
pub(in crate::metric) struct Update {
    /// The vertex.
    pub vertex: u32,
    /// ln M.
    pub log: Sym3,
    /// The least size that has changed.
    pub least_changed: f64,
}

/// Metrics at vertices that are graded along their edges.
pub(in crate::metric) trait Metrics: Sync {
    /// Why they cannot be had.
    type Error;

    /// The vertices whose metric, grown along an edge, is finer than that at the other end, with the least size that changes there, ascending. Only
    /// edges from p to q that are `is_open` are looked at: all others are known to be graded.
    fn violators(&self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Result<Vec<(u32, f64)>, Self::Error>;

    /// Tells the neighbours of these vertices, some of them several times.
    fn each_neighbour(&self, sources: &[u32], tell: impl Fn(u32) + Sync) -> Result<(), Self::Error>;

    /// The new metrics of those of these vertices, ascending, that the sources among their neighbours change.
    fn updated(&self, targets: &[u32], is_source: impl Fn(u32) -> bool + Sync) -> Result<Vec<Update>, Self::Error>;

    /// Puts new metrics in, ascending by vertex.
    fn replace(&mut self, updates: &[Update]) -> Result<(), Self::Error>;
}

/// The list in which a vertex waits to be a source.
const NOWHERE: u8 = 0;
const NEAR: u8 = 1;
const FAR: u8 = 2;

/// Bytes that a vertex takes at most, in lists too: in its place, least size, bits, as one that violates, and in the lists of those that wait.
pub(in crate::metric) const OF_VERTEX: usize = 40;

/// Vertices that a task owns, of so many, when so many of them change.
pub(super) fn own(team: Team<'_>, changes: usize, vertices: usize) -> usize {
    let tasks = if changes < 2 * FEW || team.threads() == 1 { 1 } else { 4 * team.threads() };
    vertices.div_ceil(tasks).max(1)
}

/// The updates of a range of vertices, of all in ascending order.
pub(super) fn updates_of(updates: &[Update], vertices: Range<usize>) -> &[Update] {
    let place_of = |vertex: usize| updates.partition_point(|update| (update.vertex as usize) < vertex);
    &updates[place_of(vertices.start)..place_of(vertices.end)]
}

/// The state of a grading.
pub(in crate::metric) struct Front<'a, M> {
    team: Team<'a>,
    metrics: M,
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

impl<'a, M: Metrics> Front<'a, M> {
    /// Of metrics at so many vertices.
    pub fn new(team: Team<'a>, vertices: usize, metrics: M) -> Self {
        Self {
            team,
            metrics,
            places: team.map_with(GRAIN, vertices, || (), |(), _| AtomicU8::new(NOWHERE)),
            least_changed: vec![0.0; vertices],
            is_source: team.map_with(GRAIN, vertices, || (), |(), _| AtomicBool::new(false)),
            targets: (0..vertices.div_ceil(64)).map(|_| AtomicU64::new(0)).collect(),
            changed: vec![false; vertices],
        }
    }

    /// Grades all, where only edges from p to q that are `open` need to be looked at.
    ///
    /// # Errors
    /// When the metrics cannot be had.
    pub fn run(mut self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Result<Graded, M::Error> {
        let mut graded = Graded::default();
        let mut waiting = self.metrics.violators(is_open)?;
        loop {
            let [rounds, updates] = self.propagate(&waiting)?;
            graded.rounds += rounds;
            graded.updates += updates;
            if updates == 0 {
                break;
            }
            // A last look at all edges that may have changed makes sure that the metric is graded, whatever the rounding.
            let mut is_open = self.changed.clone();
            waiting.iter().for_each(|&(p, _)| is_open[p as usize] = true);
            let changed = &self.changed;
            waiting = self.metrics.violators(|p, q| is_open[p as usize] || changed[q as usize])?;
        }
        graded.changed = self.changed.iter().filter(|&&changed| changed).count();
        Ok(graded)
    }

    /// Grows the metrics of these vertices to their neighbours, and on from there, until nothing changes. Returns the numbers of rounds and updates.
    fn propagate(&mut self, waiting: &[(u32, f64)]) -> Result<[usize; 2], M::Error> {
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
                let Some(least) = self.least_waiting(&far) else { return Ok([rounds, updates]) };
                limit = least * CLASS;
                [near, far] = self.split(&far, limit);
            }
            let updated = self.round(&near)?;
            rounds += 1;
            updates += updated.len();
            self.metrics.replace(&updated)?;
            let [more_near, more_far] = self.queue(&updated, limit);
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

    /// Lets vertices wait that have these updates, which ascend by vertex. Returns those that are now near, and those that are now far.
    fn queue(&mut self, updated: &[Update], limit: f64) -> [Vec<u32>; 2] {
        // A task owns the vertices of a chunk, with all that is kept for them.
        let own = own(self.team, updated.len(), self.changed.len());
        let kept = self.least_changed.chunks_mut(own).zip(self.changed.chunks_mut(own));
        let kept = kept.zip(self.places.chunks_mut(own));
        let mut parts: Vec<_> = kept.map(|kept| (kept, [Vec::new(), Vec::new()])).collect();
        self.team.fill(1, &mut parts, |chunk, parts| {
            for (chunk, ((least_changed, changed), places), [near, far]) in
                parts.iter_mut().zip(chunk..).map(|((kept, lists), chunk)| (chunk, kept, lists))
            {
                for update in updates_of(updated, chunk * own..(chunk + 1) * own) {
                    let at = update.vertex as usize - chunk * own;
                    changed[at] = true;
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
    fn round(&self, sources: &[u32]) -> Result<Vec<Update>, M::Error> {
        let (targets, is_source) = (&self.targets, &self.is_source);
        self.team.for_each(GRAIN, sources.len(), |range| {
            for &p in &sources[range] {
                self.places[p as usize].store(NOWHERE, Relaxed);
                is_source[p as usize].store(true, Relaxed);
            }
        });
        self.metrics.each_neighbour(sources, |q| {
            let (word, bit) = (&targets[q as usize / 64], 1 << (q % 64));
            if word.load(Relaxed) & bit == 0 {
                word.fetch_or(bit, Relaxed);
            }
        })?;
        let found = self.team.collect(WORDS, targets.len(), |range, found| {
            for at in range {
                let mut word = targets[at].load(Relaxed);
                if word == 0 {
                    continue;
                }
                targets[at].store(0, Relaxed);
                while word != 0 {
                    found.push(64 * at as u32 + word.trailing_zeros());
                    word &= word - 1;
                }
            }
        });
        let updated = self.metrics.updated(&found, |p| is_source[p as usize].load(Relaxed))?;
        self.team.for_each(GRAIN, sources.len(), |range| {
            sources[range].iter().for_each(|&p| is_source[p as usize].store(false, Relaxed));
        });
        Ok(updated)
    }
}
