//! The adapter as a function: mesh, place, metric in; mesh, place, metric, report out.
use crate::adapt::coarsen;
use crate::adapt::core::context::Context;
use crate::adapt::core::fill::{self, Filled};
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::required::{Freeze, Required};
use crate::adapt::extract::{self, Extracted, References};
use crate::adapt::operations::insertion::centroid::PointCreation;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::passes::pipeline::{Effort, GrowthEnd, Pipeline};
use crate::adapt::schedule::work::{KINDS, Observer, Work};
use crate::adapt::schedule::{Execution, Grains, Scheduler};
use crate::adapt::surface::bounds::SurfaceBounds;
use crate::geometry::classify::Classification;
use crate::geometry::discrete::outward_triangles;
use crate::geometry::{Geometry, Model};
use crate::mesh::TetMesh;
use crate::metric::Source;
use crate::tasks::{Plan, Pool, Team, stage};
use std::collections::HashMap;
use std::time::Duration;

/// How to adapt.
#[derive(Clone, Debug)]
pub struct Options {
    /// Criterion of the flips that follow each sweep of insertion.
    pub criterion: Criterion,
    /// Where refinement puts new vertices.
    pub points: PointCreation,
    /// How the threads share the work.
    pub scheduler: Scheduler,
    /// Who runs their tasks, and how they are made.
    pub plan: Plan,
    /// Items a task, by kind of operation.
    pub grains: Grains,
    /// What must not change.
    pub freeze: Freeze,
    /// How far surface triangles may deviate from the model.
    pub surface: SurfaceBounds,
    /// Most vertices: a mesh that has so many gets no more.
    pub max_vertices: Option<usize>,
    /// Whether the mesh is only a draft, that the next metric is asked for on: its shapes need not be the best.
    pub is_draft: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            criterion: Criterion::MeanRatio,
            points: PointCreation::default(),
            scheduler: Scheduler::default(),
            plan: Plan::default(),
            grains: Grains::default(),
            freeze: Freeze::default(),
            surface: SurfaceBounds::default(),
            max_vertices: None,
            is_draft: false,
        }
    }
}

/// What came of it.
pub struct Adapted {
    /// The mesh with its classification and metric.
    pub extracted: Extracted,
    /// Time and counts by operation, in the order of [`super::Kind`].
    pub work: [Work; KINDS],
    /// Why the mesh stopped growing before its metric was met; none where it was met.
    pub growth_end: Option<GrowthEnd>,
    /// Bad tetrahedra that repair left untried, since there were too many of them.
    pub unrepaired: usize,
    /// Surface triangles that deviate from the model by more than the bounds that were given.
    pub deviating: usize,
    /// Time in the model's evaluators during the passes, of all threads together.
    pub geometry: Duration,
}

/// Adapts a classified mesh to the metric of `source`, on `model`. The boundary triangles are complete
/// ([`crate::geometry::Discrete`]'s `complete_boundary` adds missing ones).
///
/// # Errors
/// When the mesh is no valid tetrahedral mesh, or its metric asks for sizes that cannot be computed with.
pub fn adapt(
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
    source: &Source,
    options: &Options,
    pool: &Pool,
    observer: &dyn Observer,
) -> Result<Adapted, fill::Error> {
    let required = Required::of(mesh, &options.freeze);
    let place = &*required.held(mesh, place);
    let team = Team::new(pool, options.plan);
    source.check(team, mesh)?;
    let (Filled { store, unprojected, ids }, crowded) = filled(team, mesh, place, source, &required)?;
    stage("store filled");
    let mut context = Context::new(store, source, model);
    context.required = required;
    context.required.renumber(&ids);
    context.ids = ids;
    let mut pipeline = Pipeline::new(
        &mut context,
        Execution { pool, scheduler: options.scheduler, plan: options.plan, grains: options.grains },
        observer,
        options.criterion,
        unprojected,
    );
    pipeline.points = options.points;
    pipeline.crowded = crowded;
    pipeline.surface = options.surface;
    pipeline.max_vertices = options.max_vertices.unwrap_or(usize::MAX);
    pipeline.effort = if options.is_draft { Effort::DRAFT } else { Effort::FULL };
    pipeline.run();
    if pipeline.torn {
        return Err(fill::Error::Torn);
    }
    let (work, unprojected, growth_end) =
        (pipeline.work, std::mem::take(&mut pipeline.unprojected), pipeline.growth_end);
    let unrepaired = pipeline.unrepaired;
    let geometry = pipeline.states.iter().map(|state| state.evaluator.spent).sum();
    let deviating = pipeline.deviating();
    drop(pipeline);
    context.store.trim();
    stage("passes");
    let refs = References {
        faces: face_refs(mesh, place, model),
        inward: inward_faces(team, mesh, place, model),
        edges: edge_refs(mesh, place, model),
    };
    let extracted = extract::extract(team, &context, mesh, &refs, &unprojected);
    stage("extracted");
    Ok(Adapted { extracted, work, growth_end, unrepaired, deviating, geometry })
}

/// The mesh in a store, coarsened first where it has far too many vertices. Returns whether it had.
fn filled(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    source: &Source,
    required: &Required,
) -> Result<(Filled, bool), fill::Error> {
    let coarse = coarsen::coarsened(team, mesh, place, source, required);
    if let Some(coarse) = &coarse
        && let Ok(mut filled) =
            fill::fill_known(team, &coarse.mesh, &coarse.place, source, Some(&coarse.logs), Some(&coarse.hints))
    {
        let mut ids = vec![VertexId::NONE; mesh.vertices.len()];
        coarse.origin.iter().zip(&filled.ids).for_each(|(&old, &id)| ids[old as usize] = id);
        filled.ids = ids;
        return Ok((filled, true));
    }
    // Faults of the mesh are told with the numbers of the input.
    Ok((fill::fill(team, mesh, place, source)?, coarse.is_some()))
}

/// The reference of each model face: that of its first triangle.
fn face_refs(mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<i32> {
    let mut refs: Vec<Option<i32>> = vec![None; model.topology().faces.len()];
    for (&face, &reference) in place.faces.iter().zip(&mesh.triangles.refs) {
        refs[face as usize].get_or_insert(reference);
    }
    refs.iter().enumerate().map(|(face, reference)| reference.unwrap_or(face as i32 + 1)).collect()
}

/// Whether most triangles of a face look into the domain, for each face. In the files of some programs all do.
fn inward_faces(team: Team<'_>, mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<bool> {
    let mut outward = vec![0i64; model.topology().faces.len()];
    for ((given, turned), &face) in mesh.triangles.nodes.iter().zip(outward_triangles(team, mesh)).zip(&place.faces) {
        outward[face as usize] += if *given == turned { 1 } else { -1 };
    }
    outward.into_iter().map(|balance| balance < 0).collect()
}

/// The reference of each model edge: that of its first listed mesh edge.
fn edge_refs(mesh: &TetMesh, place: &Classification, model: &Model) -> Vec<i32> {
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let listed: HashMap<[u32; 2], i32> = mesh.edges.iter().map(|(nodes, r)| (sorted(nodes), r)).collect();
    let mut refs: Vec<Option<i32>> = vec![None; model.topology().edges.len()];
    for &(nodes, edge) in &place.ridges {
        if let (slot @ None, Some(&reference)) = (&mut refs[edge as usize], listed.get(&sorted(nodes))) {
            *slot = Some(reference);
        }
    }
    refs.iter().enumerate().map(|(edge, reference)| reference.unwrap_or(edge as i32 + 1)).collect()
}
