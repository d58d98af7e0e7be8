//! The mesher's mesh, adapted to the metric of the geometry.
use super::ladder::Meshed;
use super::{Arguments, domain};
use crate::adapt::{self, Options};
use crate::cli::Outcome;
use crate::cli::adapt::INTERRUPTED;
use crate::cli::adapt::files;
use crate::cli::adapt::input::Input;
use crate::cli::adapt::progress::{Progress, stop_on_interrupt};
use crate::cli::adapt::report::{Asked, Report};
use crate::geometry::classify::Classification;
use crate::geometry::{Geometry, Model};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::multiscale::{Bounds, Measure, bounded};
use crate::metric::{Background, Limits, Source, Sym3, field, grade};
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
        let names = model.names().clone();
        let input = Input { mesh: input_mesh, place, model, source, made: None, names };
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
    let options = arguments.sizes.options(model, arguments.limits(), None);
    let (mut raw, _) = sizing::geometry_metric(team, mesh, place, model, &options);
    if arguments.far_field.is_some() {
        resolve_body(mesh, place, model, &mut raw);
    }
    let mut logs = raw.clone();
    grade(team, mesh, &mut logs, GRADATION);
    let own = field::complexity_between(team, mesh, &logs);
    let most = arguments.complexity;
    if own <= most {
        return Ok((logs, None));
    }
    let (gradation, limits) = (Some(GRADATION), Limits::default());
    let bounds = Bounds { complexity: most, measure: Measure::Between, gradation, limits, fixed: None };
    let (logs, _) = bounded(team, mesh, &raw, &bounds).map_err(|error| format!("the geometry's metric: {error}"))?;
    let notice = format!(
        "the geometry asks for a complexity of {own:.0}: its sizes are enlarged to {most} (give a greater --complexity to keep them)"
    );
    Ok((logs, Some(notice)))
}

/// In a far field the default of the greatest size is none for the body: there it is that of the body alone.
fn resolve_body(mesh: &TetMesh, place: &Classification, model: &Model, logs: &mut [Sym3]) {
    let (faces, diagonal) = domain::body(model);
    let mut is_body = vec![false; model.topology().faces.len()];
    faces.iter().for_each(|&face| is_body[face as usize] = true);
    let size = Sym3::ZERO.plus_identity(-2.0 * (BODY * diagonal).ln());
    let mut done = vec![false; logs.len()];
    for (nodes, _) in mesh.triangles.nodes.iter().zip(&place.faces).filter(|(_, face)| is_body[**face as usize]) {
        for v in nodes.map(|v| v as usize) {
            if !std::mem::replace(&mut done[v], true) {
                logs[v] = logs[v].intersect_logs(&size);
            }
        }
    }
}

/// Greatest size on the body, of its diagonal.
const BODY: f64 = 0.1;

/// Growth of the sizes from an edge to the next, as elsewhere.
const GRADATION: f64 = 1.5;
