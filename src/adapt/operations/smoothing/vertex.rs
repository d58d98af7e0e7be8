//! Smoothing: a vertex moves, within its entity of the model, to where its tetrahedra and edges are better.
//!
//! The energy of [`super::patch`] is convex about a vertex as long as the metric is held, so one Newton step comes near its minimum, and
//! how much the step would save is known before anything is tried. A step is taken only if the energy falls with the metric
//! of the new place, no tetrahedron is inverted (exact), and the surface does not deviate more from its model. Where the worst tetrahedron is very
//! bad ([`BAD`]) it must not become worse.
use super::patch::SmoothingPatch;
use super::worst::BAD;
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::refusal::{Refusal, first_done};
use crate::adapt::core::vertex_moves::{Placed, VertexState};
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::{Entity, Evaluate};
use crate::mesh::vector::{Vec3, add, dot, lerp, scale, unit};
use crate::metric::energy::QuadraticModel;
use crate::metric::plane_basis;

/// A step must promise to save this share of the energy, and must really save half of it.
const GAIN: f64 = 0.001;

/// Longest step in the metric.
const LONGEST: f64 = 0.5;

/// Parts of the pliant direction that are tried.
const STEPS: [f64; 2] = [0.8, 0.3];

/// Smooths vertices.
pub struct Smooth;

impl Operation for Smooth {
    type Item = VertexId;
    type Scratch = SmoothingPatch;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut SmoothingPatch,
        item: VertexId,
    ) -> Result<(), Refusal> {
        worker.smooth(scratch, item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Smooths one vertex whose worst tetrahedron is below the limit.
    pub fn smooth(&mut self, patch: &mut SmoothingPatch, v: VertexId) -> Result<(), Refusal> {
        self.with_patch(patch, v, |worker, patch, ball| worker.descend(patch, v, ball))
    }

    /// Lays out the ball of a vertex that may be moved, if its worst tetrahedron is below the limit, lists its surface triangles, and calls
    /// `shift`.
    ///
    /// # Errors
    /// `Geometry` when the vertex must not move, `Stale` when its tetrahedra are good or it is gone, else those of `shift`.
    pub fn with_patch(
        &mut self,
        patch: &mut SmoothingPatch,
        v: VertexId,
        shift: impl FnOnce(&mut Self, &mut SmoothingPatch, &Ball) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        self.claim_live(v)?;
        if matches!(self.store.entity(v), Entity::Vertex(_)) || self.context.is_frozen(v) {
            return Err(Refusal::Geometry);
        }
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| {
            patch.worst = self.worst_of(&ball.tets);
            if patch.worst >= self.context.limits.improve_below {
                return Err(Refusal::Stale);
            }
            patch.triangles.clear();
            self.list_surface(v, &ball.tets, &mut patch.triangles);
            patch.fill(self.store, v, &ball.tets, &ball.link);
            shift(self, patch, &ball)
        });
        self.state.ball = ball;
        result
    }

    /// Tries Newton's step, whole and shortened; where a tetrahedron is flat, steps towards the pliant point instead.
    fn descend(&mut self, patch: &mut SmoothingPatch, v: VertexId, ball: &Ball) -> Result<(), Refusal> {
        let held = self.vertex_state(v);
        let from = held.placed.point;
        let Some(model) = patch.model(from, &held.metric) else {
            let limit = patch.energy(from, &held.log, &held.metric) * (1.0 - GAIN);
            let to = patch.pliant(from, &held.metric);
            let targets = STEPS.map(|step| lerp(from, to, step));
            return self.move_to_one(v, &held, targets, ball, patch, limit);
        };
        let step = self.newton_step(&held.placed, &model);
        let limit = model.energy * (1.0 - 0.5 * GAIN);
        // If the whole step would save too little, nothing is tried. It is NaN where the surface has no normal, as at a pole: there the
        // vertex stays.
        let saved = -0.5 * dot(model.gradient, step);
        if saved.is_nan() || saved < GAIN * model.energy {
            return Err(Refusal::Shape);
        }
        let length = held.metric.quadratic(step).sqrt();
        let step = scale(step, (LONGEST / length).min(1.0));
        let targets = [1.0, 0.4].map(|part| add(from, scale(step, part)));
        self.move_to_one(v, &held, targets, ball, patch, limit)
    }

    /// Moves the vertex to the first of the targets that is possible.
    fn move_to_one(
        &mut self,
        v: VertexId,
        held: &VertexState,
        targets: [Vec3; 2],
        ball: &Ball,
        patch: &mut SmoothingPatch,
        limit: f64,
    ) -> Result<(), Refusal> {
        first_done(targets.into_iter().map(|target| self.move_to(v, held, target, ball, patch, limit)))
    }

    /// −H⁻¹g within the tangent space of the entity.
    fn newton_step(&mut self, placed: &Placed, model: &QuadraticModel) -> Vec3 {
        let (g, h) = (model.gradient, &model.hessian);
        match placed.entity {
            Entity::Vertex(_) => [0.0; 3],
            Entity::Edge(curve) => {
                let t = unit(self.state.evaluator.edge_frame(curve, placed.parameters[0]).d1);
                scale(t, -dot(g, t) / h.quadratic(t))
            }
            Entity::Face(face) => {
                let normal = match self.context.planes[face as usize] {
                    Some(normal) => normal,
                    None => self.state.evaluator.face_normal(face, placed.parameters),
                };
                let (x, y) = plane_basis(normal);
                let (a, b, c) = (h.quadratic(x), dot(x, h.apply(y)), h.quadratic(y));
                let (gx, gy) = (dot(g, x), dot(g, y));
                let det = a * c - b * b;
                add(scale(x, (b * gy - c * gx) / det), scale(y, (b * gx - a * gy) / det))
            }
            Entity::Interior => scale(h.solve(g), -1.0),
        }
    }

    /// Moves the vertex to the closest point of its entity, if the energy is below `limit` there and the surface deviates no more than before. The
    /// worst tetrahedron, where it is very bad, must not become worse.
    fn move_to(
        &mut self,
        v: VertexId,
        held: &VertexState,
        target: Vec3,
        ball: &Ball,
        patch: &mut SmoothingPatch,
        limit: f64,
    ) -> Result<(), Refusal> {
        let placed = self.place(held.placed.entity, target, &[v]);
        let mut hint = held.hint;
        let log = self.context.log_at(placed.point, &mut hint);
        if !patch.falls_below(limit, placed.point, &log) {
            return Err(Refusal::Shape);
        }
        let metric = log.exp();
        // Without this, smoothing takes back what repair has moved.
        let loses = patch.worst < BAD && patch.mean_ratios().any(|ratio| ratio < patch.worst);
        if loses || patch.with_lengths(placed.point, &metric) >= limit {
            return Err(Refusal::Shape);
        }
        self.move_fairly(v, &VertexState { placed, log, metric, hint }, ball, patch)
    }

    /// Moves the vertex to the place that was tried last, if the surface deviates no more than before.
    ///
    /// # Errors
    /// `Shape` where the surface holds it back: that is how it is counted. Else those of a move in its ball.
    pub fn move_fairly(
        &mut self,
        v: VertexId,
        to: &VertexState,
        ball: &Ball,
        patch: &SmoothingPatch,
    ) -> Result<(), Refusal> {
        let triangles = &patch.triangles;
        let mut moved = Err(Refusal::Normal);
        // Mostly the triangles are within the limits there, whatever they are now.
        if let Some(side) = if triangles.is_empty() { Some(1.0) } else { self.clear_side(triangles) } {
            moved = self.move_in_ball(v, to, &ball.tets, patch.mean_ratios(), |worker| {
                worker.are_within_limits(side, triangles)
            });
        }
        if moved == Err(Refusal::Normal) {
            let before = self.worst_deviation(triangles);
            moved = self.move_in_ball(v, to, &ball.tets, patch.mean_ratios(), |worker| {
                worker.compare_with(before, triangles, 0.0).is_ok()
            });
        }
        moved.map_err(|refusal| if refusal == Refusal::Normal { Refusal::Shape } else { refusal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Speculative;
    use crate::adapt::core::store::Store;
    use crate::adapt::tests::bench::{Bench, Shape, sample};

    fn worst_at(store: &Store, v: VertexId) -> f64 {
        store.live_tets().filter(|&t| store.vertices(t).contains(&v)).map(|t| store.quality(t)).fold(1.0, f64::min)
    }

    fn smooth(bench: &mut Bench<'_>, v: VertexId) -> Result<(), Refusal> {
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Speculative::new(0));
        let moved = worker.smooth(&mut SmoothingPatch::default(), v);
        worker.access.release(worker.store);
        moved
    }

    #[test]
    fn smoothing_makes_no_very_bad_tetrahedron_worse() {
        let mut moved_at_bad = 0;
        for shape in [Shape::Cube, Shape::TwoRegions, Shape::Round] {
            let sample = sample(shape, 3, 0.8);
            let mut bench = Bench::new(&sample, 1, 1);
            for v in (0..bench.context.store.vertex_bound() as u32).map(VertexId) {
                let before = worst_at(&bench.context.store, v);
                if smooth(&mut bench, v).is_ok() && before < BAD {
                    let after = worst_at(&bench.context.store, v);
                    assert!(after >= before, "{shape:?}, vertex {v:?}: {before} → {after}");
                    moved_at_bad += 1;
                }
            }
            bench.check(&format!("{shape:?}, smoothing"));
        }
        assert!(moved_at_bad > 10, "{moved_at_bad} vertices of very bad tetrahedra moved");
    }
}
