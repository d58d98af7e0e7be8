//! The mesher's mesh, adapted to the metric of the geometry.
use super::Arguments;
use super::ladder::Meshed;
use crate::adapt::{self, Options};
use crate::cli::Outcome;
use crate::cli::adapt::INTERRUPTED;
use crate::cli::adapt::files;
use crate::cli::adapt::input::Input;
use crate::cli::adapt::progress::{Progress, stop_on_interrupt};
use crate::cli::adapt::report::{Asked, Report};
use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::multiscale::{Bounds, Measure, bounded};
use crate::metric::{Background, Limits, Source, Sym3, field};
use crate::sizing;
use crate::tasks::{Plan, Pool, Team, stage};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// The mesher's mesh is coarse: what the geometry asks for between its vertices shows on the mesh that comes of it.
const CYCLES: usize = 2;

/// Adapts, writes, and prints the table of `adapt`.
pub fn run(
    arguments: &Arguments,
    pool: &Pool,
    (meshed, model): (Meshed, Model),
    asked: &Asked,
    start: Instant,
) -> Outcome {
    let plan = Plan::default();
    let team = Team::new(pool, plan);
    let stop = stop_on_interrupt();
    let named = |error: String| format!("{}: {error}", arguments.model.display());
    let prepared = start.elapsed();
    let input_mesh = Arc::new(meshed.mesh);
    let (mut mesh, mut place) = (Arc::clone(&input_mesh), meshed.place);
    for cycle in 1..=CYCLES {
        let (logs, notice) = sizes(arguments, team, &mesh, &place, &model).map_err(named)?;
        if let Some(notice) = notice.filter(|_| cycle == CYCLES && !arguments.quiet) {
            eprintln!("geo-adapt: note: {notice}");
        }
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let source = Source::Background(Background::on(team, Arc::clone(&mesh), faces, logs));
        stage("geometry");
        let progress = Progress::new(!arguments.quiet, stop.clone());
        let adapted = adapt::adapt(&mesh, &place, &model, &source, &Options::default(), pool, &progress)
            .map_err(|error| named(error.to_string()))?;
        progress.finish();
        if cycle < CYCLES && !progress.interrupted() {
            (mesh, place) = (Arc::new(adapted.extracted.mesh), adapted.extracted.classification);
            continue;
        }
        let finished = start.elapsed();
        let input = Input { mesh: input_mesh, place, model, source, made: None };
        let report = Report::new(team, asked, &input, adapted);
        let times = [prepared, finished, start.elapsed()];
        let report = files::write(asked, arguments.report.as_deref(), report, times)?;
        if !arguments.quiet {
            crate::cli::print(&format!("{:<26} {}\n{}", "mesher", meshed.by, report.text()));
        }
        return Ok(if progress.interrupted() { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS });
    }
    unreachable!("the last cycle returns")
}

/// ln M at the vertices: what the geometry asks for, no more than the complexity allows; and a notice where that is less.
fn sizes(
    arguments: &Arguments,
    team: Team<'_>,
    mesh: &TetMesh,
    place: &Classification,
    model: &Model,
) -> Result<(Vec<Sym3>, Option<String>), String> {
    let options = arguments.sizes.options(model, arguments.limits(), Some(GRADATION));
    let (logs, _) = sizing::geometry_metric(team, mesh, place, model, &options);
    let own = field::complexity_between(team, mesh, &logs);
    let most = arguments.complexity;
    if own <= most {
        return Ok((logs, None));
    }
    let raw = sizing::Options { gradation: None, ..options };
    let (logs, _) = sizing::geometry_metric(team, mesh, place, model, &raw);
    let (gradation, limits) = (options.gradation, Limits::default());
    let bounds = Bounds { complexity: most, measure: Measure::Between, gradation, limits, fixed: None };
    let (logs, _) = bounded(team, mesh, &logs, &bounds).map_err(|error| format!("the geometry's metric: {error}"))?;
    let notice = format!(
        "the geometry asks for a complexity of {own:.0}: its sizes are enlarged to {most} (give a greater --complexity to keep them)"
    );
    Ok((logs, Some(notice)))
}

/// Growth of the sizes from an edge to the next, as elsewhere.
const GRADATION: f64 = 1.5;
