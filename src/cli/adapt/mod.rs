//! `geo-adapt adapt`.
mod field;
mod files;
mod progress;
mod report;

use super::metric::fields::MultiscaleArguments;
use super::{Outcome, load};
use crate::adapt::{self, Criterion, Options, PointCreation, Scheduler};
use crate::geometry::classify::{self, Classification};
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, complete_matched};
use crate::geometry::{Discrete, Model};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::{TetMesh, io};
use crate::metric::Source;
use crate::metric::field::complexity_factor;
use crate::tasks::{Backend, Plan, Pool, Strategy, Team, stage};
use progress::Progress;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Exit code after an interrupt: 128 + SIGINT, as shells have it. The last valid mesh is written all the same.
const INTERRUPTED: u8 = 130;

/// Twelve tetrahedra for each unit of complexity, numbered with 32 bits; some numbers lie idle.
const GREATEST_COMPLEXITY: f64 = 2e8;

/// Arguments of `geo-adapt adapt`.
#[derive(clap::Args)]
#[command(defer(field::only_with_field))]
pub struct Arguments {
    /// The mesh: .mesh or .meshb
    mesh: PathBuf,
    /// Where the adapted mesh goes; its metric is written beside it as .solb
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// The CAD model the boundary lies on: .step, .stp, .iges, .igs, .brep or .egads. Without it the surface of the input mesh
    #[arg(long, value_name = "MODEL")]
    cad: Option<PathBuf>,
    #[command(flatten)]
    field: field::FieldArguments,
    /// Scale the metric to this complexity: about half the number of vertices
    #[arg(long, value_name = "C", value_parser = super::positive, allow_negative_numbers = true)]
    complexity: Option<f64>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Write what was done as JSON
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// How far a vertex of the input may be from the model, in its units
    #[arg(long, value_name = "T", value_parser = super::positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Criterion of the flips that follow each sweep of insertion
    #[arg(long, value_enum, default_value_t = Criterion::MeanRatio)]
    criterion: Criterion,
    /// Where refinement puts new vertices
    #[arg(long, value_enum, default_value_t = PointCreation::Edge)]
    points: PointCreation,
    /// How the threads share the work
    #[arg(long, value_enum, default_value_t = Scheduler::default())]
    scheduler: Scheduler,
    /// The same mesh bit for bit, whatever the number of threads: --scheduler deterministic
    #[arg(long, conflicts_with = "scheduler")]
    deterministic: bool,
    /// Who runs the tasks of the threads
    #[arg(long, value_enum, default_value_t = Backend::default())]
    backend: Backend,
    /// In which order the tasks are made
    #[arg(long, value_enum, default_value_t = Strategy::default())]
    strategy: Strategy,
    /// No progress and no table; errors only
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten, next_help_heading = "The metric of --field")]
    multiscale: MultiscaleArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    files::check(arguments)?;
    let stop = progress::stop_on_interrupt();
    let threads = arguments.threads.map_or_else(super::cores, usize::from);
    let pool = Pool::new(threads)?;
    pool.prepare(arguments.backend)?;
    let plan = Plan { backend: arguments.backend, strategy: arguments.strategy, ..Plan::default() };
    let team = Team::new(&pool, plan);
    stage("start");
    let mut read = io::read_mesh(&arguments.mesh)?;
    stage("mesh read");
    let faces = MatchedFaces::of(team, &read.content.tets.nodes);
    let added = complete_matched(team, &mut read.content, &faces);
    stage("boundary complete");
    if added > 0 {
        read.notices.push(format!("{added} triangles were missing on the boundary or between regions, and were added"));
    }
    let mesh = Arc::new(read.content);
    let (mut source, made) = field::source(team, arguments, &mesh, faces, &mut read.notices)?;
    stage("metric ready");
    let (model, place) = place(team, arguments, &mesh, &mut read.notices)?;
    stage("classified");
    scale(team, arguments, &mesh, &mut source, made.is_some())?;
    stage("complexity");
    let progress = Progress::new(!arguments.quiet, stop);
    for notice in read.notices.iter().filter(|_| !arguments.quiet) {
        eprintln!("geo-adapt: note: {notice}");
    }
    let prepared = start.elapsed();
    let scheduler = if arguments.deterministic { Scheduler::Deterministic } else { arguments.scheduler };
    let options = Options { criterion: arguments.criterion, points: arguments.points, scheduler, plan };
    let adapted = adapt::adapt(&mesh, &place, &model, &source, &options, &pool, &progress)
        .map_err(|error| format!("{}: {error}", arguments.mesh.display()))?;
    progress.finish();
    let finished = start.elapsed();
    let report = report::Report::new(team, arguments, &mesh, &model, adapted, (threads, made));
    stage("report");
    let report = files::write(arguments, report, [prepared, finished, start.elapsed()])?;
    stage("written");
    if !arguments.quiet {
        super::print(&report.text(arguments));
    }
    Ok(if progress.interrupted() { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

/// Scales the source to the complexity that is asked for, which one that was made for it has; and refuses one that no mesh can have.
fn scale(
    team: Team<'_>,
    arguments: &Arguments,
    mesh: &TetMesh,
    source: &mut Source,
    is_made: bool,
) -> Result<(), String> {
    if arguments.complexity.is_none() && source.complexity_bound(team, mesh) <= GREATEST_COMPLEXITY {
        return Ok(());
    }
    let own = source.complexity(team, mesh);
    if let Some(target) = arguments.complexity.filter(|_| !is_made) {
        source.scale(team, complexity_factor(own, target).ln());
    }
    let complexity = arguments.complexity.unwrap_or(own);
    if complexity <= GREATEST_COMPLEXITY {
        return Ok(());
    }
    let remedy = match arguments.complexity {
        Some(_) => "give a smaller --complexity",
        None => "are mesh and metric in the same units? else give a --complexity",
    };
    let [vertices, most] = [2.0 * complexity, 2.0 * GREATEST_COMPLEXITY];
    Err(format!(
        "{}: the metric asks for about {vertices:.0e} vertices, more than the {most:.0e} of the largest mesh; {remedy}",
        arguments.mesh.display()
    ))
}

/// The model, and where the mesh lies on it.
fn place(
    team: Team<'_>,
    arguments: &Arguments,
    mesh: &TetMesh,
    notices: &mut Vec<String>,
) -> Result<(Model, Classification), Box<dyn std::error::Error>> {
    let name = arguments.mesh.display();
    let Some(path) = &arguments.cad else {
        let (model, place) =
            Discrete::from_mesh(team, mesh, DEFAULT_RIDGE_ANGLE).map_err(|error| format!("{name}: {error}"))?;
        return Ok((Model::Discrete(model), place));
    };
    let model = load::model(path)?;
    let options = classify::Options { tolerance: arguments.tolerance, ..classify::Options::default() };
    let (place, report) = classify::classify(team, mesh, &model, &options)
        .map_err(|error| format!("{name} on {}: {error}", path.display()))?;
    notices.extend(report.notices);
    Ok((model, place))
}
