//! Where a new point of the boundary belongs: its entity, its closest point there, the guesses that the search begins with.
use super::conormal::{Conormal, metric_of_layer};
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::vertex_moves::Placed;
use crate::adapt::core::worker::Worker;
use crate::geometry::{Entity, Evaluate, Geometry};
use crate::mesh::vector::{Vec3, add, dot, sub, unit};
use crate::metric::Sym3;

/// A point whose closest point on the model is no farther than the root of this, in the metric, goes there.
const NEAR: f64 = 0.04;

/// The square of the way in the metric must be less than this share of that to the closest point, else the vertex goes there.
const GAIN: f64 = 0.64;

/// Steps to the point that is nearest in the metric.
const STEPS: usize = 3;

/// The mean of parameters on a face, across its periods.
pub struct MeanParameters {
    period: [Option<f64>; 2],
    first: [f64; 2],
    sum: [f64; 2],
    count: f64,
}

impl MeanParameters {
    pub fn new(period: [Option<f64>; 2]) -> Self {
        Self { period, first: [0.0; 2], sum: [0.0; 2], count: 0.0 }
    }

    pub fn add(&mut self, mut uv: [f64; 2]) {
        if self.count == 0.0 {
            self.first = uv;
        }
        for k in 0..2 {
            if let Some(period) = self.period[k] {
                uv[k] -= period * ((uv[k] - self.first[k]) / period).round();
            }
            self.sum[k] += uv[k];
        }
        self.count += 1.0;
    }

    pub fn get(&self) -> Option<[f64; 2]> {
        (self.count > 0.0).then(|| self.sum.map(|x| x / self.count))
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// The entity of a point on the edge a–b; the shell of the edge is in `state.shell`.
    pub fn entity_of_edge(&self, a: VertexId, b: VertexId) -> Entity {
        if let Some(curve) = self.store.ridge_curve(a, b) {
            return Entity::Edge(curve);
        }
        self.state.shell.surface_tags().next().map_or(Entity::Interior, |tag| Entity::Face(tag - 1))
    }

    /// Where a point belongs on the entity: its closest point there, but the nearest in the metric where the entity crosses thin layers, since
    /// the closest point may lie many layers away. The point lies near the vertices `near` of the same entity or its border.
    pub fn place(&mut self, entity: Entity, point: Vec3, near: &[VertexId]) -> Placed {
        let closest = self.closest(entity, point, near);
        if closest.point == point {
            return closest;
        }
        self.nearest_in_metric(closest, point, near).unwrap_or(closest)
    }

    /// The point of an entity that is nearest to `point` in the metric, from the closest one; none where the entity crosses no layer, or where
    /// the closest point is hardly farther.
    fn nearest_in_metric(&mut self, closest: Placed, point: Vec3, near: &[VertexId]) -> Option<Placed> {
        let metric = self.metric_of_layer(near)?;
        let far = |placed: Placed| metric.quadratic(sub(placed.point, point));
        let to_closest = far(closest);
        if to_closest < NEAR {
            return None;
        }
        let nearest = match closest.entity {
            Entity::Edge(curve) => self.nearest_on_edge(curve, point, &metric, closest),
            Entity::Face(face) if self.context.planes[face as usize].is_none() => {
                self.nearest_on_face(face, point, &metric, closest)
            }
            _ => None,
        };
        nearest.filter(|&nearest| far(nearest) < GAIN * to_closest)
    }

    /// The mean metric of vertices, if one layer can run through them all.
    pub fn metric_of_layer(&self, vertices: &[VertexId]) -> Option<Sym3> {
        metric_of_layer(vertices.iter().map(|&v| self.store.metric(v)))
    }

    /// The point of a face that is nearest to `point` in a metric, from the closest one; none where the face crosses no layers.
    fn nearest_on_face(&mut self, face: u32, point: Vec3, metric: &Sym3, closest: Placed) -> Option<Placed> {
        let mut at = None;
        for _ in 0..STEPS {
            let Placed { point: foot, parameters: uv, .. } = at.unwrap_or(closest);
            let normal = self.state.evaluator.face_normal(face, uv);
            let Some(conormal) = Conormal::of_face(metric, normal) else { break };
            let goal = add(point, conormal.step(dot(normal, sub(foot, point))));
            let found = self.state.evaluator.closest_on_surface(face, goal, uv);
            at = Some(Placed { point: found.point, parameters: found.uv, ..closest });
        }
        at
    }

    /// The same on an edge of the model, by Gauss and Newton's steps.
    fn nearest_on_edge(&mut self, curve: u32, point: Vec3, metric: &Sym3, closest: Placed) -> Option<Placed> {
        let [low, high] = self.context.model.topology().edges[curve as usize].range;
        let mut t = closest.parameters[0];
        let mut frame = self.state.evaluator.edge_frame(curve, t);
        Conormal::of_edge(metric, unit(frame.d1), unit(sub(closest.point, point)))?;
        for _ in 0..STEPS {
            let along = metric.apply(frame.d1);
            let step = dot(along, sub(point, frame.point)) / dot(along, frame.d1);
            if !step.is_finite() {
                return None;
            }
            t = (t + step).clamp(low, high);
            frame = self.state.evaluator.edge_frame(curve, t);
        }
        Some(Placed { point: frame.point, parameters: [t, 0.0], ..closest })
    }

    /// The closest point of the entity to `point`, which lies near the vertices `near` of the same entity or its border.
    pub fn closest(&mut self, entity: Entity, point: Vec3, near: &[VertexId]) -> Placed {
        match entity {
            Entity::Edge(curve) => {
                let guess = self.guess_t(curve, near);
                let found = self.state.evaluator.closest_on_edge(curve, point, guess);
                Placed { point: found.point, entity, parameters: [found.t, 0.0] }
            }
            Entity::Face(face) => {
                let found = match self.guess_uv(face, near) {
                    Some(uv) => self.state.evaluator.closest_on_surface(face, point, uv),
                    None => self.state.evaluator.closest_on_face(face, point, None),
                };
                Placed { point: found.point, entity, parameters: found.uv }
            }
            Entity::Vertex(_) | Entity::Interior => Placed { point, entity, parameters: [0.0; 2] },
        }
    }

    /// The mean parameter, on a model edge, of the vertices whose parameter is known.
    fn guess_t(&self, curve: u32, near: &[VertexId]) -> Option<f64> {
        let edge = &self.context.model.topology().edges[curve as usize];
        let known = near.iter().filter(|&&v| self.store.entity(v) == Entity::Edge(curve));
        let known: (f64, f64) = known.fold((0.0, 0.0), |(sum, n), &v| (sum + self.store.parameters(v)[0], n + 1.0));
        let mean = (known.1 > 0.0).then(|| known.0 / known.1);
        let end = near.iter().find_map(|&v| match self.store.entity(v) {
            Entity::Vertex(corner) => {
                let at = |k: usize| edge.vertices[k] == Some(corner);
                match (at(0), at(1), mean) {
                    (true, false, _) => Some(edge.range[0]),
                    (false, true, _) => Some(edge.range[1]),
                    // Both ends are this corner: the nearer one.
                    (true, true, Some(t)) => {
                        Some(edge.range[usize::from((t - edge.range[0]).abs() > (edge.range[1] - t).abs())])
                    }
                    _ => None,
                }
            }
            _ => None,
        });
        match (mean, end) {
            (Some(t), Some(end)) => Some(0.5 * (t + end)),
            (mean, end) => mean.or(end),
        }
    }

    /// Parameters of a vertex on a face, if they are known.
    pub fn uv_of(&mut self, v: VertexId, face: u32) -> Option<[f64; 2]> {
        let parameters = self.store.parameters(v);
        match self.store.entity(v) {
            Entity::Face(f) if f == face => Some(parameters),
            Entity::Edge(curve) => self.state.evaluator.edge_on_face(curve, parameters[0], face),
            _ => None,
        }
    }

    /// The mean parameters, on a face, of the vertices whose parameters are known.
    fn guess_uv(&mut self, face: u32, near: &[VertexId]) -> Option<[f64; 2]> {
        let mut mean = MeanParameters::new(self.context.model.topology().faces[face as usize].period);
        for &v in near {
            self.uv_of(v, face).into_iter().for_each(|uv| mean.add(uv));
        }
        mean.get()
    }

    /// Parameter on a model edge of the first vertex, which lies on it or is one of its ends. On a closed edge it is that of the end which
    /// is nearer to the second vertex.
    pub fn parameter_beside(&self, curve: u32, [v, beside]: [VertexId; 2]) -> f64 {
        let edge = &self.context.model.topology().edges[curve as usize];
        let Entity::Vertex(corner) = self.store.entity(v) else { return self.store.parameters(v)[0] };
        let [low, high] = edge.range;
        match edge.vertices.map(|end| end == Some(corner)) {
            [true, true] => {
                let t = self.store.parameters(beside)[0];
                if (t - low).abs() <= (high - t).abs() { low } else { high }
            }
            [_, true] => high,
            _ => low,
        }
    }
}
