//! The tensor that the curvature of an entity asks for at a point of it.
use super::Options;
use crate::geometry::{Entity, Evaluate, SurfaceFrame, SurfaceKind, Topology};
use crate::mesh::vector::{Vec3, dot, norm, scale};
use crate::metric::Sym3;

/// Where S_u (or S_v) is shorter than this share of its length in the middle of the face, the parameters are at a pole or an apex. There
/// the curvatures would be rounding, or do not exist.
const COLLAPSED: f64 = 1e-3;
/// A pole or apex is looked for only where one derivative is shorter than this share of the other, both times the face's range.
const SUSPICIOUS: f64 = 0.03;
/// Places around a pole or an apex at which the limit is taken.
const AROUND: usize = 8;
/// How far towards the middle of its range the limit is taken, at first.
const NUDGE: f64 = 2e-3;

/// The metric that the entities at a point ask for, with their directions there. Keep one a thread.
#[derive(Default)]
pub struct Local {
    /// The metric; set by [`Curvature::at`].
    pub metric: Option<Sym3>,
    /// Unit normals of the faces, out of the solid, where they are defined.
    pub normals: Vec<Vec3>,
    /// Unit tangents of the edges.
    pub tangents: Vec<Vec3>,
    /// Whether the point is a pole, an apex or an end at which a curve stands still: its metric is a limit.
    pub is_limit: bool,
    /// Greatest curvature of the faces and edges, 1/length. Poles and apices do not count.
    pub greatest_curvature: f64,
    /// Faces that are in the metric already, with their parameters.
    asked: Vec<(u32, [f64; 2])>,
}

impl Local {
    pub(super) fn clear(&mut self) {
        self.metric = None;
        self.normals.clear();
        self.tangents.clear();
        self.asked.clear();
        self.is_limit = false;
        self.greatest_curvature = 0.0;
    }

    /// M ∩ the metric of another face.
    fn intersect(&mut self, other: Sym3) {
        self.metric = Some(self.metric.map_or(other, |metric| metric.intersect(&other)));
    }
}

/// M ∩ a metric that has the size h along the unit vector g and leaves all other directions free: the unit ball of M is cut to the slab
/// |g·x| ≤ h. The other metric, relative to M, has the one eigenvector M^(-1/2) g/h, so the intersection of METHOD.md §1.6 is
/// M + (1 − 1/μ) ggᵀ/h², μ = gᵀM⁻¹g/h².
pub(super) fn cut(metric: Sym3, g: Vec3, h: f64) -> Sym3 {
    let excess = dot(g, metric.solve(g)) / (h * h);
    if excess > 1.0 { metric.plus(Sym3::outer(g, (1.0 - 1.0 / excess) / (h * h))) } else { metric }
}

/// Curvature into sizes, for one model.
pub struct Curvature<'a> {
    options: &'a Options,
    topology: &'a Topology,
}

impl<'a> Curvature<'a> {
    /// For a model.
    pub fn new(options: &'a Options, topology: &'a Topology) -> Self {
        Self { options, topology }
    }

    /// The metric of an entity at parameters, (t, 0) on an edge, (u, v) on a face. On a face it comes of the principal curvatures, on an edge
    /// of all its faces and of its own curvature along the tangent, at a vertex of all edges and faces there. It is finite everywhere:
    /// at a pole it is a limit, at an apex it has the least size near it in all directions.
    pub fn at(&self, evaluator: &mut impl Evaluate, entity: Entity, parameters: [f64; 2], local: &mut Local) {
        local.clear();
        match entity {
            Entity::Face(face) => self.add_face(evaluator, face, parameters, local),
            Entity::Edge(edge) => self.add_beside(evaluator, edge, parameters[0], local),
            Entity::Vertex(vertex) => {
                self.ends(vertex).for_each(|(edge, t)| self.add_beside(evaluator, edge, t, local));
            }
            Entity::Interior => {}
        }
        self.add_edges(evaluator, entity, parameters[0], local);
    }

    /// The metric so far; the greatest size where there is none.
    pub(super) fn metric_of(&self, local: &Local) -> Sym3 {
        local.metric.unwrap_or_else(|| Sym3::IDENTITY.times(self.options.greatest.powi(-2)))
    }

    /// The faces of an edge.
    fn add_beside(&self, evaluator: &mut impl Evaluate, edge: u32, t: f64, local: &mut Local) {
        for &face in &self.topology.edges[edge as usize].faces {
            let Some(uv) = evaluator.edge_on_face(edge, t, face) else { continue };
            let range = self.topology.faces[face as usize].range;
            let same = |&(f, at): &(u32, [f64; 2])| {
                f == face && (0..2).all(|k| (at[k] - uv[k]).abs() <= 1e-6 * (range[k][1] - range[k][0]))
            };
            if !local.asked.iter().any(same) {
                local.asked.push((face, uv));
                self.add_face(evaluator, face, uv, local);
            }
        }
    }

    /// The ends of edges that lie at a vertex, with their parameters.
    fn ends(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.topology.vertices[vertex as usize].edges.iter().flat_map(move |&edge| {
            let entity = &self.topology.edges[edge as usize];
            (0..2).filter(move |&i| entity.vertices[i] == Some(vertex)).map(move |i| (edge, entity.range[i]))
        })
    }

    /// The curvature of the edges of an edge or a vertex.
    pub(super) fn add_edges(&self, evaluator: &mut impl Evaluate, entity: Entity, t: f64, local: &mut Local) {
        match entity {
            Entity::Edge(edge) => self.add_edge(evaluator, edge, t, local),
            Entity::Vertex(vertex) => {
                let ridges = self.ends(vertex).filter(|&(edge, _)| self.topology.is_ridge(edge));
                ridges.for_each(|(edge, t)| self.add_edge(evaluator, edge, t, local));
            }
            Entity::Face(_) | Entity::Interior => {}
        }
    }

    /// The curvature of an edge along its tangent.
    fn add_edge(&self, evaluator: &mut impl Evaluate, edge: u32, t: f64, local: &mut Local) {
        let [first, last] = self.topology.edges[edge as usize].range;
        let middle = 0.5 * (first + last);
        let mut frame = evaluator.edge_frame(edge, t);
        let typical = norm(evaluator.edge_frame(edge, middle).d1);
        if norm(frame.d1) <= COLLAPSED * typical || !norm(frame.d1).is_finite() {
            // The curve stands still at its end: its frame is taken a little inside.
            local.is_limit = true;
            frame = evaluator.edge_frame(edge, t + NUDGE * (middle - t));
        }
        let (speed, curvature) = (norm(frame.d1), frame.curvature());
        if speed > 0.0 && speed.is_finite() && curvature.is_finite() {
            let tangent = scale(frame.d1, 1.0 / speed);
            local.tangents.push(tangent);
            local.greatest_curvature = local.greatest_curvature.max(curvature);
            local.metric = Some(cut(self.metric_of(local), tangent, self.options.size(curvature)));
        }
    }

    /// The principal curvatures of a face.
    fn add_face(&self, evaluator: &mut impl Evaluate, face: u32, uv: [f64; 2], local: &mut Local) {
        let frame = evaluator.face_frame(face, uv);
        match self.collapsed(evaluator, face, uv, &frame) {
            None => self.add_frame(&frame, local),
            Some(free) => {
                local.is_limit = true;
                let is_pole = frame.normal != [0.0; 3];
                if is_pole {
                    local.normals.push(frame.normal);
                }
                let mut least = self.options.greatest;
                for i in 0..AROUND {
                    let around = (i as f64 + 0.5) / AROUND as f64;
                    let Some(frame) = self.beside(evaluator, face, uv, free, around) else { continue };
                    if is_pole {
                        local.intersect(self.tensor(&frame));
                    }
                    least = least.min(self.options.size(frame.curvatures[0]));
                }
                if !is_pole {
                    // An apex has every direction around it.
                    local.intersect(Sym3::IDENTITY.times(least.powi(-2)));
                }
            }
        }
    }

    /// A face by its frame.
    pub(super) fn add_frame(&self, frame: &SurfaceFrame, local: &mut Local) {
        local.normals.push(frame.normal);
        local.greatest_curvature =
            frame.curvatures.iter().fold(local.greatest_curvature, |most, curvature| curvature.abs().max(most));
        local.intersect(self.tensor(frame));
    }

    /// Sizes 1/(n |κ|) along the principal directions, the smaller of them along the normal.
    fn tensor(&self, frame: &SurfaceFrame) -> Sym3 {
        let [a, b] = frame.curvatures.map(|curvature| self.options.size(curvature));
        Sym3::from_sizes([frame.directions[0], frame.directions[1], frame.normal], [a, b, a.min(b)])
    }

    /// Whether the face collapses at these parameters, and then which parameter has no length.
    fn collapsed(&self, evaluator: &mut impl Evaluate, face: u32, uv: [f64; 2], frame: &SurfaceFrame) -> Option<usize> {
        let entity = &self.topology.faces[face as usize];
        if entity.kind == SurfaceKind::Discrete {
            return None;
        }
        let spans = entity.range.map(|[low, high]| high - low);
        let lengths = [norm(frame.du) * spans[0], norm(frame.dv) * spans[1]];
        let free = usize::from(lengths[1] < lengths[0]);
        if !is_defined(frame) {
            return Some(free);
        }
        if lengths[free] > SUSPICIOUS * lengths[1 - free] {
            return None;
        }
        // A long face is as narrow in its middle; a face that collapses here is not.
        let [low, high] = entity.range[1 - free];
        let mut inside = uv;
        inside[1 - free] = 0.5 * (low + high);
        let there = evaluator.face_frame(face, inside);
        let typical = norm([there.du, there.dv][free]) * spans[free];
        (lengths[free] < COLLAPSED * typical).then_some(free)
    }

    /// The frame beside a pole or an apex: at a share `around` of the parameter that has no length, a little towards the middle of the
    /// other one.
    fn beside(
        &self,
        evaluator: &mut impl Evaluate,
        face: u32,
        uv: [f64; 2],
        free: usize,
        around: f64,
    ) -> Option<SurfaceFrame> {
        let range = self.topology.faces[face as usize].range;
        let other = 1 - free;
        let mut at = uv;
        at[free] = range[free][0] + around * (range[free][1] - range[free][0]);
        let mut step = NUDGE;
        while step < 0.5 {
            at[other] = uv[other] + step * (0.5 * (range[other][0] + range[other][1]) - uv[other]);
            let frame = evaluator.face_frame(face, at);
            if is_defined(&frame) {
                return Some(frame);
            }
            step *= 4.0;
        }
        None
    }
}

/// Whether a frame has a normal and curvatures.
fn is_defined(frame: &SurfaceFrame) -> bool {
    let unit = |v: Vec3| (norm(v) - 1.0).abs() < 1e-6;
    unit(frame.normal) && frame.directions.into_iter().all(unit) && frame.curvatures.iter().all(|k| k.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_is_the_intersection_with_a_slab() {
        let tilted = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
        let metric = Sym3::from_sizes(tilted, [0.2, 3.0, 1.0]);
        for g in [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.6, 0.8, 0.0]] {
            let h = 0.05;
            let found = cut(metric, g, h);
            // What the slab allows in its plane is a metric of hardly any size at all.
            let basis = crate::metric::plane_basis(g);
            let slab = Sym3::from_sizes([g, basis.0, basis.1], [h, 1e5, 1e5]);
            let expected = metric.intersect(&slab);
            assert!(
                (0..6).all(|i| (found.0[i] - expected.0[i]).abs() < 1e-6 * found.trace()),
                "{found:?} {expected:?}"
            );
            assert!((dot(g, found.solve(g)).sqrt() / h - 1.0).abs() < 1e-12, "it reaches to the slab");
        }
        assert_eq!(cut(metric, [0.0, 0.0, 1.0], 1.5), metric, "a slab beyond the ball cuts nothing");
    }
}
