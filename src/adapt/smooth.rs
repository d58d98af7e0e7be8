//! Smoothing: a vertex moves, within its entity of the model, to where its tetrahedra and edges are better.
//!
//! The energy of [`super::fan`] is convex about a vertex as long as the metric is held, so Newton's step finds its minimum at
//! once; how much a step can save is known before anything is tried. A step counts only if the energy falls
//! with the metric of the new place, no tetrahedron is inverted (exact), and the surface does not turn from its model.
use super::access::Access;
use super::ball::Ball;
use super::fan::Fan;
use super::ids::VertexId;
use super::outcome::Refusal;
use super::surface::Placed;
use super::worker::Worker;
use crate::geometry::{Entity, Evaluate};
use crate::mesh::vector::{Vec3, add, dot, lerp, scale, sub, unit};
use crate::metric::Sym3;
use crate::metric::batch::Bowl;
use crate::metric::plane_basis;

/// Where a vertex is, to be put back.
#[derive(Clone, Copy)]
pub struct Held {
    /// Point and entity.
    pub placed: Placed,
    log: Sym3,
    metric: Sym3,
    /// Background tetrahedron.
    pub hint: u32,
}

/// Part of the energy that a step must promise to save, and of which it must keep half.
const GAIN: f64 = 0.001;

/// A move that is longer in the metric may change what flips and collapses gain.
const FAR: f64 = 0.05;

/// Longest step in the metric.
const LONGEST: f64 = 0.5;

/// Parts of the pliant direction that are tried.
const STEPS: [f64; 2] = [0.8, 0.3];

impl<A: Access> Worker<'_, '_, A> {
    /// Smooths one vertex whose worst tetrahedron is below the limit.
    pub fn smooth(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        let entity = self.store.entity(v);
        if matches!(entity, Entity::Vertex(_)) {
            return Err(Refusal::Geometry);
        }
        self.context.required.check_move(v)?;
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.smooth_in(v, &ball));
        self.state.ball = ball;
        result
    }

    fn smooth_in(&mut self, v: VertexId, ball: &Ball) -> Result<(), Refusal> {
        if self.worst_of(&ball.tets) >= self.context.limits.improve_below {
            return Err(Refusal::Stale);
        }
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, &ball.tets, &mut triangles);
        let moved = self.descend(v, ball, &triangles);
        self.state.star.surface = triangles;
        if moved { Ok(()) } else { Err(Refusal::Shape) }
    }

    /// Lays the ball out and steps down its energy; whether the vertex moved.
    fn descend(&mut self, v: VertexId, ball: &Ball, triangles: &[([VertexId; 3], u32)]) -> bool {
        let mut fan = std::mem::take(&mut self.state.fan);
        fan.fill(self.store, v, &ball.tets, &ball.link);
        let moved = self.descend_in(v, ball, triangles, &mut fan);
        self.state.fan = fan;
        moved
    }

    /// Newton's step, whole and shortened; where a tetrahedron is flat, the pliant direction instead.
    fn descend_in(&mut self, v: VertexId, ball: &Ball, triangles: &[([VertexId; 3], u32)], fan: &mut Fan) -> bool {
        let held = self.hold(v);
        let from = held.placed.point;
        let Some(bowl) = fan.bowl(from, &held.log, &held.metric) else {
            let limit = fan.energy(from, &held.log, &held.metric) * (1.0 - GAIN);
            let to = fan.pliant(from, &held.metric);
            return STEPS
                .into_iter()
                .any(|step| self.move_to(v, &held, lerp(from, to, step), ball, triangles, fan, limit));
        };
        let step = self.newton_step(&held.placed, &bowl);
        let limit = bowl.energy * (1.0 - 0.5 * GAIN);
        // What the whole step would save is known; if that is too little, nothing is tried.
        // No number comes where the surface has no normal, as at a pole: the vertex stays.
        let saved = -0.5 * dot(bowl.gradient, step);
        if saved.is_nan() || saved < GAIN * bowl.energy {
            return false;
        }
        let length = held.metric.quadratic(step).sqrt();
        let step = scale(step, (LONGEST / length).min(1.0));
        [1.0, 0.4]
            .into_iter()
            .any(|part| self.move_to(v, &held, add(from, scale(step, part)), ball, triangles, fan, limit))
    }

    /// −H⁻¹g within the tangent space of the entity.
    fn newton_step(&mut self, placed: &Placed, bowl: &Bowl) -> Vec3 {
        let (g, h) = (bowl.gradient, &bowl.hessian);
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

    /// [`Worker::try_move`], noted in the tetrahedra.
    #[allow(clippy::too_many_arguments)]
    fn move_to(
        &mut self,
        v: VertexId,
        held: &Held,
        target: Vec3,
        ball: &Ball,
        triangles: &[([VertexId; 3], u32)],
        fan: &mut Fan,
        limit: f64,
    ) -> bool {
        if !self.try_move(v, held, target, triangles, fan, limit) {
            return false;
        }
        let way = sub(self.store.position(v), held.placed.point);
        let far = held.metric.quadratic(way) > FAR * FAR;
        for (&t, shape) in ball.tets.iter().zip(fan.mean_ratios()) {
            self.store.set_quality(t, shape);
            // After a small move only smoothing looks here again.
            if far { self.store.touch(t) } else { self.store.touch_moved(t) }
        }
        true
    }

    /// Moves the vertex to the closest point of its entity when the energy falls below `limit` there and the surface stays.
    fn try_move(
        &mut self,
        v: VertexId,
        held: &Held,
        target: Vec3,
        triangles: &[([VertexId; 3], u32)],
        fan: &mut Fan,
        limit: f64,
    ) -> bool {
        let placed = self.place(held.placed.entity, target, &[v]);
        let mut hint = held.hint;
        let log = self.context.source.log_at(placed.point, &mut hint);
        if !fan.falls_below(limit, placed.point, &log) {
            return false;
        }
        let metric = log.exp();
        if fan.with_lengths(placed.point, &metric) >= limit {
            return false;
        }
        let facing = (!triangles.is_empty()).then(|| self.facing(triangles));
        self.put_back(v, &Held { placed, log, metric, hint });
        let stays = facing.is_none_or(|facing| self.compare_normals(facing, triangles, 0.0).is_ok());
        if !stays {
            self.put_back(v, held);
        }
        stays
    }

    /// Remembers where a claimed vertex is.
    pub fn hold(&self, v: VertexId) -> Held {
        Held {
            placed: Placed {
                point: self.store.position(v),
                entity: self.store.entity(v),
                parameters: self.store.parameters(v),
            },
            log: self.store.log(v),
            metric: self.store.metric(v),
            hint: self.store.hint(v),
        }
    }

    /// Puts a vertex back where it was.
    pub fn put_back(&mut self, v: VertexId, held: &Held) {
        debug_assert!(!self.context.is_frozen(v), "{v:?} must not move");
        self.store.set_position(v, held.placed.point);
        self.store.set_metric(v, &held.log, &held.metric);
        self.store.set_place(v, held.placed.entity, held.placed.parameters);
        self.store.set_hint(v, held.hint);
    }
}
