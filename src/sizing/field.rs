//! The geometry metric at the vertices of a mesh.
use super::coarse::add_between;
use super::curvature::{Curvature, Local};
use super::estimate::Estimate;
use super::feature::{Gap, Near, Place, Scratch};
use super::options::GRADATION;
use super::resolve::{Resolved, resolve};
use super::{Options, Summary};
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluator, Geometry, Model};
use crate::mesh::TetMesh;
use crate::metric::{Limits, Sym3, gradation, restrict};
use crate::tasks::{GRAIN, Team};

/// Vertices a task. Each task makes an evaluator.
const VERTICES: usize = 1 << 9;

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
    /// Where the model is the mesh's own surface.
    estimate: Option<Estimate<'a>>,
    near: Option<Near<'a>>,
}

/// What is known of a vertex.
#[derive(Clone, Copy)]
struct Found {
    metric: Sym3,
    gap: Option<Gap>,
    is_limit: bool,
}

/// ln M at the vertices of a mesh, shape (n,), lengths in model units: sizes 1/(n |κ|) along the principal directions of the CAD faces and
/// the tangents of the edges, limited across thin parts and gaps, between `least` and `greatest`; inside and on what is flat the greatest
/// size. Then gradation, along the edges of the tetrahedra, or of the triangles where there are none, and sizes as large as ln M on this mesh
/// has to have them for the complexity that is asked for ([`restrict`]).
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
    let found = sizing.at_vertices(team);
    let mut metrics = team.map(GRAIN, found.len(), |v| found[v].metric);
    let mut summary = summarize(place, &found);
    let (samples, gap) = add_between(team, &sizing, &mut metrics);
    summary.between = samples;
    summary.note(gap);
    let limits = limits(options);
    let mut logs = team.map(GRAIN, metrics.len(), |v| limits.apply_to_log(&metrics[v].ln()));
    let least = -2.0 * options.least.ln() - 1e-9;
    let at_least = |range: std::ops::Range<usize>| range.filter(|&v| logs[v].eigen().values[2] >= least).count();
    summary.at_least_size = team.chunks(GRAIN, logs.len(), at_least).into_iter().sum();
    if let Some(ratio) = options.gradation {
        summary.graded = gradation::grade(team, mesh, &mut logs, ratio).changed;
        // Grown metrics that meet at an angle can leave sizes a little below the least.
        limits.apply(team, &mut logs);
        summary.enlarged = restrict(team, mesh, &mut logs, ratio);
    }
    (logs, summary)
}

/// The same without gradation, on a mesh that resolves it: the given one with vertices added.
pub fn resolved_metric(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
    options: &Options,
) -> Resolved {
    let sizing = Sizing::new(team, mesh, place, model, options);
    let found = sizing.at_vertices(team);
    let metrics = team.map(GRAIN, found.len(), |v| found[v].metric);
    resolve(team, &sizing, &metrics, &limits(options))
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

    /// The metric of a mesh vertex.
    fn at_vertex(&self, evaluator: &mut Evaluator, vertex: usize, asked: &mut Asked) -> Found {
        let entity = self.place.entities[vertex];
        let parameters = self.place.parameters[vertex];
        if entity == Entity::Interior {
            asked.local.clear();
            return Found { metric: self.curvature.metric_of(&asked.local), gap: None, is_limit: false };
        }
        match &self.estimate {
            None => self.curvature.at(evaluator, entity, parameters, &mut asked.local),
            Some(estimate) => {
                asked.local.clear();
                estimate.add_faces(&self.curvature, vertex, &mut asked.local);
                self.curvature.add_edges(evaluator, entity, parameters[0], &mut asked.local);
            }
        }
        let point = self.place.projected[vertex];
        let place = Place { point, entity, vertex: Some(vertex as u32), triangle: None };
        let (metric, gap) = self.limited(evaluator, &place, asked);
        Found { metric, gap, is_limit: asked.local.is_limit }
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
        let metric = self.curvature.metric_of(&asked.local);
        match &self.near {
            Some(near) => near.limit(evaluator, place, &asked.local, metric, &mut asked.scratch),
            None => (metric, None),
        }
    }
}
