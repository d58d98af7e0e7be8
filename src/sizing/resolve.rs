//! A mesh that resolves the geometry's metric: the given one, with its edges halved where sizes between the ends are not what the ends
//! make of them.
//!
//! A metric is interpolated along the edges of the mesh that it lies on. On a coarse mesh that is wrong by orders: from an apex with a size
//! of 1e-3, sizes grow along a unit edge as a geometric series and not, as gradation lets them, in proportion to the distance. So edges
//! are halved, and the geometry is asked at their middles, until interpolation and growth agree or the edge is but a few sizes long.
use super::feature::Place;
use super::field::{Asked, Sizing};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::sorted2;
use crate::mesh::bisection::{Halved, bisect};
use crate::mesh::vector::{Vec3, distance, lerp, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::{Limits, Sym3, gradation};
use crate::tasks::{GRAIN, Team, stage};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Edges of the boundary are halved down to this share of the greatest size, so that nothing of the surface is overlooked,
const SPACING: f64 = 0.5;
/// or to this share of the longest side of the triangle that they are in.
const FINEST: f64 = 1.0 / 32.0;
/// An edge of no more than so many sizes is short enough whatever the sizes between its ends.
const SHORT: f64 = 4.0;
/// How much finer interpolation may be than growth from the ends, in the middle of an edge.
const WRONG: f64 = 1.5;
/// A side of a triangle that is so many times as long as one that is halved is halved too.
const LONGER: f64 = 1.45;
/// Most rounds: each halves edges. A size is no less than 1e-16 of the mesh.
const ROUNDS: usize = 64;
/// Most vertices that are added, and so many times those of the mesh: where more are asked for, the metric is too fine for a first mesh, and
/// whoever uses it bounds its complexity.
const MOST: [usize; 2] = [200_000, 2];
/// Fewer vertices than one in so many are few, and as many edges.
const FEW: usize = 100;
/// Vertices a task. Each task makes an evaluator.
const TASK: usize = 1 << 6;

/// The geometry's metric on a mesh that resolves it.
pub struct Resolved {
    /// The mesh with the vertices that were added; none where it resolves the metric itself.
    pub halved: Option<Halved>,
    /// ln M at all vertices, not graded.
    pub logs: Vec<Sym3>,
}

impl Resolved {
    /// The mesh that the metric is on, made from this one.
    pub fn mesh<'a>(&'a self, given: &'a TetMesh) -> &'a TetMesh {
        self.halved.as_ref().map_or(given, |halved| &halved.mesh)
    }

    /// How many vertices were added.
    pub fn added(&self) -> usize {
        self.halved.as_ref().map_or(0, |halved| halved.parents.len())
    }
}

/// Adds vertices until the metric, with its limits, is resolved. `metrics` are those at the vertices of the mesh. The metric that comes
/// back is not graded.
pub fn resolve(team: Team<'_>, sizing: &Sizing, metrics: &[Sym3], limits: &Limits) -> Resolved {
    let limited = |metric: &Sym3| limits.apply_to_log(&metric.ln());
    let logs = team.map(GRAIN, metrics.len(), |v| limited(&metrics[v]));
    let mut found = Resolved { halved: None, logs };
    let mut finer = Finer::of(sizing);
    let mut logs: Vec<Sym3> = Vec::new();
    for _ in 0..ROUNDS {
        let mesh = found.mesh(sizing.mesh);
        let around = VertexNeighbours::of_mesh(team, mesh);
        // Where few vertices were added, what is graded stays so.
        if FEW * (found.logs.len() - logs.len()) > found.logs.len() {
            logs.clear();
        }
        logs.extend(&found.logs[logs.len()..]);
        gradation::grade_with(team, &mesh.vertices, &around, &mut logs, sizing.growth.exp());
        let edges = finer.unresolved(team, sizing, mesh, &around, &logs);
        if edges.is_empty() || found.added() + edges.len() > MOST[0] + MOST[1] * metrics.len() {
            break;
        }
        let places = finer.middles(mesh, &edges);
        found.logs.extend(ask(team, sizing, mesh, &edges, &places).iter().map(limited));
        let (mut mesh, mut parents) = match found.halved.take() {
            Some(Halved { mesh, parents }) => (mesh, parents),
            None => (Arc::new(sizing.mesh.clone()), Vec::new()),
        };
        finer.bisect(team, Arc::make_mut(&mut mesh), &edges, &places);
        parents.extend(edges);
        found.halved = Some(Halved { mesh, parents });
        stage("geometry resolved");
    }
    found
}

/// Adds the longest side of each triangle that has one of these edges, where that is far longer: else halving gets no nearer to an end, as on a
/// side whose thirds see one end each (longest-edge propagation, Rivara 1997).
fn add_longer(mesh: &TetMesh, around: &VertexNeighbours, edges: &mut Vec<[u32; 2]>) {
    let length = |a: u32, b: u32| distance(mesh.vertices[a as usize], mesh.vertices[b as usize]);
    let mut marked: HashSet<[u32; 2]> = edges.iter().copied().collect();
    let mut next = 0;
    while next < edges.len() {
        let [a, b] = edges[next];
        next += 1;
        let least = LONGER * length(a, b);
        let beside_b = around.of_vertex(b);
        for &c in around.of_vertex(a).iter().filter(|c| beside_b.contains(c)) {
            let (to_a, to_b) = (length(a, c), length(b, c));
            let (longest, side) = if to_a > to_b { (to_a, sorted2([a, c])) } else { (to_b, sorted2([b, c])) };
            if longest > least && marked.insert(side) {
                edges.push(side);
            }
        }
    }
}

/// Where the middle of an edge lies.
#[derive(Clone, Copy)]
struct Middle {
    entity: Entity,
    /// A triangle of the given mesh that it is in.
    triangle: Option<u32>,
}

/// What is known of the mesh with its added vertices.
struct Finer {
    /// Whether a vertex is on the boundary.
    is_on_boundary: Vec<bool>,
    /// For each triangle that of the given mesh that it is a part of.
    triangles: Vec<u32>,
    /// The edges on edges of the model.
    ridges: HashMap<[u32; 2], u32>,
    /// How short the sides of each given triangle are made.
    asked: Vec<f64>,
}

impl Finer {
    fn of(sizing: &Sizing) -> Self {
        let (mesh, place) = (sizing.mesh, sizing.place);
        let spacing = SPACING * sizing.options.greatest;
        let asked = mesh.triangles.nodes.iter().map(|nodes| {
            let p = nodes.map(|v| mesh.vertices[v as usize]);
            let longest = (0..3).map(|i| distance(p[i], p[(i + 1) % 3])).fold(0.0, f64::max);
            spacing.max(FINEST * longest)
        });
        Self {
            is_on_boundary: place.entities.iter().map(|&entity| entity != Entity::Interior).collect(),
            triangles: (0..mesh.triangles.len() as u32).collect(),
            ridges: place.ridges.iter().map(|&([a, b], edge)| (sorted2([a, b]), edge)).collect(),
            asked: asked.collect(),
        }
    }

    /// The edges along which the metric is not resolved, the longest first.
    fn unresolved(
        &self,
        team: Team<'_>,
        sizing: &Sizing,
        mesh: &TetMesh,
        around: &VertexNeighbours,
        logs: &[Sym3],
    ) -> Vec<[u32; 2]> {
        let sizes = team.map(GRAIN, logs.len(), |v| (-0.5 * logs[v].eigen().values[2]).exp());
        let metrics = team.map(GRAIN, logs.len(), |v| logs[v].exp());
        let (growth, greatest) = (sizing.growth, sizing.options.greatest);
        let is_wrong = |p: u32, q: u32| {
            let [p, q] = [p as usize, q as usize];
            let edge = sub(mesh.vertices[q], mesh.vertices[p]);
            let length = distance(mesh.vertices[p], mesh.vertices[q]);
            let across = [p, q].map(|v| length / metrics[v].quadratic(edge).sqrt());
            // No edge is longer in a metric than by its least size.
            if length <= SHORT * across[0].min(across[1]) {
                return false;
            }
            let is_finer = |[a, b]: [f64; 2]| {
                let grown = (a.min(b) + 0.5 * growth * length).min(greatest);
                grown > WRONG * (a * b).sqrt()
            };
            is_finer(across) || is_finer([sizes[p], sizes[q]])
        };
        let mut edges = team.collect(TASK, around.len(), |range, edges| {
            for p in range.start as u32..range.end as u32 {
                edges.extend(around.of_vertex(p).iter().filter(|&&q| p < q && is_wrong(p, q)).map(|&q| [p, q]));
            }
        });
        for (nodes, &triangle) in mesh.triangles.nodes.iter().zip(&self.triangles) {
            for i in 0..3 {
                let [a, b] = sorted2([nodes[i], nodes[(i + 1) % 3]]);
                if distance(mesh.vertices[a as usize], mesh.vertices[b as usize]) > self.asked[triangle as usize] {
                    edges.push([a, b]);
                }
            }
        }
        team.sort(&mut edges);
        edges.dedup();
        // What goes on at few places may have no end there.
        if FEW * edges.len() < around.len() {
            add_longer(mesh, around, &mut edges);
        }
        let length = |&[a, b]: &[u32; 2]| distance(mesh.vertices[a as usize], mesh.vertices[b as usize]);
        edges.sort_by(|a, b| length(b).total_cmp(&length(a)));
        edges
    }

    /// Where the middles of these edges lie.
    fn middles(&self, mesh: &TetMesh, edges: &[[u32; 2]]) -> Vec<Middle> {
        let mut on: HashMap<[u32; 2], u32> = HashMap::new();
        let is_end = |v: u32| self.is_on_boundary[v as usize];
        let marked: HashSet<[u32; 2]> = edges.iter().filter(|[a, b]| is_end(*a) && is_end(*b)).copied().collect();
        if !marked.is_empty() {
            for (nodes, &triangle) in mesh.triangles.nodes.iter().zip(&self.triangles) {
                for i in 0..3 {
                    let side = sorted2([nodes[i], nodes[(i + 1) % 3]]);
                    if marked.contains(&side) {
                        on.entry(side).or_insert(triangle);
                    }
                }
            }
        }
        let middle = |edge: &[u32; 2]| {
            let triangle = on.get(edge).copied();
            match (self.ridges.get(edge), triangle) {
                (Some(&ridge), _) => Middle { entity: Entity::Edge(ridge), triangle },
                (None, Some(_)) => Middle { entity: Entity::Face(u32::MAX), triangle },
                (None, None) => Middle { entity: Entity::Interior, triangle },
            }
        };
        edges.iter().map(middle).collect()
    }

    /// Halves these edges, whose middles lie here.
    fn bisect(&mut self, team: Team<'_>, mesh: &mut TetMesh, edges: &[[u32; 2]], places: &[Middle]) {
        let first = mesh.vertices.len() as u32;
        let (_, parents) = bisect(team, mesh, edges);
        self.triangles = parents.iter().map(|&parent| self.triangles[parent as usize]).collect();
        for ((&[a, b], place), middle) in edges.iter().zip(places).zip(first..) {
            self.is_on_boundary.push(place.entity != Entity::Interior);
            if let Some(ridge) = self.ridges.remove(&[a, b]) {
                self.ridges.insert(sorted2([a, middle]), ridge);
                self.ridges.insert(sorted2([b, middle]), ridge);
            }
        }
    }
}

/// The metrics that the geometry asks for in the middles of these edges.
fn ask(team: Team<'_>, sizing: &Sizing, mesh: &TetMesh, edges: &[[u32; 2]], places: &[Middle]) -> Vec<Sym3> {
    team.collect(TASK, edges.len(), |range, found| {
        let (mut evaluator, mut asked) = (sizing.model.evaluator(), Asked::default());
        for i in range {
            let [p, q] = edges[i].map(|v| mesh.vertices[v as usize]);
            found.push(at(sizing, &mut evaluator, lerp(p, q, 0.5), places[i], &mut asked));
        }
    })
}

/// The metric at one of them; the greatest size where the model has no place for it.
fn at(sizing: &Sizing, evaluator: &mut Evaluator, point: Vec3, place: Middle, asked: &mut Asked) -> Sym3 {
    let free = Sym3::IDENTITY.times(sizing.options.greatest.powi(-2));
    let (on, parameters, entity) = match (place.entity, place.triangle) {
        (Entity::Edge(edge), _) => {
            let on = evaluator.closest_on_edge(edge, point, None);
            (on.point, [on.t, 0.0], place.entity)
        }
        (Entity::Face(_), Some(triangle)) => {
            let face = sizing.place.faces[triangle as usize];
            let on = evaluator.closest_on_face(face, point, None);
            (on.point, on.uv, Entity::Face(face))
        }
        _ => return free,
    };
    if !on.iter().all(|x| x.is_finite()) {
        return free;
    }
    let triangle = if entity.dimension() == 2 { place.triangle } else { None };
    let place = Place { point: on, entity, vertex: None, triangle };
    sizing.metric_at(evaluator, &place, parameters, asked).0
}
