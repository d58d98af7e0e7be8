//! Gradation: no metric asks for sizes that its neighbours' have not grown to yet. Mixed-space homogeneous (Alauzet 2010, §6.2.1).
//!
//! For an edge pq with vector e the metric of p grows to q: G has the eigenvectors of M_p and the eigenvalues
//! λ_i · [(1 + √λ_i |e| ln r)^t (1 + L_p(e) ln r)^(1−t)]^(−2), t = 1/8; M_q ← M_q ∩ G, both ways, until nothing changes.
//!
//! A front does it: only edges of vertices that have changed are looked at, those of the smallest sizes first, since it is they that
//! tell others (as Δ-stepping does for shortest paths: Meyer & Sanders 2003). A round takes all that wait within a class of
//! sizes; each neighbour takes the intersection over those of them that it has an edge with, in the order of their numbers, from
//! the values of the round before. So all is the same bit for bit on any number of threads.
mod growth;
mod measure;
#[cfg(test)]
mod tests;

use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::{GRAIN, Team};
use growth::{Frame, is_below};
pub use measure::{Growths, measure};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// An intersection that raises no eigenvalue by more than this share is no change.
const TOLERANCE: f64 = 1e-6;

/// Sizes within this factor of the least that waits are one class.
const CLASS: f64 = 1.25;

/// Vertices a task: one takes a microsecond or two.
const FEW: usize = 1 << 8;

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
/// tetrahedra, or of the triangles where there is no tetrahedron. Vertices without an edge stay as they are, and so does, bit for
/// bit, every metric that is within bounds; what has been graded is.
///
/// # Panics
/// When there are not as many metrics as vertices.
pub fn grade(team: Team<'_>, mesh: &TetMesh, logs: &mut [Sym3], ratio: f64) -> Graded {
    assert_eq!(mesh.vertices.len(), logs.len(), "one ln M a vertex");
    let around = VertexNeighbours::of_mesh(team, mesh);
    Grading::new(team, &mesh.vertices, &around, logs, ratio.ln()).run()
}

/// Where a vertex waits to tell its neighbours.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Nowhere,
    Near,
    Far,
}

struct Grading<'a> {
    team: Team<'a>,
    vertices: &'a [Vec3],
    around: &'a VertexNeighbours,
    logs: &'a mut [Sym3],
    /// Of `logs`, always as [`Frame::of_log`] has it: so a second grading sees what this one saw.
    frames: Vec<Frame>,
    /// ln r.
    pace: f64,
    places: Vec<Place>,
    /// Who tells its neighbours in this round.
    telling: Vec<bool>,
    /// Who is told.
    told: Vec<AtomicBool>,
    changed: Vec<bool>,
}

impl<'a> Grading<'a> {
    fn new(
        team: Team<'a>,
        vertices: &'a [Vec3],
        around: &'a VertexNeighbours,
        logs: &'a mut [Sym3],
        pace: f64,
    ) -> Self {
        let count = logs.len();
        Self {
            team,
            vertices,
            around,
            frames: team.map(GRAIN, count, |v| Frame::of_log(&logs[v])),
            logs,
            pace,
            places: vec![Place::Nowhere; count],
            telling: vec![false; count],
            told: (0..count).map(|_| AtomicBool::new(false)).collect(),
            changed: vec![false; count],
        }
    }

    fn run(mut self) -> Graded {
        let mut graded = Graded::default();
        loop {
            // Looking at all again at the end makes sure of it, whatever the rounding.
            let waiting = self.violators();
            let [rounds, updates] = self.settle(waiting);
            graded.rounds += rounds;
            graded.updates += updates;
            if updates == 0 {
                break;
            }
        }
        graded.changed = self.changed.iter().filter(|&&changed| changed).count();
        graded
    }

    /// The vertices whose metrics, grown along an edge, are not within the one at its other end.
    fn violators(&self) -> Vec<u32> {
        self.team.collect(FEW, self.logs.len(), |range, found| {
            let violates = |&p: &u32| {
                self.around.of_vertex(p).iter().any(|&q| self.excess(p, &self.frames[q as usize], q).is_some())
            };
            found.extend((range.start as u32..range.end as u32).filter(violates));
        })
    }

    /// The metric of p grown to q, relative to that of q, `of_q`; none when it is within that.
    #[inline]
    fn excess(&self, p: u32, of_q: &Frame, q: u32) -> Option<Sym3> {
        let of_p = &self.frames[p as usize];
        // What is nowhere finer cannot ask for anything.
        if of_p.roots[2] <= of_q.roots[0] {
            return None;
        }
        let e = sub(self.vertices[q as usize], self.vertices[p as usize]);
        let grown = of_p.grown(e, self.pace);
        if grown[2] <= of_q.roots[0] {
            return None;
        }
        let relative = of_q.relative(of_p, grown);
        (!is_below(&relative, 1.0 + TOLERANCE)).then_some(relative)
    }

    /// Lets these tell their neighbours, and these theirs, until nothing changes; returns the rounds and the updates.
    fn settle(&mut self, waiting: Vec<u32>) -> [usize; 2] {
        let (mut near, mut far) = (Vec::new(), waiting);
        far.iter().for_each(|&v| self.places[v as usize] = Place::Far);
        let mut least_root = f64::INFINITY;
        let [mut rounds, mut updates] = [0; 2];
        loop {
            if near.is_empty() {
                far.retain(|&v| self.places[v as usize] == Place::Far);
                let Some(finest) = self.finest(&far) else { return [rounds, updates] };
                least_root = finest / CLASS;
                let is_near = |&v: &u32| self.frames[v as usize].roots[2] >= least_root;
                near.extend(far.iter().copied().filter(is_near));
                // Once each: a vertex that was near meanwhile may be in the list twice.
                near.retain(|&v| std::mem::replace(&mut self.places[v as usize], Place::Near) == Place::Far);
                far.retain(|v| !is_near(v));
            }
            let updated = self.round(&near);
            near.clear();
            rounds += 1;
            updates += updated.len();
            for (v, log, frame) in updated {
                let at = v as usize;
                (self.logs[at], self.frames[at], self.changed[at]) = (log, frame, true);
                let place = if frame.roots[2] >= least_root { Place::Near } else { Place::Far };
                if self.places[at] != place {
                    self.places[at] = place;
                    if place == Place::Near { near.push(v) } else { far.push(v) }
                }
            }
        }
    }

    /// Greatest 1/h of these vertices.
    fn finest(&self, vertices: &[u32]) -> Option<f64> {
        let roots = |&v: &u32| self.frames[v as usize].roots[2];
        let parts =
            self.team.chunks(GRAIN, vertices.len(), |range| vertices[range].iter().map(roots).fold(0.0, f64::max));
        parts.into_iter().reduce(f64::max)
    }

    /// The new metrics of the neighbours of `tellers`, where they change, in the order of the vertices.
    fn round(&mut self, tellers: &[u32]) -> Vec<(u32, Sym3, Frame)> {
        for &p in tellers {
            self.places[p as usize] = Place::Nowhere;
            self.telling[p as usize] = true;
        }
        let this = &*self;
        let mut told = this.team.collect(FEW, tellers.len(), |range, told| {
            let neighbours = tellers[range].iter().flat_map(|&p| this.around.of_vertex(p));
            told.extend(neighbours.filter(|&&q| !this.told[q as usize].swap(true, Relaxed)));
        });
        this.team.sort(&mut told);
        let updated = this.team.collect(FEW, told.len(), |range, updated| {
            updated.extend(told[range].iter().filter_map(|&q| this.updated(q)));
        });
        told.iter().for_each(|&q| *self.told[q as usize].get_mut() = false);
        tellers.iter().for_each(|&p| self.telling[p as usize] = false);
        updated
    }

    /// The intersection of the metric of q with what has grown from its neighbours that tell; none when that is no change.
    fn updated(&self, q: u32) -> Option<(u32, Sym3, Frame)> {
        let before = self.frames[q as usize];
        let (mut now, mut changes) = (before, false);
        for &p in self.around.of_vertex(q).iter().filter(|&&p| self.telling[p as usize]) {
            let excess = self.excess(p, &now, q);
            if let Some(both) = excess.and_then(|relative| now.intersection(&relative, 1.0 + TOLERANCE)) {
                (now, changes) = (both, true);
            }
        }
        let log = changes.then(|| now.log())?;
        // An intersection raises ln det M; what does not is rounding, of sizes too different for their figures.
        let rises = log.trace() - self.logs[q as usize].trace() > 0.5 * TOLERANCE;
        rises.then(|| (q, log, Frame::of_log(&log)))
    }
}
