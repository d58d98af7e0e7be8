//! `geo-adapt adapt`.
mod begun;
mod by_parts;
mod chords;
mod drafts;
pub mod field;
pub mod files;
pub mod input;
mod local;
mod meet;
pub mod parts;
pub mod progress;
pub mod report;
mod rounds;
mod scratch;
mod sliced;
mod slices;
mod source;
mod stack;
mod walls;

use super::figures::FigureArguments;
use super::waiting::Waiting;
use super::{Outcome, interrupt};
use crate::adapt::forecast::most_in_memory;
use crate::adapt::{self, Adapted, Criterion, Freeze, Grains, Options, PointCreation, Scheduler, SurfaceBounds};
use crate::formats::check_stack;
use crate::geometry::classify::keeps_references;
use crate::memory;
use crate::metric::Field;
use crate::ranks;
use crate::tasks::{Backend, Plan, Pool, Strategy, Team, simulation_told, stage, threads_to_simulate};
use files::Targets;
use input::{Given, Input, InputArguments, OnModel};
use progress::Progress;
use report::{Asked, Report};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `geo-adapt adapt`.
#[derive(clap::Args)]
#[command(defer(field::only_with_field))]
pub struct Arguments {
    #[command(flatten)]
    pub(super) input: InputArguments,
    /// Where the adapted mesh goes, in any format that `convert` writes; its metric is the field `metric` of the file, or where that holds no
    /// fields (.mesh, .meshb, .su2, .ugrid, OpenFOAM) beside it as .solb
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    #[command(flatten)]
    figures: FigureArguments,
    /// Adapts so many times, each time what came of the last: as so many runs from the written files
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000), allow_negative_numbers = true)]
    cycles: u16,
    /// Criterion of the flips that follow each sweep of insertion
    #[arg(long, value_enum, default_value_t = Criterion::MeanRatio)]
    criterion: Criterion,
    /// Where refinement puts new vertices
    #[arg(long, value_enum, default_value_t = PointCreation::Edge)]
    points: PointCreation,
    /// Surfaces and regions that stay as they are, by reference or name: 3 or surface:3, inlet, region:2
    #[arg(long, value_name = "REF,…", value_delimiter = ',', allow_negative_numbers = true)]
    freeze: Vec<parts::Part>,
    /// Greatest angle in degrees between a boundary triangle and the model: triangles that deviate more are split, whatever the metric
    #[arg(long, value_name = "DEG", value_parser = deviation, allow_negative_numbers = true)]
    normal_deviation: Option<f64>,
    /// Greatest chord error, the distance of boundary triangles from the model: triangles that are farther are split, whatever the metric
    #[arg(long, value_name = "H", value_parser = chord, allow_negative_numbers = true)]
    hausdorff: Option<f64>,
    /// Most vertices: a mesh that has so many gets no more, is finished as it is and written, and the exit code is 3 [default: as many as there
    /// is memory for]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    max_vertices: Option<u32>,
    #[command(flatten, next_help_heading = "Part by part: within little memory, or under mpirun on several processes")]
    parts: by_parts::PartArguments,
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
    /// Items a task of the speculative scheduler: one number, or insertion=N,reconnection=N,…; `geo-adapt tune` finds the best
    #[arg(long, value_name = "GRAIN", default_value_t = Grains::default(), hide_default_value = true)]
    grain: Grains,
}

/// An angle that triangles can be held to.
fn deviation(text: &str) -> Result<f64, String> {
    let angle: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.1..=89.0).contains(&angle) { Ok(angle) } else { Err("an angle from 0.1 to 89 degrees".into()) }
}

/// A distance from the model.
fn chord(text: &str) -> Result<f64, String> {
    let distance: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if distance > 0.0 && distance.is_finite() { Ok(distance) } else { Err("a distance above 0".into()) }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let ranks = ranks::start()?;
    if arguments.parts.memory.is_some() || ranks.count() > 1 {
        return by_parts::run(arguments, &*ranks);
    }
    let start = Instant::now();
    let targets = Targets::of(&mut arguments.input.files()?, &arguments.output, &arguments.figures, &[])?;
    if arguments.cycles > 1 && arguments.input.field.is_of_fields() {
        return Err(
            "--cycles: the fields of --field and --goal lie on the first mesh alone; give one cycle, or a --metric"
                .into(),
        );
    }
    let threads = arguments.threads.map_or_else(super::cores, usize::from);
    let pool = threads_to_simulate().map_or_else(|| Pool::new(threads), |threads| Ok(Pool::simulated(threads)))?;
    pool.prepare(arguments.backend)?;
    let plan = Plan { backend: arguments.backend, strategy: arguments.strategy, ..Plan::default() };
    let team = Team::new(&pool, plan);
    stage("start");
    let asked = arguments.asked(threads);
    let mut notices = Vec::new();
    let mut line = Some(Waiting::for_what("reading the mesh"));
    let mut given = arguments.input.read(team, &mut notices)?;
    check_stack(&arguments.output, &given.stack)?;
    let (mut cad, mut start) = (None, Some(start));
    for cycle in 1..=arguments.cycles {
        let start = start.take().unwrap_or_else(Instant::now);
        let line = line.take();
        let inner = Waiting::for_what("putting the mesh on its model");
        let placed = arguments.input.placed(team, given, cad.take(), &mut notices)?;
        drop((inner, line));
        notices.drain(..).for_each(crate::cli::note);
        // What comes now is worth to be written.
        let stop = progress::finish_on_interrupt();
        let (mut input, drafted) = arguments.input(team, (&pool, plan), placed, stop, &mut notices)?;
        notices.drain(..).for_each(crate::cli::note);
        let prepared = start.elapsed().saturating_sub(drafts::time(&input.on.how.drafts));
        let progress = Progress::new(stop);
        let is_last = cycle == arguments.cycles;
        let adapted = match drafted {
            Some(adapted) => adapted,
            None => arguments.adapted(team, (&pool, plan), &mut input, (&progress, is_last))?,
        };
        let finished = start.elapsed();
        let line = Waiting::for_what("measuring and writing");
        let held = adapted.extracted.part.as_ref().map(|joint| joint.held.clone());
        let mut report = Report::new(&asked, &input.on, adapted, progress.forecast());
        report.rejoin(team, &input.on, held.as_deref())?;
        let (mut report, lost) = targets.write((team, &input.on.model), report, (start, [prepared, finished]))?;
        drop(line);
        stage("written");
        simulation_told().into_iter().for_each(crate::cli::tell);
        lost.iter().for_each(crate::cli::note);
        if arguments.cycles > 1 {
            arguments.figures.say(|| format!("cycle {cycle} of {}\n", arguments.cycles))?;
        }
        arguments.figures.print(&report, || report.text())?;
        if progress.interrupted() {
            return Ok(interrupt::exit_code());
        }
        if report.is_refused() {
            // It is not a mesh for a solver, nor for the next cycle.
            return Ok(ExitCode::from(super::INVALID));
        }
        if let Some(why) = report.why_incomplete() {
            crate::cli::note(format_args!("the mesh stopped growing: {why}"));
            return Ok(ExitCode::from(memory::end::EXIT_CODE));
        }
        let logs = arguments.input.field.metric.is_some().then(|| Field::logs_of(team, &report.metrics));
        let (mesh, stack, names) =
            (std::mem::take(&mut report.mesh), std::mem::take(&mut report.stack), report.names.clone());
        given = Given { mesh, stack, logs, names, fields: Vec::new(), result_crosses: Some(report.crosses()) };
        cad = arguments.input.has_model().then_some(input.on.model);
    }
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// What the report says was asked for.
    fn asked(&self, threads: usize) -> Asked {
        let (input, output) = (self.input.mesh.clone(), self.output.clone());
        Asked { input, output, threads, complexity_wanted: self.input.amount.complexity }
    }

    /// Adapts the mesh of a cycle, again for --vertices where that is needed.
    fn adapted(
        &self,
        team: Team<'_>,
        (pool, plan): (&Pool, Plan),
        input: &mut Input,
        (progress, is_last): (&Progress, bool),
    ) -> Result<Adapted, Box<dyn std::error::Error>> {
        let named = |error| format!("{}: {error}", self.input.mesh.display());
        let freeze = parts::frozen(&self.freeze, &input.on.mesh, &input.on.names).map_err(named)?;
        let options = self.options(plan, freeze);
        progress.tell_forecasts(options.max_vertices, &self.output);
        if !is_last && !options.freeze.surfaces.is_empty() {
            self.check_references(&input.on).map_err(named)?;
        }
        let adapt = |input: &Input| {
            let Input { on: OnModel { mesh, place, model, beside, .. }, source, .. } = input;
            let adapted = match beside {
                Some(beside) => beside.adapt(mesh, place, model, source, &options, pool, progress),
                None => adapt::adapt(mesh, place, model, source, &options, pool, progress),
            };
            progress.finish();
            progress.has_room()?;
            adapted.map_err(|error| named(error.to_string()).into())
        };
        meet::adapted(&self.input, team, input, adapt, || progress.interrupted())
    }

    /// Refuses references that the next cycle or round would not find again: on a CAD model they become the numbers of its faces where they do
    /// not stand for one face each.
    fn check_references(&self, on: &OnModel) -> Result<(), String> {
        if self.input.cad.is_none() || keeps_references(&on.mesh, &on.place) {
            return Ok(());
        }
        Err("its references do not stand for one face each, so the first cycle or part replaces them by others, and --freeze would name other \
             surfaces after it; give it the references of `geo-adapt classify`, or one cycle without --memory"
            .into())
    }

    fn options(&self, plan: Plan, freeze: Freeze) -> Options {
        let scheduler = if self.deterministic { Scheduler::Deterministic } else { self.scheduler };
        let surface = SurfaceBounds { normal_deviation: self.normal_deviation, hausdorff: self.hausdorff };
        let max_vertices = self.max_vertices.map(|most| most as usize).or_else(most_in_memory);
        let Self { criterion, points, grain: grains, .. } = *self;
        Options { criterion, points, scheduler, plan, grains, freeze, surface, max_vertices, is_draft: false }
    }
}
