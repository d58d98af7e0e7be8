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

/// How a surface triangle looks to its model, as cosines.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// n_triangle · n_CAD at the closest point of the centroid: 1 − the normal deviation of METHOD.md §3.
    pub tilt: f64,
    /// Of half the greatest angle between the model's normals at the vertices. Without it a sphere could become a
    /// tetrahedron: its faces are tangent to it.
    pub spread: f64,
    /// Distance of the centroid and of the middles of the edges from the model, where that is bounded; else 0.
    pub chord: f64,
}

/// How surface triangles look to their model.
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    /// The worst of each cosine, without sign.
    worst: Look,
    /// The side from which they are seen: −1 on an interface that is met from behind.
    side: f64,
}

/// The mean of parameters on a face, mind its periods.
struct MeanParameters {
    period: [Option<f64>; 2],
    first: [f64; 2],
    sum: [f64; 2],
    count: f64,
}

impl MeanParameters {
    fn new(period: [Option<f64>; 2]) -> Self {
        Self { period, first: [0.0; 2], sum: [0.0; 2], count: 0.0 }
    }

    fn add(&mut self, mut uv: [f64; 2]) {
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

    fn get(&self) -> Option<[f64; 2]> {
        (self.count > 0.0).then(|| self.sum.map(|x| x / self.count))
    }
}

/// A triangle that turns from another by less than this cosine lies as that one did.
const STILL: f64 = 0.97;

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

    /// Parameters of a vertex on a face, if it knows them.
    fn uv_of(&mut self, v: VertexId, face: u32) -> Option<[f64; 2]> {
        let parameters = self.store.parameters(v);
        match self.store.entity(v) {
            Entity::Face(f) if f == face => Some(parameters),
            Entity::Edge(curve) => self.state.evaluator.edge_on_face(curve, parameters[0], face),
            _ => None,
        }
    }

    /// Mean parameters on a face of those of the vertices that know theirs.
    fn guess_uv(&mut self, face: u32, near: &[VertexId]) -> Option<[f64; 2]> {
        let mut mean = MeanParameters::new(self.context.model.topology().faces[face as usize].period);
        for &v in near {
            self.uv_of(v, face).into_iter().for_each(|uv| mean.add(uv));
        }
        mean.get()
    }

    /// How a triangle looks to its face; the tilt is negative when it looks to the model's inside.
    pub fn look(&mut self, triangle: [VertexId; 3], face: u32) -> Look {
        let [a, b, c] = triangle.map(|v| self.store.position(v));
        let normal = unit(area2(a, b, c));
        if let Some(plane) = self.context.planes[face as usize] {
            return Look { tilt: dot(normal, plane), spread: 1.0, chord: self.chord(triangle, face, 0.0) };
        }
        let mut mean = MeanParameters::new(self.context.model.topology().faces[face as usize].period);
        let known = triangle.map(|v| self.uv_of(v, face));
        known.into_iter().flatten().for_each(|uv| mean.add(uv));
        let centroid = scale(add(a, add(b, c)), 1.0 / 3.0);
        let foot = match mean.get() {
            Some(uv) => self.state.evaluator.closest_on_surface(face, centroid, uv),
            None => self.state.evaluator.closest_on_face(face, centroid, None),
        };
        let tilt = dot(normal, self.state.evaluator.face_normal(face, foot.uv));
        let ends = [(a, known[0]), (b, known[1]), (c, known[2])].map(|(p, uv)| self.normal_near(face, p, uv, foot.uv));
        let least = dot(ends[0], ends[1]).min(dot(ends[1], ends[2])).min(dot(ends[2], ends[0]));
        Look { tilt, spread: (0.5 * (1.0 + least)).max(0.0).sqrt(), chord: self.chord(triangle, face, foot.distance) }
    }

    /// Greatest distance from the model of a triangle's centroid, which is given, and of the middles of its edges, where it is bounded.
    fn chord(&mut self, [a, b, c]: [VertexId; 3], face: u32, centroid: f64) -> f64 {
        if self.context.limits.chord == f64::INFINITY {
            return 0.0;
        }
        [[a, b], [b, c], [c, a]].into_iter().fold(centroid, |most, edge| self.chord_of(edge, face).max(most))
    }

    /// Normal at a vertex of a face, at its parameters if it knows them; at a pole or an apex, where there is none, a little towards
    /// `inner`.
    fn normal_near(&mut self, face: u32, p: Vec3, uv: Option<[f64; 2]>, inner: [f64; 2]) -> Vec3 {
        let evaluator = &mut self.state.evaluator;
        let uv = uv.unwrap_or_else(|| evaluator.closest_on_surface(face, p, inner).uv);
        let normal = evaluator.face_normal(face, uv);
        if normal != [0.0; 3] {
            return normal;
        }
        evaluator.face_normal(face, [0, 1].map(|k| uv[k] + 1e-3 * (inner[k] - uv[k])))
    }

    /// Cosine of half the angle between the model edge's tangents at two neighbours on it.
    pub fn ridge_spread(&mut self, curve: u32, a: VertexId, b: VertexId) -> f64 {
        let [ta, tb] = [[a, b], [b, a]].map(|near| self.parameter_beside(curve, near));
        let [da, db] = [ta, tb].map(|t| unit(self.state.evaluator.edge_frame(curve, t).d1));
        (0.5 * (1.0 + dot(da, db))).max(0.0).sqrt()
    }

    /// Parameter on a model edge of the first vertex, which is on it or one of its ends; on a closed edge of the end that is nearer to
    /// the second vertex.
    fn parameter_beside(&self, curve: u32, [v, beside]: [VertexId; 2]) -> f64 {
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

    /// How the triangles that are there look to the model; with their tags.
    pub fn facing(&mut self, triangles: &[([VertexId; 3], u32)]) -> Facing {
        let (mut worst, mut sum) = (Look { tilt: 1.0, spread: 1.0, chord: 0.0 }, 0.0);
        for &(triangle, tag) in triangles {
            let look = self.look(triangle, tag - 1);
            sum += look.tilt;
            worst = Look {
                tilt: worst.tilt.min(look.tilt.abs()),
                spread: worst.spread.min(look.spread),
                chord: worst.chord.max(look.chord),
            };
        }
        Facing { worst, side: if sum < 0.0 { -1.0 } else { 1.0 } }
    }

    /// Refuses a star whose surface triangles turn from the model more than good ones may, and by `slack` more than those that go.
    pub fn check_normals(&mut self, slack: f64) -> Result<(), Refusal> {
        if self.state.star.surface.is_empty() {
            return Ok(());
        }
        let old = std::mem::take(&mut self.state.star.surface);
        let facing = self.facing(&old);
        self.state.star.surface = old;
        self.check_star_normals(facing, slack)
    }

    /// Whether each new surface triangle of the star lies nearly as one of its face that goes.
    pub fn turns_little(&self) -> bool {
        let normal = |triangle: [VertexId; 3]| {
            let [a, b, c] = triangle.map(|v| self.store.position(v));
            unit(area2(a, b, c))
        };
        self.state.replacement.faces.iter().all(|&(new, tag)| {
            let old = self.state.star.surface.iter().filter(|(_, of)| *of == tag);
            old.map(|&(triangle, _)| dot(normal(triangle), normal(new))).any(|cosine| cosine > STILL)
        })
    }

    /// As [`Worker::check_normals`], when the old triangles were looked at before.
    pub fn check_star_normals(&mut self, old: Facing, slack: f64) -> Result<(), Refusal> {
        let new = std::mem::take(&mut self.state.replacement.faces);
        let result = self.compare_normals(old, &new, slack);
        self.state.replacement.faces = new;
        result
    }

    /// Holds new triangles, with tags, against the old ones: `slack` is for the tilt alone.
    pub fn compare_normals(&mut self, old: Facing, new: &[([VertexId; 3], u32)], slack: f64) -> Result<(), Refusal> {
        let limits = self.context.limits;
        // A negative limit allows any: a vertex that must go, goes.
        let tilt = if limits.tilt < 0.0 { -1.0 } else { (old.worst.tilt - slack).min(limits.tilt).max(1e-3) };
        let spread = old.worst.spread.min(limits.spread);
        let chord = old.worst.chord.max(limits.chord);
        let turned = new.iter().any(|&(triangle, tag)| {
            let look = self.look(triangle, tag - 1);
            old.side * look.tilt < tilt || look.spread < spread || look.chord > chord
        });
        if turned { Err(Refusal::Normal) } else { Ok(()) }
    }
}
