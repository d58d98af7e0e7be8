//! Thinning, where vertices are far too many: each vertex with a short edge goes onto a neighbour, no two near each other in one sweep.
//!
//! It comes before the passes, and is cheaper than collapse: it gathers one ball a vertex and changes records where they are. Since a
//! neighbourhood changes only once in a sweep, the mesh gets coarser everywhere alike, and no vertex gets very many neighbours.
use super::onto_end::CollapseScratch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::ids::{FACE, VertexId};
use crate::adapt::core::measure::is_shorter;
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::vertex_replacement::{BallSplit, Kept};
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::vector::sub;
use crate::metric::lanes::LANES;

/// A vertex tries to go onto so many neighbours, the nearest first.
const TARGETS: usize = 4;

/// What thinning needs at hand. Allocated once.
#[derive(Default)]
pub struct ThinningScratch {
    collapse: CollapseScratch,
    split: BallSplit,
}

/// Removes vertices with short edges.
pub struct Thin;

impl Operation for Thin {
    type Item = VertexId;
    type Scratch = ThinningScratch;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut ThinningScratch,
        item: VertexId,
    ) -> Result<(), Refusal> {
        worker.thin(scratch, item)
    }
}

/// The nearest neighbours so far, with the fourth powers of their distances.
struct Nearest {
    found: [(f64, VertexId); TARGETS],
    count: usize,
}

impl Nearest {
    fn add(&mut self, fourth_power: f64, v: VertexId) {
        let mut at = self.count.min(TARGETS - 1);
        if self.count == TARGETS && self.found[at].0 <= fourth_power {
            return;
        }
        while at > 0 && self.found[at - 1].0 > fourth_power {
            self.found[at] = self.found[at - 1];
            at -= 1;
        }
        self.found[at] = (fourth_power, v);
        self.count = (self.count + 1).min(TARGETS);
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a vertex that has a short edge, if nothing near it has changed in this sweep.
    pub fn thin(&mut self, scratch: &mut ThinningScratch, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        if self.store.stamp(self.store.tet_of(v)) == self.store.clock() {
            return Err(Refusal::Stale);
        }
        if self.context.is_frozen(v) || self.store.dimension(v) == 0 {
            return Err(Refusal::Geometry);
        }
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.thin_ball(scratch, v, &ball));
        self.state.ball = ball;
        result
    }

    fn thin_ball(&mut self, scratch: &mut ThinningScratch, v: VertexId, ball: &Ball) -> Result<(), Refusal> {
        let nearest = self.nearest(v, &ball.link);
        let mut result = Err(Refusal::Stale);
        for &(_, w) in &nearest.found[..nearest.count] {
            result = match self.store.entity(v) {
                Entity::Interior => self.thin_onto(&mut scratch.split, v, w, ball),
                _ => self.try_collapse(&mut scratch.collapse, v, w, ball, 0.0).and_then(|_| self.finish_collapse(v, w)),
            };
            if matches!(result, Ok(()) | Err(Refusal::Conflict)) {
                break;
            }
        }
        result
    }

    /// The other ends of the shortest edges at v, of those that are too short; for a boundary vertex only ends on the boundary.
    fn nearest(&self, v: VertexId, link: &[VertexId]) -> Nearest {
        let (p, metric, dimension) = (self.store.position(v), self.store.metric(v), self.store.dimension(v));
        let limit = self.context.limits.short;
        let mut nearest = Nearest { found: [(0.0, VertexId::NONE); TARGETS], count: 0 };
        for &x in link {
            let e = sub(self.store.position(x), p);
            let at_v = metric.quadratic(e);
            // The lengths in the metrics of both ends seldom differ by a factor of two: such an edge is not short.
            if at_v > 4.0 * limit * limit || (dimension < 3 && self.store.dimension(x) > dimension) {
                continue;
            }
            let at_x = self.store.metric(x).quadratic(e);
            if is_shorter(at_v, at_x, limit) {
                nearest.add(at_v * at_x, x);
            }
        }
        nearest
    }

    /// Replaces an inner vertex by a neighbour. Where all tetrahedra that stay are positive the mesh stays valid, since they fill the ball
    /// once.
    fn thin_onto(&mut self, split: &mut BallSplit, v: VertexId, w: VertexId, ball: &Ball) -> Result<(), Refusal> {
        self.check_new_lengths(v, w, &ball.link)?;
        self.split_ball(v, w, ball, split)?;
        self.replace_vertex(v, w, &ball.tets, split)
    }

    /// Splits the ball of v into the tetrahedra at the edge v–w, which go, and those that stay with w in place of v.
    fn split_ball(&mut self, v: VertexId, w: VertexId, ball: &Ball, split: &mut BallSplit) -> Result<(), Refusal> {
        split.kept.clear();
        split.gone.clear();
        for &tet in &ball.tets {
            let vertices = self.store.vertices(tet);
            let place = |x: VertexId| vertices.iter().position(|&y| y == x);
            match (place(v), place(w)) {
                (Some(of_v), Some(of_w)) => split.gone.push((tet, [of_v, of_w])),
                (Some(local), None) => split.kept.push(Kept { tet, local, quality: 0.0 }),
                (None, _) => return Err(Refusal::Topology),
            }
        }
        let floor = self.context.limits.collapse_floor.min(self.worst_of(&ball.tets));
        let (point, log) = (self.store.position(w), self.store.log(w));
        let (store, batch) = (self.store, &mut self.state.batch);
        for some in split.kept.chunks_mut(LANES) {
            for lane in 0..LANES {
                let Kept { tet, local, .. } = some[lane.min(some.len() - 1)];
                let vertices = store.vertices(tet);
                let face = FACE[local].map(|k| vertices[k]);
                batch.set_with_sum(lane, face.map(|x| store.position(x)), &store.log_sum(face));
            }
            batch.prepare();
            let qualities = batch.shapes(point, &log).mean_ratios();
            for (kept, quality) in some.iter_mut().zip(qualities) {
                if quality <= 0.0 {
                    return Err(Refusal::Inverted);
                }
                if quality < floor {
                    return Err(Refusal::Shape);
                }
                kept.quality = quality;
            }
        }
        Ok(())
    }
}
