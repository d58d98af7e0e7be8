//! The geometry metric at the vertices of a mesh.
use super::coarse::add_between;
use super::curvature::{Curvature, Local};
use super::estimate::Estimate;
use super::feature::{Gap, Near, Place, Scratch};
use super::options::GRADATION;
use super::resolve::{Resolved, resolve};
use super::{Options, Summary};
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluator, Geometry, Model, Topology};
use crate::mesh::TetMesh;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::metric::{Limits, Sym3, gradation};
use crate::tasks::{GRAIN, Team};

/// Vertices a task. Each task makes an evaluator.
const VERTICES: usize = 1 << 9;

/// Gaps are looked for at one vertex in so many, and again at more.
const STRIDES: [usize; 3] = [64, 8, 1];

/// Sizes of a graded metric may be too small by this factor, where metrics that turn were intersected.
const ROOM: f64 = 1.2;

/// What a thread has in hand.
#[derive(Default)]
pub(super) struct Asked {
    local: Local,
    scratch: Scratch,
}

/// All that the metric at a place depends on.
pub(super) struct Sizing<'a> {
    pub mesh: &'a TetMesh,
    pub place: &'a Classification,
    pub model: &'a Model,
    pub options: &'a Options,
    /// Growth of the sizes with the distance, ln r.
    pub growth: f64,
    curvature: Curvature<'a>,
    body: Option<&'a Body>,
    /// Where the model is the mesh's own surface.
    estimate: Option<Estimate<'a>>,
    near: Option<Near<'a>>,
}

/// Faces that have a greatest size of their own: those of a body in its far field.
pub struct Body {
    /// Whether each face of the model is one of them.
    pub faces: Vec<bool>,
    /// The greatest size on them, model units.
    pub greatest: f64,
}

impl Body {
    /// Whether an entity is on these faces.
    fn has(&self, topology: &Topology, entity: Entity) -> bool {
        let has_edge = |edge: u32| topology.edges[edge as usize].faces.iter().any(|&face| self.faces[face as usize]);
        match entity {
            Entity::Face(face) => self.faces[face as usize],
            Entity::Edge(edge) => has_edge(edge),
            Entity::Vertex(vertex) => topology.vertices[vertex as usize].edges.iter().any(|&edge| has_edge(edge)),
            Entity::Interior => false,
        }
    }
}

/// What is known of a vertex.
#[derive(Clone, Copy)]
pub(super) struct Found {
    /// Not graded.
    pub metric: Sym3,
    gap: Option<Gap>,
    is_limit: bool,
}

/// ln M at the vertices of a mesh, shape (n,), lengths in model units: sizes 1/(n |κ|) along the principal directions of the CAD faces and
/// the tangents of the edges, limited across thin parts and gaps, between `least` and `greatest`; inside and on what is flat the greatest
/// size. Then gradation, along the edges of the tetrahedra, or of the triangles where there are none.
///
/// `place` says where the mesh lies on the model. Coordinates are those of the model: vertices are taken where they were projected.
pub fn geometry_metric(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
    options: &Options,
) -> (Vec<Sym3>, Summary) {
    let sizing = Sizing::new(team, mesh, place, model, options);
    let limits = limits(options);
    let Some(ratio) = options.gradation else {
        let found = sizing.at_vertices(team);
        let mut metrics = team.map(GRAIN, found.len(), |v| found[v].metric);
        let mut summary = summarize(place, &found);
        summary.note_between(add_between(team, &sizing, &mut metrics));
        let logs = team.map(GRAIN, metrics.len(), |v| limits.apply_to_log(&metrics[v].ln()));
        summary.at_least_size = at_least_size(team, options, &logs);
        return (logs, summary);
    };
    let around = VertexNeighbours::of_mesh(team, mesh);
    let (mut found, mut logs) = sizing.graded_at_vertices(team, &around, &limits);
    let mut summary = summarize(place, &found);
    let graded = team.map(GRAIN, logs.len(), |v| logs[v].exp());
    let mut metrics = graded.clone();
    summary.note_between(add_between(team, &sizing, &mut metrics));
    let finer: Vec<u32> = (0..).zip(&metrics).zip(&graded).filter(|((_, a), b)| a != b).map(|((v, _), _)| v).collect();
    finer.iter().map(|&v| v as usize).for_each(|v| logs[v] = limits.apply_to_log(&metrics[v].ln()));
    gradation::grade_again(team, &mesh.vertices, &around, &mut logs, (ratio, &finer));
    finer.iter().map(|&v| v as usize).for_each(|v| found[v].metric = metrics[v]);
    let asked = team.map(GRAIN, logs.len(), |v| limits.apply_to_log(&found[v].metric.ln()));
    summary.at_least_size = at_least_size(team, options, &asked);
    summary.graded = asked.iter().zip(&logs).filter(|(asked, graded)| asked != graded).count();
    // Grown metrics that meet at an angle can leave sizes a little below the least.
    limits.apply(team, &mut logs);
    (logs, summary)
}

/// How many metrics have the least size.
fn at_least_size(team: Team<'_>, options: &Options, logs: &[Sym3]) -> usize {
    let least = -2.0 * options.least.ln() - 1e-9;
    let at_least = |range: std::ops::Range<usize>| range.filter(|&v| logs[v].eigen().values[2] >= least).count();
    team.chunks(GRAIN, logs.len(), at_least).into_iter().sum()
}

/// The same without gradation, on a mesh that resolves it: the given one with vertices added. On the faces of a `body` sizes are no greater than
/// those of it.
pub fn resolved_metric(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
    (options, body): (&Options, Option<&Body>),
) -> Resolved {
    let sizing = Sizing { body, ..Sizing::new(team, mesh, place, model, options) };
    let limits = limits(options);
    let (found, graded) = sizing.graded_at_vertices(team, &VertexNeighbours::of_mesh(team, mesh), &limits);
    resolve(team, &sizing, (&found, graded), &limits)
}

fn limits(options: &Options) -> Limits {
    Limits { hmin: Some(options.least), hmax: Some(options.greatest), aspect_ratio: options.aspect_ratio }
}

fn summarize(place: &Classification, found: &[Found]) -> Summary {
    let mut summary = Summary::default();
    for (entity, found) in place.entities.iter().zip(found) {
        let count = match entity {
            Entity::Vertex(_) => &mut summary.on_vertices,
            Entity::Edge(_) => &mut summary.on_edges,
            Entity::Face(_) => &mut summary.on_faces,
            Entity::Interior => &mut summary.inside,
        };
        *count += 1;
        summary.singular += usize::from(found.is_limit);
        summary.at_gaps += usize::from(found.gap.is_some());
        summary.note(found.gap);
    }
    summary
}

impl<'a> Sizing<'a> {
    fn new(
        team: Team<'_>,
        mesh: &'a TetMesh,
        place: &'a Classification,
        model: &'a Model,
        options: &'a Options,
    ) -> Self {
        let is_discrete = matches!(model, Model::Discrete(_));
        Self {
            mesh,
            place,
            model,
            options,
            growth: options.gradation.unwrap_or(GRADATION).ln(),
            curvature: Curvature::new(options, model.topology()),
            body: None,
            estimate: is_discrete.then(|| Estimate::new(team, mesh, place, model)),
            near: options
                .cells
                .map(|cells| Near::new(team, mesh, place, model, cells, [options.least, options.greatest])),
        }
    }

    fn at_vertices(&self, team: Team<'_>) -> Vec<Found> {
        team.collect(VERTICES, self.mesh.vertices.len(), |range, found| {
            let (mut evaluator, mut asked) = (self.model.evaluator(), Asked::default());
            found.extend(range.map(|v| self.at_vertex(&mut evaluator, v, &mut asked)));
        })
    }

    /// What is asked at the vertices, without the gaps that change nothing once the metric is graded, and ln M graded: most gaps are wider than
    /// the sizes that gradation leaves beside small ones. First the curvature is asked at all vertices, then gaps at more and more of them,
    /// each time as far as the graded metric that is known by then reaches.
    fn graded_at_vertices(
        &self,
        team: Team<'_>,
        around: &VertexNeighbours,
        limits: &Limits,
    ) -> (Vec<Found>, Vec<Sym3>) {
        let count = self.mesh.vertices.len();
        let mut found: Vec<Found> = team.collect(VERTICES, count, |range, found| {
            let (mut evaluator, mut asked) = (self.model.evaluator(), Asked::default());
            found.extend(range.map(|v| {
                let metric = self.curvature_at_vertex(&mut evaluator, v, &mut asked);
                let is_boundary = self.place.entities[v] != Entity::Interior;
                Found { metric, gap: None, is_limit: is_boundary && asked.local.is_limit }
            }));
        });
        let limited = |metric: &Sym3| limits.apply_to_log(&metric.ln());
        let mut graded = team.map(GRAIN, count, |v| limited(&found[v].metric));
        let (vertices, ratio) = (&self.mesh.vertices, self.growth.exp());
        gradation::grade_with(team, vertices, around, &mut graded, ratio);
        let Some(near) = &self.near else { return (found, graded) };
        let mut before: Option<usize> = None;
        for stride in STRIDES {
            let is_next = |&v: &u32| {
                self.place.entities[v as usize] != Entity::Interior
                    && (v as usize).is_multiple_of(stride)
                    && before.is_none_or(|before| !(v as usize).is_multiple_of(before))
            };
            let list: Vec<u32> = (0..count as u32).filter(is_next).collect();
            let limits = team.collect(VERTICES, list.len(), |range, limits| {
                let (mut evaluator, mut asked) = (self.model.evaluator(), Asked::default());
                limits.extend(list[range].iter().map(|&v| {
                    let metric = self.curvature_at_vertex(&mut evaluator, v as usize, &mut asked);
                    let (before, Asked { local, scratch }) = (graded[v as usize].exp(), &mut asked);
                    let (mut known, place) = (before.times(ROOM.powi(-2)), self.place_of(v as usize));
                    let (metric, gap) = near.limit(&mut evaluator, &place, local, metric, &mut known, scratch);
                    (metric, gap.map(|gap| (gap, limited(&before.intersect(&metric)))))
                }));
            });
            let mut finer = Vec::new();
            for (&v, (metric, limit)) in list.iter().zip(limits) {
                found[v as usize].metric = metric;
                if let Some((gap, log)) = limit {
                    found[v as usize].gap = Some(gap);
                    graded[v as usize] = log;
                    finer.push(v);
                }
            }
            gradation::grade_again(team, vertices, around, &mut graded, (ratio, &finer));
            before = Some(stride);
        }
        (found, graded)
    }

    /// The metric of a mesh vertex.
    fn at_vertex(&self, evaluator: &mut Evaluator, vertex: usize, asked: &mut Asked) -> Found {
        let metric = self.curvature_at_vertex(evaluator, vertex, asked);
        if self.place.entities[vertex] == Entity::Interior {
            return Found { metric, gap: None, is_limit: false };
        }
        let (metric, gap) = self.limited(evaluator, &self.place_of(vertex), asked);
        Found { metric, gap, is_limit: asked.local.is_limit }
    }

    /// Where a vertex of the boundary is.
    fn place_of(&self, vertex: usize) -> Place {
        let (point, entity) = (self.place.projected[vertex], self.place.entities[vertex]);
        Place { point, entity, vertex: Some(vertex as u32), triangle: None }
    }

    /// The metric of the curvature at a mesh vertex.
    fn curvature_at_vertex(&self, evaluator: &mut Evaluator, vertex: usize, asked: &mut Asked) -> Sym3 {
        let entity = self.place.entities[vertex];
        let parameters = self.place.parameters[vertex];
        match &self.estimate {
            _ if entity == Entity::Interior => asked.local.clear(),
            None => self.curvature.at(evaluator, entity, parameters, &mut asked.local),
            Some(estimate) => {
                asked.local.clear();
                estimate.add_faces(&self.curvature, vertex, &mut asked.local);
                self.curvature.add_edges(evaluator, entity, parameters[0], &mut asked.local);
            }
        }
        self.metric_of(entity, &asked.local)
    }

    /// The metric so far, on an entity.
    fn metric_of(&self, entity: Entity, local: &Local) -> Sym3 {
        let metric = self.curvature.metric_of(local);
        match self.body {
            Some(body) if body.has(self.model.topology(), entity) => {
                metric.intersect(&Sym3::IDENTITY.times(body.greatest.powi(-2)))
            }
            _ => metric,
        }
    }

    /// The metric at a place between the vertices, and the nearest gap that limits it.
    pub fn metric_at(
        &self,
        evaluator: &mut Evaluator,
        place: &Place,
        parameters: [f64; 2],
        asked: &mut Asked,
    ) -> (Sym3, Option<Gap>) {
        self.curvature.at(evaluator, place.entity, parameters, &mut asked.local);
        self.limited(evaluator, place, asked)
    }

    /// The metric of the curvature, limited across gaps.
    fn limited(&self, evaluator: &mut Evaluator, place: &Place, asked: &mut Asked) -> (Sym3, Option<Gap>) {
        let metric = self.metric_of(place.entity, &asked.local);
        match &self.near {
            Some(near) => near.limit(evaluator, place, &asked.local, metric, &mut { metric }, &mut asked.scratch),
            None => (metric, None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Discrete;
    use crate::mesh::samples::cube;
    use crate::metric::field::complexity_between;

    #[test]
    fn what_gradation_leaves_no_room_for_changes_nothing() {
        // A wedge: a gap from 0.01 to 0.3 across, and flat beside it; then the same bent about an axis, where thin parts limit the chords too.
        let mut mesh = cube(12);
        mesh.vertices.iter_mut().for_each(|p| p[2] *= 0.01 + 0.29 * p[0] * p[0]);
        leaves_no_room(&mesh);
        mesh.vertices.iter_mut().for_each(|p| {
            let ((sin, cos), radius) = (p[0].sin_cos(), 1.0 + p[2]);
            *p = [radius * sin, p[1], radius * cos];
        });
        leaves_no_room(&mesh);
    }

    fn leaves_no_room(mesh: &TetMesh) {
        let (model, place) = Discrete::from_mesh(Team::alone(), mesh, 20.0).unwrap();
        let model = Model::Discrete(model);
        let options = Options { greatest: 0.5, least: 1e-4, gradation: Some(1.5), ..Options::of(model.topology()) };
        let sizing = Sizing::new(Team::alone(), mesh, &place, &model, &options);
        let limits = limits(&options);
        let all: Vec<Sym3> = sizing.at_vertices(Team::alone()).iter().map(|found| found.metric).collect();
        let around = VertexNeighbours::of_mesh(Team::alone(), mesh);
        let (some, graded) = sizing.graded_at_vertices(Team::alone(), &around, &limits);
        let some: Vec<Sym3> = some.iter().map(|found| found.metric).collect();
        assert!(all.iter().zip(&some).filter(|(all, some)| all != some).count() > 10);
        let graded_from = |metrics: &[Sym3]| {
            let mut logs: Vec<Sym3> = metrics.iter().map(|metric| limits.apply_to_log(&metric.ln())).collect();
            gradation::grade(Team::alone(), mesh, &mut logs, 1.5);
            logs
        };
        let of_all = graded_from(&all);
        let complexity = |logs: &[Sym3]| complexity_between(Team::alone(), mesh, logs);
        // Where metrics turn, gradation depends on what it begins with, and on the order in which they were intersected: less so in the first.
        for (of_some, [size, share]) in [(graded_from(&some), [0.1, 0.01]), (graded, [0.2, 0.08])] {
            // Of the mean size.
            let difference = |(a, b): (&Sym3, &Sym3)| (a.trace() - b.trace()).abs() / 6.0;
            let most = of_all.iter().zip(&of_some).map(difference).fold(0.0, f64::max);
            let [a, b] = [&of_all, &of_some].map(|logs| complexity(logs));
            assert!(most < size && (b / a - 1.0).abs() < share, "{most} {b} {a}");
        }
    }
}
