//! Smoothing: a vertex moves, within its entity of the model, to where its tetrahedra are better.
//!
//! Two directions are tried: to the mean of the places that give its edges unit length (pliant), and down the gradient of
//! the energy Σ 1/Q³ of its tetrahedra, measured in its metric. A step counts only if the energy falls, no
//! tetrahedron is inverted (exact), and the surface does not turn from its model.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::outcome::Refusal;
use super::surface::Placed;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, add, area2, dot, lerp, scale, sub};
use crate::metric::Sym3;
use crate::metric::quality::mean_log;

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

/// Part of the energy that a step must save.
const GAIN: f64 = 0.01;

/// Parts of a direction that are tried.
const STEPS: [f64; 2] = [0.8, 0.3];

/// Weight of the edge lengths in the energy, beside the shapes.
const LENGTH_WEIGHT: f64 = 1.0;

/// ((L − 1/L)/2)² = sinh² ln L, weighted: 0 at unit length, the same for twice and for half of it.
#[inline(always)]
fn misfit(length: f64) -> f64 {
    let difference = length - 1.0 / length;
    0.25 * LENGTH_WEIGHT * difference * difference
}

impl<A: Access> Worker<'_, '_, A> {
    /// Smooths one vertex whose worst tetrahedron is below the limit.
    pub fn smooth(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        let entity = self.store.entity(v);
        if matches!(entity, Entity::Vertex(_)) || self.context.is_frozen(v) {
            return Err(Refusal::Geometry);
        }
        self.gather_ball(v)?;
        let ball = std::mem::take(&mut self.state.ball);
        let result = self.smooth_in(v, &ball);
        self.state.ball = ball;
        result
    }

    fn smooth_in(&mut self, v: VertexId, ball: &[TetId]) -> Result<(), Refusal> {
        let worst = ball.iter().map(|&t| self.store.quality(t)).fold(f64::INFINITY, f64::min);
        if worst >= self.context.limits.improve_below {
            return Err(Refusal::Stale);
        }
        self.list_link(v, ball);
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, ball, &mut triangles);
        let moved = self.descend(v, ball, &triangles);
        self.state.star.surface = triangles;
        if moved { Ok(()) } else { Err(Refusal::Shape) }
    }

    /// Tries the directions in turn, each with shorter and shorter steps, until the vertex moves; whether it did.
    fn descend(&mut self, v: VertexId, ball: &[TetId], triangles: &[([VertexId; 3], u32)]) -> bool {
        let from = self.store.position(v);
        let (energy, pliant) = self.present_energy(v, ball);
        let limit = energy * (1.0 - GAIN);
        for direction in 0..2 {
            let to = if direction == 0 { pliant } else { self.gradient_point(v, ball) };
            for step in STEPS {
                if self.try_move(v, lerp(from, to, step), ball, triangles, limit) {
                    return true;
                }
            }
        }
        false
    }

    /// Moves the vertex to the closest point of its entity when the energy falls below `limit` there; else puts it back.
    fn try_move(
        &mut self,
        v: VertexId,
        target: Vec3,
        ball: &[TetId],
        triangles: &[([VertexId; 3], u32)],
        limit: f64,
    ) -> bool {
        let held = self.hold(v);
        let placed = self.place(held.placed.entity, target, &[v]);
        let facing = (!triangles.is_empty()).then(|| self.facing(triangles));
        self.set_point(v, placed.point, held.hint);
        self.store.set_place(v, placed.entity, placed.parameters);
        let mut shapes = std::mem::take(&mut self.state.shapes);
        let falls = self.energy(v, ball, limit, &mut shapes) < limit;
        let moved = falls && facing.is_none_or(|facing| self.compare_normals(facing, triangles, 0.0).is_ok());
        if moved {
            for (&t, &shape) in ball.iter().zip(&shapes) {
                self.store.set_quality(t, shape);
                self.store.touch(t);
            }
        } else {
            self.put_back(v, &held);
        }
        self.state.shapes = shapes;
        moved
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
        self.store.set_position(v, held.placed.point);
        self.store.set_metric(v, &held.log, &held.metric);
        self.store.set_place(v, held.placed.entity, held.placed.parameters);
        self.store.set_hint(v, held.hint);
    }

    /// The energy as the vertex lies, from the kept mean ratios; and the place that the lengths ask for: the mean of the points that
    /// have unit distance from the neighbours, in the direction of v (pliant).
    fn present_energy(&self, v: VertexId, ball: &[TetId]) -> (f64, Vec3) {
        let shapes = ball.iter().map(|&t| self.store.quality(t).max(1e-6));
        let mut energy = shapes.map(|shape| 1.0 / (shape * shape * shape)).sum::<f64>();
        let p = self.store.position(v);
        let mut sum = [0.0; 3];
        let link = &self.state.star.link;
        for &x in link {
            let length = self.length(v, x);
            energy += misfit(length);
            sum = add(sum, lerp(self.store.position(x), p, 1.0 / length.max(0.1)));
        }
        (energy, scale(sum, 1.0 / link.len() as f64))
    }

    /// Σ 1/Q³ over the ball and Σ ((L − 1/L)/2)² over the edges at v; infinite when a tetrahedron is inverted or the sum passes
    /// `limit`. Leaves the mean ratios in `shapes`.
    fn energy(&self, v: VertexId, ball: &[TetId], limit: f64, shapes: &mut Vec<f64>) -> f64 {
        shapes.clear();
        let mut energy = 0.0;
        for &t in ball {
            let shape = self.shape(self.store.vertices(t));
            if shape <= 0.0 || energy > limit {
                return f64::INFINITY;
            }
            energy += 1.0 / (shape * shape * shape);
            shapes.push(shape);
        }
        energy + self.state.star.link.iter().map(|&x| misfit(self.length(v, x))).sum::<f64>()
    }

    /// A step down the energy's gradient: M⁻¹∇E, at most 0.3 long in the metric.
    fn gradient_point(&self, v: VertexId, ball: &[TetId]) -> Vec3 {
        let mut gradient = [0.0; 3];
        let p = self.store.position(v);
        for &t in ball {
            let w = self.store.vertices(t);
            let i = w.iter().position(|&x| x == v).expect("the ball holds its vertex");
            let logs = w.map(|x| self.store.log(x));
            let mean = mean_log([&logs[0], &logs[1], &logs[2], &logs[3]]).exp();
            let x = w.map(|x| self.store.position(x));
            let [a, b, c] = FACE[i].map(|k| x[k]);
            // ∇Q/Q = ⅔ ∇V/V − ∇S/S, with V = area·(p − a)/6 and S the sum of squared edges, in the mean metric.
            let area = area2(a, b, c);
            let volume = dot(area, sub(p, a));
            let edges = [sub(b, a), sub(c, a), sub(c, b), sub(p, a), sub(p, b), sub(p, c)];
            let sum: f64 = edges.iter().map(|&e| mean.quadratic(e)).sum();
            let pull = mean.apply(add(edges[3], add(edges[4], edges[5])));
            let relative = sub(scale(area, 2.0 / (3.0 * volume)), scale(pull, 2.0 / sum));
            let quality = self.store.quality(t).max(1e-3);
            gradient = add(gradient, scale(relative, 1.0 / (quality * quality * quality)));
        }
        let step = self.store.metric(v).inverse().apply(gradient);
        let length = self.store.metric(v).quadratic(step).sqrt();
        add(p, scale(step, if length > 0.0 { 0.3 / length } else { 0.0 }))
    }

    /// Lists the vertices joined to v in `state.star.link`.
    pub fn list_link(&mut self, v: VertexId, ball: &[TetId]) {
        let (set, link) = (&mut self.state.set, &mut self.state.star.link);
        set.clear();
        link.clear();
        set.insert(v.0);
        for &t in ball {
            link.extend(self.store.vertices(t).into_iter().filter(|x| set.insert(x.0)));
        }
    }

    /// Adds the surface triangles at v to the list, outward, with their tags.
    pub fn list_surface(&self, v: VertexId, ball: &[TetId], triangles: &mut Vec<([VertexId; 3], u32)>) {
        if self.store.dimension(v) == 3 {
            return;
        }
        for &t in ball {
            let (w, tags, n) = (self.store.vertices(t), self.store.tags(t), self.store.neighbours(t));
            for i in (0..4).filter(|&i| tags[i] != 0 && w[i] != v && w.contains(&v) && (!n[i].is_some() || t < n[i])) {
                let [a, b, c] = FACE[i].map(|k| w[k]);
                triangles.push(([a, c, b], tags[i]));
            }
        }
    }
}
