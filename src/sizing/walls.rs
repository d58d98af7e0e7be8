//! The walls at the vertices of a mesh: the curved faces of the model along which thin cells of a metric may lie.
use super::tree::Box3;
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry, Model, SurfaceFrame, Topology};
use crate::mesh::vector::{Vec3, dot, norm, scale, sub};
use crate::metric::frame::Frame;
use crate::metric::{Eigen, Sym3};
use crate::tasks::Team;

/// Vertices a task. Each task makes an evaluator.
const VERTICES: usize = 1 << 9;
/// A wall counts at a vertex that is no more than so many of the vertex' own cells away from it. Sizes that grow by a ratio g from an edge to
/// the next are never more than 1/(g − 1) away; thin cells that are much farther (a shock before a nose) do not follow the wall.
const REACH: f64 = 100.0;
/// Walls are looked for so many times as far, since the metric may be scaled afterwards.
const SLACK: f64 = 4.0;
/// The closest point of a face is a foot if this share of the way there at most is across the normal (30°): else the point lies beside the face.
const BESIDE: f64 = 0.5;
/// A wall is hidden by another that is no farther than this share of the way, if both look alike ([`ALIKE`]).
const NEARER: f64 = 0.5;
/// Walls look alike whose normals make 45° at most, one way or the other.
const ALIKE: f64 = 0.7;
/// A share of the model's diagonal: as exact are closest points.
const EXACT: f64 = 1e-9;

/// A wall near a point.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    /// Its unit normal at the foot of the point.
    pub normal: Vec3,
    /// How far the foot is.
    distance: f64,
    /// Principal directions, unit vectors across the normal.
    pub directions: [Vec3; 2],
    /// The radii of curvature along them of the surface through the point that is parallel to the wall; infinite where that is flat. A surface
    /// at the distance s along the normal of one with the curvature κ has the radius |1 − s κ|/|κ|.
    pub radii: [f64; 2],
}

impl Wall {
    /// By the frame of the face at the closest point, which is as exact as this. None where that is no foot, on what is flat, and where there
    /// are no curvatures.
    fn of(frame: &SurfaceFrame, point: Vec3, exact: f64) -> Option<Self> {
        let way = sub(point, frame.point);
        let (distance, along) = (norm(way), dot(way, frame.normal));
        // Past the focal point on a trimmed face 1 − s κ is negative: there the surfaces have no curvature that layers could follow.
        let radii = frame.curvatures.map(|curvature| {
            if curvature == 0.0 { f64::INFINITY } else { (1.0 - along * curvature).max(0.0) / curvature.abs() }
        });
        let is_unit = |v: Vec3| (norm(v) - 1.0).abs() < 1e-6;
        let is_defined = is_unit(frame.normal) && frame.directions.into_iter().all(is_unit);
        let is_curved = radii.iter().all(|radius| !radius.is_nan()) && radii.iter().any(|radius| radius.is_finite());
        let SurfaceFrame { normal, directions, .. } = *frame;
        (is_defined && is_foot(way, frame.normal, exact) && is_curved).then_some(Self {
            normal,
            distance,
            directions,
            radii,
        })
    }

    /// Whether it counts for sizes `across` along its normal.
    pub fn is_near(&self, across: f64) -> bool {
        self.distance <= REACH * across
    }

    /// A wall of these radii through the point itself.
    #[cfg(test)]
    pub fn through(normal: Vec3, directions: [Vec3; 2], radii: [f64; 2]) -> Self {
        Self { normal, distance: 0.0, directions, radii }
    }
}

/// Whether the way from the closest point of a face is along its normal.
fn is_foot(way: Vec3, normal: Vec3, exact: f64) -> bool {
    norm(sub(way, scale(normal, dot(way, normal)))) <= BESIDE * norm(way) + exact
}

/// The walls at each vertex of a mesh.
pub struct Walls {
    /// Those of vertex v are `walls[starts[v]..starts[v + 1]]`.
    starts: Vec<usize>,
    walls: Vec<Wall>,
}

impl Walls {
    /// Those that a metric with these ln M at the vertices, shape (n,), may follow, at any scale near this one.
    pub fn near(team: Team<'_>, place: &Classification, model: &Model, logs: &[Sym3]) -> Self {
        Self::found(team, Search::new(place, model), model, logs)
    }

    /// The same for those alone that a vertex lies on: vertices inside have none.
    pub fn below(team: Team<'_>, place: &Classification, model: &Model, logs: &[Sym3]) -> Self {
        Self::found(team, Search { own_alone: true, ..Search::new(place, model) }, model, logs)
    }

    fn found(team: Team<'_>, search: Search<'_>, model: &Model, logs: &[Sym3]) -> Self {
        let parts = team.chunks(VERTICES, logs.len(), |range| {
            let (mut evaluator, mut found, mut ends) = (model.evaluator(), Vec::new(), Vec::new());
            for v in range {
                search.at(&mut evaluator, v, &logs[v], &mut found);
                ends.push(found.len());
            }
            (found, ends)
        });
        let (mut starts, mut walls) = (vec![0], Vec::new());
        for (found, ends) in parts {
            let before = walls.len();
            starts.extend(ends.into_iter().map(|end| before + end));
            walls.extend(found);
        }
        Self { starts, walls }
    }

    /// Those of a vertex.
    pub fn at(&self, vertex: usize) -> &[Wall] {
        &self.walls[self.starts[vertex]..self.starts[vertex + 1]]
    }
}

/// All that the walls depend on.
struct Search<'a> {
    place: &'a Classification,
    topology: &'a Topology,
    /// The faces that are no planes.
    curved: Vec<u32>,
    /// How exact closest points are.
    exact: f64,
    /// Whether only the faces count that a vertex lies on.
    own_alone: bool,
}

impl<'a> Search<'a> {
    fn new(place: &'a Classification, model: &'a Model) -> Self {
        let topology = model.topology();
        let faces = 0..topology.faces.len() as u32;
        let curved = faces.filter(|&face| !model.is_plane(face)).collect();
        Self { place, topology, curved, exact: EXACT * topology.diagonal(), own_alone: false }
    }

    /// Adds the walls of a vertex.
    fn at(&self, evaluator: &mut Evaluator, vertex: usize, log: &Sym3, found: &mut Vec<Wall>) {
        if self.own_alone && self.place.entities[vertex] == Entity::Interior {
            return;
        }
        let eigen = log.eigen();
        if self.curved.is_empty() || eigen.values[2] - eigen.values[0] < 1e-9 {
            // The same size in all directions is no longer along a wall than across it.
            return;
        }
        let point = self.place.projected[vertex];
        let own = own_faces(self.topology, self.place, evaluator, vertex);
        let reach = Reach::of(&eigen);
        let begin = found.len();
        for &face in &self.curved {
            let uv = match own.iter().find(|own| own.0 == face) {
                Some(own) => Some(own.1),
                None if !self.own_alone && reach.holds(point, &self.topology.faces[face as usize].bounds) => {
                    evaluator.closest_on_face_within(face, point, reach.greatest).map(|on| on.uv)
                }
                None => None,
            };
            let Some(uv) = uv else { continue };
            let mut frame = evaluator.face_frame(face, uv);
            if own.iter().any(|own| own.0 == face) {
                frame.point = point;
            }
            let wall = Wall::of(&frame, point, self.exact);
            found.extend(wall.filter(|wall| wall.distance <= reach.along(wall.normal)));
        }
        let mut at = begin;
        while at < found.len() {
            if self.is_hidden(evaluator, &own, point, &found[at]) {
                found.remove(at);
            } else {
                at += 1;
            }
        }
    }

    /// Whether a wall is behind another one, whose layers lie here.
    fn is_hidden(&self, evaluator: &mut Evaluator, own: &[(u32, [f64; 2])], point: Vec3, wall: &Wall) -> bool {
        let limit = NEARER * wall.distance;
        if limit <= self.exact {
            return false;
        }
        let is_alike = |normal: Vec3| dot(normal, wall.normal).abs() >= ALIKE;
        if own.iter().any(|&(face, uv)| is_alike(evaluator.face_normal(face, uv))) {
            return true;
        }
        (0..).zip(&self.topology.faces).any(|(face, entity)| {
            if own.iter().any(|own| own.0 == face) || away(point, &entity.bounds) >= limit {
                return false;
            }
            let Some(on) = evaluator.closest_on_face_within(face, point, limit) else { return false };
            let (way, normal) = (sub(point, on.point), evaluator.face_normal(face, on.uv));
            is_alike(normal) && is_foot(way, normal, self.exact)
        })
    }
}

/// The faces that a vertex of a mesh lies on, with its parameters there.
pub(super) fn own_faces(
    topology: &Topology,
    place: &Classification,
    evaluator: &mut Evaluator,
    vertex: usize,
) -> Vec<(u32, [f64; 2])> {
    let parameters = place.parameters[vertex];
    let mut own = Vec::new();
    let mut add_beside = |edge: u32, t: f64| {
        for &face in &topology.edges[edge as usize].faces {
            own.extend(evaluator.edge_on_face(edge, t, face).map(|uv| (face, uv)));
        }
    };
    match place.entities[vertex] {
        Entity::Face(face) => own.push((face, parameters)),
        Entity::Edge(edge) => add_beside(edge, parameters[0]),
        Entity::Vertex(vertex) => {
            for &edge in &topology.vertices[vertex as usize].edges {
                let entity = &topology.edges[edge as usize];
                let ends = (0..2).filter(|&i| entity.vertices[i] == Some(vertex));
                ends.for_each(|i| add_beside(edge, entity.range[i]));
            }
        }
        Entity::Interior => {}
    }
    own
}

/// How far a box is.
pub(super) fn away(point: Vec3, [low, high]: &Box3) -> f64 {
    norm(std::array::from_fn(|i| (low[i] - point[i]).max(point[i] - high[i]).max(0.0)))
}

/// How far a wall may be: a length in the metric.
struct Reach {
    metric: Frame,
    /// The farthest in any direction.
    greatest: f64,
}

impl Reach {
    fn of(log: &Eigen) -> Self {
        let metric = Frame { roots: log.values.map(|x| (0.5 * x).exp()), vectors: log.vectors };
        Self { greatest: SLACK * REACH / metric.roots[0], metric }
    }

    /// The reach in a direction.
    fn along(&self, direction: Vec3) -> f64 {
        let Frame { roots, vectors } = &self.metric;
        SLACK * REACH / norm(std::array::from_fn(|i| roots[i] * dot(vectors[i], direction)))
    }

    /// Whether a point of a box may be within it: no eigenvector shows all of the box beyond.
    fn holds(&self, point: Vec3, [low, high]: &Box3) -> bool {
        let (middle, half): (Vec3, Vec3) = (
            std::array::from_fn(|i| 0.5 * (low[i] + high[i]) - point[i]),
            std::array::from_fn(|i| 0.5 * (high[i] - low[i])),
        );
        let Frame { roots, vectors } = &self.metric;
        roots.iter().zip(vectors).all(|(root, axis)| {
            let least = dot(*axis, middle).abs() - dot(axis.map(f64::abs), half);
            least * root <= SLACK * REACH
        })
    }
}
