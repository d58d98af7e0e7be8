//! The boundary on the model: where a new point belongs, its closest point, the normal deviation of triangles.
use super::access::Access;
use super::ids::VertexId;
use super::outcome::Refusal;
use super::worker::Worker;
use crate::geometry::{Entity, Evaluate, Geometry};
use crate::mesh::vector::{Vec3, add, area2, dot, scale, unit};

/// A point with its place on the model.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Position.
    pub point: Vec3,
    /// Entity.
    pub entity: Entity,
    /// Parameters on it.
    pub parameters: [f64; 2],
}

impl<A: Access> Worker<'_, '_, A> {
    /// The entity of a point on the edge a–b; the shell of the edge is in `state.shell`.
    pub fn entity_of_edge(&self, a: VertexId, b: VertexId) -> Entity {
        if let Some(curve) = self.store.ridge_curve(a, b) {
            return Entity::Edge(curve);
        }
        self.state.shell.surface_tags().next().map_or(Entity::Interior, |tag| Entity::Face(tag - 1))
    }

    /// The closest point of the entity to `point`, which lies near the vertices `near` of the same entity or its border.
    pub fn place(&mut self, entity: Entity, point: Vec3, near: &[VertexId]) -> Placed {
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

    /// Mean parameter on a model edge of those of the vertices that know theirs.
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

    /// Mean parameters on a face of those of the vertices that know theirs; mind the period.
    fn guess_uv(&mut self, face: u32, near: &[VertexId]) -> Option<[f64; 2]> {
        let period = self.context.model.topology().faces[face as usize].period;
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        let mut first: Option<[f64; 2]> = None;
        for &v in near {
            let parameters = self.store.parameters(v);
            let uv = match self.store.entity(v) {
                Entity::Face(f) if f == face => Some(parameters),
                Entity::Edge(curve) => self.state.evaluator.edge_on_face(curve, parameters[0], face),
                _ => None,
            };
            let Some(mut uv) = uv else { continue };
            let start = *first.get_or_insert(uv);
            for k in 0..2 {
                if let Some(period) = period[k] {
                    uv[k] -= period * ((uv[k] - start[k]) / period).round();
                }
                sum[k] += uv[k];
            }
            count += 1.0;
        }
        (count > 0.0).then(|| sum.map(|x| x / count))
    }

    /// n_triangle · n_CAD at the closest point of the centroid: 1 − the normal deviation of METHOD.md §3.
    pub fn cosine(&mut self, triangle: [VertexId; 3], face: u32) -> f64 {
        let [a, b, c] = triangle.map(|v| self.store.position(v));
        let normal = unit(area2(a, b, c));
        if let Some(plane) = self.context.planes[face as usize] {
            return dot(normal, plane);
        }
        let centroid = scale(add(a, add(b, c)), 1.0 / 3.0);
        let placed = self.place(Entity::Face(face), centroid, &triangle);
        dot(normal, self.state.evaluator.face_normal(face, placed.parameters))
    }

    /// Refuses a replacement whose surface triangles turn away from the model more than `floor` and more than those that go.
    ///
    /// On an interface the side from which triangles are seen is told by the old ones.
    pub fn check_normals(&mut self, slack: f64) -> Result<(), Refusal> {
        if self.state.star.surface.is_empty() {
            return Ok(());
        }
        let old = std::mem::take(&mut self.state.star.surface);
        let new = std::mem::take(&mut self.state.replacement.faces);
        let result = self.compare_normals(&old, &new, slack);
        self.state.star.surface = old;
        self.state.replacement.faces = new;
        result
    }

    /// See [`Worker::check_normals`]; triangles with tags.
    pub fn compare_normals(
        &mut self,
        old: &[([VertexId; 3], u32)],
        new: &[([VertexId; 3], u32)],
        slack: f64,
    ) -> Result<(), Refusal> {
        let mut worst = 1.0_f64;
        let mut side = 0.0;
        for &(triangle, tag) in old {
            let cosine = self.cosine(triangle, tag - 1);
            side += cosine;
            worst = worst.min(cosine.abs());
        }
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        let floor = (worst - slack).min(self.context.limits.cosine).max(1e-3);
        for &(triangle, tag) in new {
            if side * self.cosine(triangle, tag - 1) < floor {
                return Err(Refusal::Normal);
            }
        }
        Ok(())
    }
}
