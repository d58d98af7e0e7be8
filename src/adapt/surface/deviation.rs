//! How far surface triangles deviate from the model, and the checks that no operation makes that worse.
use super::conormal::Conormal;
use super::placement::MeanParameters;
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::geometry::{Entity, Evaluate, Geometry, OnSurface};
use crate::mesh::vector::{Vec3, add, area2, distance, dot, lerp, scale, sub, unit};

/// How far a surface triangle deviates from the model: two angles as cosines, and a distance.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceDeviation {
    /// n_triangle · n_CAD at the closest point of the centroid: one minus the normal deviation of METHOD.md §3. In unit space where the face
    /// crosses layers, unless the user bounds it; 0 where the sides seen there and in space differ.
    pub cos_deviation: f64,
    /// Cosine of half the greatest angle between the model's normals at the vertices. Without it a sphere could become a
    /// tetrahedron, whose faces are tangent to it.
    pub cos_variation: f64,
    /// Greatest distance from the model of the centroid and of the middles of the edges, where that is bounded; else 0.
    pub chord: f64,
    /// Distance of the centroid from the model, in the metric: from the nearest point there where the face crosses layers.
    pub rise: f64,
}

/// The worst deviation of several surface triangles.
#[derive(Clone, Copy, Debug)]
pub struct WorstDeviation {
    /// The worst of each measure; cosines without sign.
    worst: SurfaceDeviation,
    /// The side from which they are seen: −1 on an interface that is met from behind.
    side: f64,
}

/// A triangle with a greater cosine than this to its model tells from which side a surface is seen.
const CLEAR: f64 = 0.5;

/// A triangle with a lesser cosine than this to its model looks to the other side.
const LEAST_COSINE: f64 = 1e-3;

/// A triangle whose normal has a greater cosine than this with that of another lies as the other does.
const SAME_PLANE: f64 = 0.97;

/// Normals beside an apex are taken at this part of the way to another vertex.
const NEAR_APEX: f64 = 0.01;

/// The greatest angle between normals of an apex that a triangle may span: that of a cone, however sharp, with five triangles.
const APEX_ANGLE: f64 = 0.4 * std::f64::consts::PI + 1e-9;

/// A distance; one that is no number is beyond any bound.
fn or_far(distance: f64) -> f64 {
    if distance.is_nan() { f64::INFINITY } else { distance }
}

impl<A: Access> Worker<'_, '_, A> {
    /// [`SurfaceDeviation::cos_deviation`] alone.
    fn cos_deviation(&mut self, triangle: [VertexId; 3], face: u32) -> f64 {
        let corners = triangle.map(|v| self.store.position(v));
        let area = area2(corners[0], corners[1], corners[2]);
        match self.context.planes[face as usize] {
            Some(plane) => dot(unit(area), plane),
            None => {
                let known = triangle.map(|v| self.uv_of(v, face));
                let foot = self.foot_of_centroid(corners, known, face);
                let normal = self.state.evaluator.face_normal(face, foot.uv);
                self.cosine(area, normal, self.conormal(triangle, normal).as_ref())
            }
        }
    }

    /// The conormal at a triangle on a face, whose normal there is given, if the face crosses a layer there.
    fn conormal(&self, triangle: [VertexId; 3], normal: Vec3) -> Option<Conormal> {
        Conormal::of_face(&self.metric_of_layer(&triangle)?, normal)
    }

    /// The cosine of the angle between a triangle, given by its area vector, and the model's normal: in space, or in unit space where there is
    /// a conormal. No triangle may look to the model's inside in either.
    fn cosine(&self, area: Vec3, normal: Vec3, conormal: Option<&Conormal>) -> f64 {
        let in_space = dot(unit(area), normal);
        match conormal {
            Some(conormal) if !self.context.limits.bounds_angle => {
                let cosine = conormal.cosine(area);
                if cosine * in_space > 0.0 && in_space.abs() > LEAST_COSINE { cosine } else { 0.0 }
            }
            _ => in_space,
        }
    }

    /// The point of a face that is closest to the centroid of a triangle, whose parameters are known at some corners.
    fn foot_of_centroid(&mut self, [a, b, c]: [Vec3; 3], known: [Option<[f64; 2]>; 3], face: u32) -> OnSurface {
        let mut mean = MeanParameters::new(self.context.model.topology().faces[face as usize].period);
        known.into_iter().flatten().for_each(|uv| mean.add(uv));
        let centroid = scale(add(a, add(b, c)), 1.0 / 3.0);
        match mean.get() {
            Some(uv) => self.state.evaluator.closest_on_surface(face, centroid, uv),
            None => self.state.evaluator.closest_on_face(face, centroid, None),
        }
    }

    /// The deviation of a triangle from its face. The `cos_deviation` is negative when the triangle looks to the model's inside.
    pub fn surface_deviation(&mut self, triangle: [VertexId; 3], face: u32) -> SurfaceDeviation {
        let [a, b, c] = triangle.map(|v| self.store.position(v));
        let area = area2(a, b, c);
        if let Some(plane) = self.context.planes[face as usize] {
            return SurfaceDeviation {
                cos_deviation: dot(unit(area), plane),
                cos_variation: 1.0,
                chord: self.chord(triangle, face, 0.0),
                rise: 0.0,
            };
        }
        let known = triangle.map(|v| self.uv_of(v, face));
        let foot = self.foot_of_centroid([a, b, c], known, face);
        let normal = self.state.evaluator.face_normal(face, foot.uv);
        let conormal = self.conormal(triangle, normal);
        let cos_deviation = self.cosine(area, normal, conormal.as_ref());
        let least = self.least_normal_cosine(face, [a, b, c], known, foot.uv);
        SurfaceDeviation {
            cos_deviation,
            cos_variation: (0.5 * (1.0 + least)).max(0.0).sqrt(),
            chord: self.chord(triangle, face, foot.distance),
            rise: self.rise(triangle, sub(foot.point, scale(add(a, add(b, c)), 1.0 / 3.0)), normal, conormal),
        }
    }

    /// How far the centroid of a triangle is from the model, in the mean of the metrics of its vertices; `way` leads to its foot.
    fn rise(&self, triangle: [VertexId; 3], way: Vec3, normal: Vec3, conormal: Option<Conormal>) -> f64 {
        if let Some(conormal) = conormal {
            return or_far(conormal.length(dot(way, normal)));
        }
        let lengths = triangle.map(|v| self.store.metric(v).quadratic(way).sqrt());
        or_far((lengths[0] + lengths[1] + lengths[2]) / 3.0)
    }

    /// The chord error of a triangle, where it is bounded; else 0. The distance of the `centroid` is given.
    fn chord(&mut self, [a, b, c]: [VertexId; 3], face: u32, centroid: f64) -> f64 {
        if self.context.limits.chord == f64::INFINITY {
            return 0.0;
        }
        [[a, b], [b, c], [c, a]].into_iter().fold(or_far(centroid), |most, edge| self.chord_of(edge, face).max(most))
    }

    /// Distance of the middle of a triangle's edge from the face, or from the model edge where it is a ridge.
    pub fn chord_of(&mut self, [a, b]: [VertexId; 2], face: u32) -> f64 {
        let middle = lerp(self.store.position(a), self.store.position(b), 0.5);
        let entity = self.store.ridge_curve(a, b).map_or(Entity::Face(face), Entity::Edge);
        if entity == Entity::Face(face) && self.context.planes[face as usize].is_some() {
            return 0.0;
        }
        or_far(distance(middle, self.closest(entity, middle, &[a, b]).point))
    }

    /// The least cosine between the normals of a face at the vertices of a triangle. `inner` are the parameters of the foot of its centroid.
    fn least_normal_cosine(&mut self, face: u32, p: [Vec3; 3], known: [Option<[f64; 2]>; 3], inner: [f64; 2]) -> f64 {
        let mut at = [[0.0; 2]; 3];
        let mut normals = [[0.0; 3]; 3];
        for k in 0..3 {
            at[k] = known[k].unwrap_or_else(|| self.state.evaluator.foot_on_surface(face, p[k], inner).uv);
            normals[k] = self.state.evaluator.face_normal(face, at[k]);
        }
        if normals.contains(&[0.0; 3]) {
            return self.least_normal_cosine_at_apex(face, p, normals, at, inner);
        }
        let [a, b, c] = normals;
        dot(a, b).min(dot(b, c)).min(dot(c, a))
    }

    /// As [`Worker::least_normal_cosine`] where the face has no normal at a vertex, the apex of a cone or the pole of a sphere: there it has
    /// one towards each other vertex. At an apex these differ however small the triangle is, so the normals at the other two may differ by
    /// as much more, up to what five triangles round it need.
    fn least_normal_cosine_at_apex(
        &mut self,
        face: u32,
        p: [Vec3; 3],
        normals: [Vec3; 3],
        at: [[f64; 2]; 3],
        inner: [f64; 2],
    ) -> f64 {
        let mut towards = |i: usize, j: usize| {
            if normals[i] != [0.0; 3] {
                return normals[i];
            }
            let guess = if normals[j] == [0.0; 3] { inner } else { at[j] };
            let evaluator = &mut self.state.evaluator;
            let foot = evaluator.foot_on_surface(face, lerp(p[i], p[j], NEAR_APEX), guess);
            evaluator.face_normal(face, foot.uv)
        };
        let angle = |a: Vec3, b: Vec3| dot(a, b).clamp(-1.0, 1.0).acos();
        let mut greatest = 0.0_f64;
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let across = angle(towards(i, j), towards(j, i));
            let of_apex = angle(towards(k, i), towards(k, j));
            let allowed = if of_apex <= APEX_ANGLE { of_apex } else { 0.0 };
            greatest = greatest.max(across - allowed);
        }
        greatest.cos()
    }

    /// Cosine of half the angle between the model edge's tangents at two neighbours on it.
    pub fn ridge_variation(&mut self, curve: u32, a: VertexId, b: VertexId) -> f64 {
        let [ta, tb] = [[a, b], [b, a]].map(|near| self.parameter_beside(curve, near));
        let [da, db] = [ta, tb].map(|t| unit(self.state.evaluator.edge_frame(curve, t).d1));
        (0.5 * (1.0 + dot(da, db))).max(0.0).sqrt()
    }

    /// The worst deviation of some triangles, given with their tags.
    pub fn worst_deviation(&mut self, triangles: &[([VertexId; 3], u32)]) -> WorstDeviation {
        let (mut worst, mut sum) =
            (SurfaceDeviation { cos_deviation: 1.0, cos_variation: 1.0, chord: 0.0, rise: 0.0 }, 0.0);
        for &(triangle, tag) in triangles {
            let deviation = self.surface_deviation(triangle, tag - 1);
            sum += deviation.cos_deviation;
            worst = SurfaceDeviation {
                cos_deviation: worst.cos_deviation.min(deviation.cos_deviation.abs()),
                cos_variation: worst.cos_variation.min(deviation.cos_variation),
                chord: worst.chord.max(deviation.chord),
                rise: worst.rise.max(deviation.rise),
            };
        }
        WorstDeviation { worst, side: if sum < 0.0 { -1.0 } else { 1.0 } }
    }

    /// How many of some surface triangles, with their tags, look to the other side of the model than most of them do.
    pub fn folded(&mut self, triangles: &[([VertexId; 3], u32)]) -> usize {
        let beyond =
            triangles.iter().filter(|&&(triangle, tag)| self.cos_deviation(triangle, tag - 1) < LEAST_COSINE).count();
        beyond.min(triangles.len() - beyond)
    }

    /// Refuses a star whose surface triangles deviate more than the limits and more than the triangles that go, by `slack`.
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

    /// Whether each new surface triangle of the star has nearly the normal of an old one on the same face.
    pub fn keeps_normals(&self) -> bool {
        let normal = |triangle: [VertexId; 3]| {
            let [a, b, c] = triangle.map(|v| self.store.position(v));
            unit(area2(a, b, c))
        };
        self.state.replacement.faces.iter().all(|&(new, tag)| {
            let old = self.state.star.surface.iter().filter(|(_, of)| *of == tag);
            old.map(|&(triangle, _)| dot(normal(triangle), normal(new))).any(|cosine| cosine > SAME_PLANE)
        })
    }

    /// Whether more of the star's new surface triangles than of the old ones look to the other side of the model.
    pub fn turns_over(&mut self) -> bool {
        let old = std::mem::take(&mut self.state.star.surface);
        let new = std::mem::take(&mut self.state.replacement.faces);
        let turned = self.folded(&new) > self.folded(&old);
        self.state.star.surface = old;
        self.state.replacement.faces = new;
        turned
    }

    /// As [`Worker::check_normals`], with the old triangles measured before.
    pub fn check_star_normals(&mut self, old: WorstDeviation, slack: f64) -> Result<(), Refusal> {
        let new = std::mem::take(&mut self.state.replacement.faces);
        let result = self.compare_with(old, &new, slack);
        self.state.replacement.faces = new;
        result
    }

    /// Compares new triangles, with their tags, with the old ones. `slack` is for `cos_deviation` alone.
    pub fn compare_normals(
        &mut self,
        old: &[([VertexId; 3], u32)],
        new: &[([VertexId; 3], u32)],
        slack: f64,
    ) -> Result<(), Refusal> {
        // Most are within the limits by themselves, whatever the old ones are.
        if self.clear_side(old).is_some_and(|side| self.are_within_limits(side, new)) {
            return Ok(());
        }
        let old = self.worst_deviation(old);
        self.compare_with(old, new, slack)
    }

    /// The side that triangles are seen from, by the first of them alone; none where that is not clear.
    pub fn clear_side(&mut self, triangles: &[([VertexId; 3], u32)]) -> Option<f64> {
        let &(triangle, tag) = triangles.first()?;
        let cosine = self.cos_deviation(triangle, tag - 1);
        (cosine.abs() > CLEAR).then(|| cosine.signum())
    }

    /// Whether triangles are within the limits, seen from this side: then it does not matter what those that they replace are.
    pub fn are_within_limits(&mut self, side: f64, triangles: &[([VertexId; 3], u32)]) -> bool {
        let limits = self.context.limits;
        triangles.iter().all(|&(triangle, tag)| {
            let deviation = self.surface_deviation(triangle, tag - 1);
            side * deviation.cos_deviation >= limits.cos_deviation.max(LEAST_COSINE)
                && deviation.cos_variation >= limits.cos_variation
                && deviation.chord <= limits.chord
                && deviation.rise <= limits.rise
        })
    }

    /// Compares new triangles, with their tags, with old ones that were measured before.
    pub fn compare_with(
        &mut self,
        old: WorstDeviation,
        new: &[([VertexId; 3], u32)],
        slack: f64,
    ) -> Result<(), Refusal> {
        let limits = self.context.limits;
        // A negative limit allows any deviation: the vertex has to go.
        let cos_deviation = if limits.cos_deviation < 0.0 {
            -1.0
        } else {
            (old.worst.cos_deviation - slack).min(limits.cos_deviation).max(LEAST_COSINE)
        };
        let cos_variation = old.worst.cos_variation.min(limits.cos_variation);
        let chord = old.worst.chord.max(limits.chord);
        let rise = old.worst.rise.max(limits.rise);
        let turned = new.iter().any(|&(triangle, tag)| {
            let deviation = self.surface_deviation(triangle, tag - 1);
            old.side * deviation.cos_deviation < cos_deviation
                || deviation.cos_variation < cos_variation
                || deviation.chord > chord
                || deviation.rise > rise
        });
        if turned { Err(Refusal::Normal) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Exclusive;
    use crate::adapt::core::ball::Ball;
    use crate::adapt::core::ids::FACE;
    use crate::adapt::tests::bench::{Bench, Shape, Task, sample};

    #[test]
    fn an_interface_is_seen_from_one_side() {
        let sample = sample(Shape::TwoRegions, 4, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        for task in [Task::Split, Task::Collapse, Task::Split] {
            bench.sweep(task);
        }
        let store = &bench.context.store;
        let middle = |v: &VertexId| store.dimension(*v) == 2 && store.position(*v)[0] == 0.5;
        let vertices: Vec<VertexId> = store.live_vertices().filter(middle).collect();
        assert!(vertices.len() > 10, "{}", vertices.len());
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        for v in vertices {
            let (mut ball, mut triangles) = (Ball::default(), Vec::new());
            worker.gather_ball(v, &mut ball).unwrap();
            worker.list_surface(v, &ball.tets, &mut triangles);
            let sides =
                triangles.iter().map(|&(triangle, tag)| worker.surface_deviation(triangle, tag - 1).cos_deviation);
            let sides: Vec<f64> = sides.collect();
            assert!(sides.len() > 2 && sides.iter().all(|side| side * sides[0] > 0.9), "{sides:?}");
        }
    }

    #[test]
    fn a_distance_that_is_no_number_is_beyond_any_bound() {
        let sample = sample(Shape::Round, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        bench.context.limits.chord = 1.0;
        let store = &bench.context.store;
        let (t, i) =
            store.live_tets().find_map(|t| Some((t, store.tags(t).iter().position(|&tag| tag != 0)?))).unwrap();
        let (triangle, tag) = (FACE[i].map(|k| store.vertices(t)[k]), store.tags(t)[i]);
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Exclusive);
        let before = worker.worst_deviation(&[(triangle, tag)]);
        let sound = worker.surface_deviation(triangle, tag - 1);
        assert!(sound.chord <= 1.0 && !worker.deviates(sound));
        store.displace(triangle[0], [f64::NAN; 3]);
        let lost = worker.surface_deviation(triangle, tag - 1);
        assert!(lost.chord == f64::INFINITY && worker.deviates(lost), "{lost:?}");
        assert_eq!(worker.compare_with(before, &[(triangle, tag)], 0.0), Err(Refusal::Normal));
    }
}
