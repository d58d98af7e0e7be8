//! The adapter as a function: mesh, place, metric in; mesh, place, metric, report out.
use crate::adapt::coarsen;
use crate::adapt::core::context::Context;
use crate::adapt::core::fill::{self, Filled, Known};
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::required::{Freeze, Required};
use crate::adapt::core::store::Torn;
use crate::adapt::extract::{self, Extracted};
use crate::adapt::operations::insertion::centroid::PointCreation;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::passes::pipeline::{Effort, GrowthEnd, Pipeline};
use crate::adapt::references::References;
use crate::adapt::schedule::work::{KINDS, Observer, Work};
use crate::adapt::schedule::{Execution, Grains, Scheduler};
use crate::adapt::surface::bounds::SurfaceBounds;
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::metric::{Source, Sym3};
use crate::tasks::{Plan, Pool, Team, stage};
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
    source.check(Team::new(pool, options.plan), mesh)?;
    adapt_part(mesh, place, None, model, source, options, pool, observer)
}

/// What is known of a part of a larger mesh, beside the part as a mesh. Its boundary faces without a triangle are faces to other parts.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// ln M at its vertices.
    pub logs: &'a [Sym3],
    /// Vertices that must stay: those of the faces to other parts, ascending.
    pub held: &'a [u32],
    /// Triangles that must stay, since another part has them too.
    pub triangles: &'a [u32],
    /// The references of the whole mesh, with all triangles outwards.
    pub refs: &'a References,
    /// How much the passes do.
    pub effort: Effort,
}

/// Adapts a mesh as [`adapt`] does, or a part of a larger one, whose sizes were checked: its faces to other parts and what is held stay as they
/// are, to the bit.
///
/// # Errors
/// As [`adapt`], but for the boundary of a part, which need not be closed by triangles.
#[allow(clippy::too_many_arguments)]
pub fn adapt_part(
    mesh: &TetMesh,
    place: &Classification,
    part: Option<Part<'_>>,
    model: &Model,
    source: &Source,
    options: &Options,
    pool: &Pool,
    observer: &dyn Observer,
) -> Result<Adapted, fill::Error> {
    let mut required = Required::of(mesh, &options.freeze);
    if let Some(part) = part {
        let triangles = part.triangles.iter().map(|&t| mesh.triangles.nodes[t as usize]);
        required.hold(mesh.vertices.len(), part.held, triangles);
    }
    let place = &*required.held(mesh, place);
    let team = Team::new(pool, options.plan);
    let (Filled { store, unprojected, ids }, crowded) = filled(team, mesh, place, part, source, &required)?;
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
    pipeline.effort = match part {
        _ if options.is_draft => Effort::DRAFT,
        part => part.map_or(Effort::FULL, |part| part.effort),
    };
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
    let refs = match part {
        Some(part) => part.refs.clone(),
        None => References::of(team, mesh, place, model),
    };
    let mut extracted =
        extract::extract(team, &context, mesh, &refs, &unprojected).map_err(|Torn| fill::Error::Torn)?;
    if let Some(part) = part {
        extracted.part = Some(extract::part(team, &context, part.held));
    }
    stage("extracted");
    Ok(Adapted { extracted, work, growth_end, unrepaired, deviating, geometry })
}

/// The mesh in a store, coarsened first where it has far too many vertices. Returns whether it had.
fn filled(
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    part: Option<Part<'_>>,
    source: &Source,
    required: &Required,
) -> Result<(Filled, bool), fill::Error> {
    let is_part = part.is_some();
    let logs = part.map(|part| part.logs).or_else(|| source.logs_on(mesh));
    let coarse = coarsen::coarsened(team, mesh, place, source, required, logs);
    if let Some(coarse) = &coarse
        && let Ok(mut filled) =
            fill::fill_known(team, &coarse.mesh, &coarse.place, source, Known { is_part, ..coarse.known() })
    {
        let mut ids = vec![VertexId::NONE; mesh.vertices.len()];
        coarse.origin.iter().zip(&filled.ids).for_each(|(&old, &id)| ids[old as usize] = id);
        filled.ids = ids;
        return Ok((filled, true));
    }
    // Faults of the mesh are told with the numbers of the input.
    let known = Known { logs, hints: None, is_part };
    Ok((fill::fill_known(team, mesh, place, source, known)?, coarse.is_some()))
}
