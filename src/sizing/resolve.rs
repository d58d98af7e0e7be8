//! A mesh that resolves the geometry's metric: the given one, with its edges halved where sizes between the ends are not what the ends
//! make of them.
//!
//! Between vertices sizes are nearly linear ([`log_between`]): from an apex with a size of 1e-3 they grow along a unit edge in proportion to the
//! distance, as gradation lets them. What that misses are places that are far from all that is fine, and have no vertex: there edges are
//! halved, and on the boundary the geometry is asked at their middles, until interpolation and growth agree.
use super::feature::Place;
use super::field::{Asked, Found, Sizing};
use crate::geometry::{Entity, Evaluate, Evaluator, Geometry};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::sorted2;
use crate::mesh::bisection::{Halved, bisect};
use crate::mesh::vector::{Vec3, distance, lerp, sub};
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::frame::{Both, Frame, intersect};
use crate::metric::{Limits, Sym3, gradation, log_between};
use crate::tasks::{GRAIN, Team, stage};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// Edges of the boundary are halved down to this share of the greatest size, so that nothing of the surface is overlooked,
const SPACING: f64 = 0.5;
/// or to this share of the longest side of the triangle that they are in.
const FINEST: f64 = 1.0 / 32.0;
/// An edge of no more than so many sizes is short enough whatever the sizes between its ends.
const SHORT: f64 = 4.0;
/// How much finer interpolation may be than what growth allows, in the middle of an edge. (On the wing of the UGAWG's M6 in its far field
/// 2.5 adds a tenth of the vertices that 1.5 adds, and complexities differ by less than what the next mesh brings.)
const WRONG: f64 = 2.5;
/// Most rounds: each halves edges.
const ROUNDS: usize = 32;
/// Most vertices that are added, and so many times those of the mesh: where more are asked for, the metric is too fine for a first mesh, and
/// whoever uses it bounds its complexity.
const MOST: [usize; 2] = [50_000, 2];
/// Vertices a task. Each task makes an evaluator.
const TASK: usize = 1 << 6;

/// The geometry's metric on a mesh that resolves it.
pub struct Resolved {
    /// The mesh with the vertices that were added; none where it resolves the metric itself.
    pub halved: Option<Halved>,
    /// ln M at all vertices, not graded.
    pub logs: Vec<Sym3>,
    /// ln M graded.
    pub graded: Vec<Sym3>,
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

/// Adds vertices until the metric, with its limits, is resolved. It begins with what was found at the vertices of the mesh, and ln M graded.
pub fn resolve(
    team: Team<'_>,
    sizing: &Sizing,
    (at_vertices, mut graded): (&[Found], Vec<Sym3>),
    limits: &Limits,
) -> Resolved {
    let limited = |metric: &Sym3| limits.apply_to_log(&metric.ln());
    let logs = team.map(GRAIN, at_vertices.len(), |v| limited(&at_vertices[v].metric));
    let mut found = Resolved { halved: None, logs, graded: Vec::new() };
    let mut finer = Finer::of(sizing);
    for round in 0.. {
        let mesh = found.mesh(sizing.mesh);
        let around = VertexNeighbours::of_mesh(team, mesh);
        // What is graded stays so: sizes grow with the distance, whatever vertices lie between.
        let added = graded.len();
        graded.extend(&found.logs[added..]);
        gradation::grade_added(team, &mesh.vertices, &around, &mut graded, (sizing.growth.exp(), added));
        if round == ROUNDS {
            break;
        }
        let edges = finer.unresolved(team, sizing, mesh, &around, &graded);
        let places = finer.middles(mesh, &edges);
        let asked: Vec<Sym3> = ask(team, sizing, mesh, &edges, &places).iter().map(limited).collect();
        let wrong = finer.wrong(edges, places, asked);
        if wrong.is_empty() || found.added() + wrong.len() > MOST[0] + MOST[1] * at_vertices.len() {
            break;
        }
        let (edges, places): (Vec<[u32; 2]>, Vec<Middle>) =
            wrong.iter().map(|(edge, place, _)| (*edge, *place)).unzip();
        found.logs.extend(wrong.iter().map(|(.., log)| *log));
        let (mut mesh, mut parents) = match found.halved.take() {
            Some(Halved { mesh, parents }) => (mesh, parents),
            None => (Arc::new(sizing.mesh.clone()), Vec::new()),
        };
        finer.bisect(team, Arc::make_mut(&mut mesh), &edges, &places);
        parents.extend(edges);
        found.halved = Some(Halved { mesh, parents });
        stage("geometry resolved");
    }
    found.graded = graded;
    found
}

/// Where the middle of an edge lies.
#[derive(Clone, Copy)]
struct Middle {
    entity: Entity,
    /// A triangle of the given mesh that it is in.
    triangle: Option<u32>,
}

/// An edge that may be halved.
#[derive(Clone, Copy)]
struct Marked {
    nodes: [u32; 2],
    /// What interpolation makes of its middle and what growth allows there; none where the edge is too long whatever they are.
    means: Option<[Frame; 2]>,
}

/// The graded metric along the edges.
struct Along<'a> {
    mesh: &'a TetMesh,
    around: &'a VertexNeighbours,
    /// ln M, M and M by its eigenvectors at the vertices.
    logs: &'a [Sym3],
    metrics: Vec<Sym3>,
    frames: Vec<Frame>,
    growth: f64,
    greatest: f64,
}

impl<'a> Along<'a> {
    fn of(team: Team<'_>, sizing: &Sizing, mesh: &'a TetMesh, around: &'a VertexNeighbours, logs: &'a [Sym3]) -> Self {
        Self {
            mesh,
            around,
            logs,
            metrics: team.map(GRAIN, logs.len(), |v| logs[v].exp()),
            frames: team.map(GRAIN, logs.len(), |v| Frame::of_log(&logs[v])),
            growth: sizing.growth,
            greatest: sizing.options.greatest,
        }
    }

    /// The edge, if in its middle interpolation is much finer than what its ends and their common neighbours allow.
    fn marked(&self, nodes: [u32; 2]) -> Option<Marked> {
        let [p, q] = nodes.map(|v| v as usize);
        let edge = sub(self.mesh.vertices[q], self.mesh.vertices[p]);
        let lengths = [p, q].map(|v| self.metrics[v].quadratic(edge).sqrt());
        if lengths[0].max(lengths[1]) <= SHORT {
            return None;
        }
        let ends = [&self.logs[p], &self.logs[q]];
        let made = Frame::of_log(&log_between([ends[0], ends[1], ends[0], ends[1]], [0.25; 4]));
        let middle = lerp(self.mesh.vertices[p], self.mesh.vertices[q], 0.5);
        let grown = |v: u32| {
            let from = &self.frames[v as usize];
            let roots = from.grown(sub(middle, self.mesh.vertices[v as usize]), self.growth);
            Frame { roots: roots.map(|root| root.max(1.0 / self.greatest)), ..*from }
        };
        let mut allowed = both(grown(nodes[0]), grown(nodes[1]));
        if !is_finer(&made, &allowed, WRONG) {
            return None;
        }
        let beside = self.around.of_vertex(nodes[1]);
        for &v in self.around.of_vertex(nodes[0]).iter().filter(|v| beside.contains(v)) {
            allowed = both(allowed, grown(v));
        }
        is_finer(&made, &allowed, WRONG).then_some(Marked { nodes, means: Some([made, allowed]) })
    }
}

/// The intersection of two metrics.
fn both(a: Frame, b: Frame) -> Frame {
    match intersect(&a, &b, 1e-3) {
        Both::First => a,
        Both::Second => b,
        Both::New(both) => both,
    }
}

/// Whether a metric is finer than another in some direction, by more than this ratio.
fn is_finer(a: &Frame, than: &Frame, ratio: f64) -> bool {
    !than.relative(a, a.roots).is_below(ratio * ratio)
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
    /// Edges whose middles the geometry was asked at in vain.
    settled: HashSet<[u32; 2]>,
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
            settled: HashSet::new(),
        }
    }

    /// The edges along which the metric may not be resolved, the longest first.
    fn unresolved(
        &self,
        team: Team<'_>,
        sizing: &Sizing,
        mesh: &TetMesh,
        around: &VertexNeighbours,
        logs: &[Sym3],
    ) -> Vec<Marked> {
        let along = Along::of(team, sizing, mesh, around, logs);
        let mut edges = team.collect(TASK, around.len(), |range, edges| {
            for p in range.start as u32..range.end as u32 {
                let marked =
                    |&q: &u32| if p < q && !self.settled.contains(&[p, q]) { along.marked([p, q]) } else { None };
                edges.extend(around.of_vertex(p).iter().filter_map(marked));
            }
        });
        for (nodes, &triangle) in mesh.triangles.nodes.iter().zip(&self.triangles) {
            for i in 0..3 {
                let [a, b] = sorted2([nodes[i], nodes[(i + 1) % 3]]);
                if distance(mesh.vertices[a as usize], mesh.vertices[b as usize]) > self.asked[triangle as usize] {
                    edges.push(Marked { nodes: [a, b], means: None });
                }
            }
        }
        // Of the two entries of an edge that one is long whatever its metric stays.
        edges.sort_by_key(|edge| (edge.nodes, edge.means.is_some()));
        edges.dedup_by_key(|edge| edge.nodes);
        let length = |edge: &Marked| {
            let [p, q] = edge.nodes.map(|v| mesh.vertices[v as usize]);
            distance(p, q)
        };
        edges.sort_by(|a, b| length(b).total_cmp(&length(a)));
        edges
    }

    /// Those of the edges that are to be halved, with where their middles lie and what the geometry asks for there. An edge of the boundary is
    /// left alone where that changes nothing.
    fn wrong(&mut self, edges: Vec<Marked>, places: Vec<Middle>, asked: Vec<Sym3>) -> Vec<([u32; 2], Middle, Sym3)> {
        let mut wrong = Vec::with_capacity(edges.len());
        for ((edge, middle), log) in edges.into_iter().zip(places).zip(asked) {
            let is_wrong = edge.means.is_none_or(|[made, allowed]| {
                let asked = Frame::of_log(&log);
                middle.entity == Entity::Interior
                    || is_finer(&made, &both(allowed, asked), WRONG)
                    || is_finer(&asked, &made, WRONG)
            });
            if is_wrong {
                wrong.push((edge.nodes, middle, log));
            } else {
                self.settled.insert(edge.nodes);
            }
        }
        wrong
    }

    /// Where the middles of these edges lie.
    fn middles(&self, mesh: &TetMesh, edges: &[Marked]) -> Vec<Middle> {
        let mut on: HashMap<[u32; 2], u32> = HashMap::new();
        let is_end = |v: u32| self.is_on_boundary[v as usize];
        let marked: HashSet<[u32; 2]> =
            edges.iter().map(|edge| edge.nodes).filter(|[a, b]| is_end(*a) && is_end(*b)).collect();
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
        let middle = |Marked { nodes: edge, .. }: &Marked| {
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
fn ask(team: Team<'_>, sizing: &Sizing, mesh: &TetMesh, edges: &[Marked], places: &[Middle]) -> Vec<Sym3> {
    team.collect(TASK, edges.len(), |range, found| {
        let (mut evaluator, mut asked) = (sizing.model.evaluator(), Asked::default());
        for i in range {
            let [p, q] = edges[i].nodes.map(|v| mesh.vertices[v as usize]);
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
