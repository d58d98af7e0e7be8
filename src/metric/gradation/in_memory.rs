//! Metrics that are in memory, to be graded.
use super::edges::Known;
use super::front::{Metrics, Update};
use super::{FEW, Sym3};
use crate::mesh::vector::Vec3;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::frame::Frame;
use crate::tasks::{GRAIN, Team};
use std::convert::Infallible;

/// ln M at the vertices of a mesh.
pub struct InMemory<'a> {
    team: Team<'a>,
    points: &'a [Vec3],
    around: &'a VertexNeighbours,
    logs: &'a mut [Sym3],
    /// Those of `logs`.
    frames: Vec<Frame>,
    growth: f64,
}

impl<'a> InMemory<'a> {
    /// To be graded by e^`growth`.
    pub fn new(
        team: Team<'a>,
        points: &'a [Vec3],
        around: &'a VertexNeighbours,
        logs: &'a mut [Sym3],
        growth: f64,
    ) -> Self {
        let frames = team.map(GRAIN, logs.len(), |v| Frame::of_log(&logs[v]));
        Self { team, points, around, logs, frames, growth }
    }

    fn known(&self) -> Known<'_> {
        Known { points: self.points, frames: &self.frames, growth: self.growth }
    }
}

impl Metrics for InMemory<'_> {
    type Error = Infallible;

    fn violators(&self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Result<Vec<(u32, f64)>, Infallible> {
        let (known, around) = (self.known(), self.around);
        Ok(self.team.collect(FEW, self.logs.len(), |range, found| {
            for p in range.start as u32..range.end as u32 {
                let ends = around.of_vertex(p).iter().copied().filter(|&q| is_open(p, q));
                found.extend(known.least_excess(p, ends).map(|least| (p, least)));
            }
        }))
    }

    fn each_neighbour(&self, sources: &[u32], tell: impl Fn(u32) + Sync) -> Result<(), Infallible> {
        self.team.for_each(FEW, sources.len(), |range| {
            sources[range].iter().for_each(|&p| self.around.of_vertex(p).iter().for_each(|&q| tell(q)));
        });
        Ok(())
    }

    fn updated(&self, targets: &[u32], is_source: impl Fn(u32) -> bool + Sync) -> Result<Vec<Update>, Infallible> {
        let (known, around, logs) = (self.known(), self.around, &*self.logs);
        Ok(self.team.collect(FEW, targets.len(), |range, updated| {
            updated.extend(targets[range].iter().filter_map(|&q| {
                let sources = around.of_vertex(q).iter().copied().filter(|&p| is_source(p));
                let (log, least_changed) = known.updated(q, &logs[q as usize], sources)?;
                Some(Update { vertex: q, log, least_changed })
            }));
        }))
    }

    fn replace(&mut self, updates: &[Update]) -> Result<(), Infallible> {
        let own = super::front::own(self.team, updates.len(), self.logs.len());
        let mut parts: Vec<_> = self.logs.chunks_mut(own).zip(self.frames.chunks_mut(own)).collect();
        self.team.fill(1, &mut parts, |chunk, parts| {
            for ((logs, frames), chunk) in parts.iter_mut().zip(chunk..) {
                for update in super::front::updates_of(updates, chunk * own..(chunk + 1) * own) {
                    let at = update.vertex as usize - chunk * own;
                    (logs[at], frames[at]) = (update.log, Frame::of_log(&update.log));
                }
            }
        });
        Ok(())
    }
}
