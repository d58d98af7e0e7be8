//! `adapt --memory`, and `mpirun geo-adapt adapt`: part by part ([`crate::decomposition`]).
use super::begun::Begun;
use super::input::{Error, OnModel};
use super::progress::{self, Progress};
use super::report::Report;
use super::rounds::Parts;
use super::scratch::Scratch;
use super::{Arguments, Targets, parts, slices};
use crate::adapt::Options;
use crate::cli::amount::bytes;
use crate::cli::terminal;
use crate::cli::waiting::Waiting;
use crate::cli::{BAD_INPUT, INVALID, Outcome, interrupt, note};
use crate::decomposition::{Adapted, Common, Shelf, Sizes, wanted_vertices};
use crate::memory;
use crate::ranks::{Ranks, agree, broadcast};
use crate::tasks::{Plan, Pool, Team, stage};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// How a mesh is adapted part by part.
#[derive(clap::Args)]
pub struct PartArguments {
    /// Adapts the mesh part by part within so much memory (of each process): 4GiB, 500MB. Parts that do not fit lie in a scratch folder. The
    /// result is the same whatever this says; it is another one than without --memory
    #[arg(long, value_name = "SIZE", value_parser = bytes, allow_negative_numbers = true)]
    pub memory: Option<u64>,
    /// Folder for the parts that do not fit into the memory; a killed run that is started again goes on from there [default: beside the
    /// output, with .scratch behind its name]
    #[arg(long, value_name = "DIR", requires = "memory")]
    scratch: Option<PathBuf>,
    /// Vertices of a part; the result depends on it [default: up to 300000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..), allow_negative_numbers = true)]
    part_vertices: Option<u32>,
}

/// Memory for a vertex of a mesh whose pieces and result are in memory, bytes.
const BYTES_A_VERTEX: f64 = 500.0;

/// Memory for a vertex of a metric in blocks, in these and in what the parts of a round take of them, bytes.
const BYTES_OF_GROUND: f64 = 500.0;

/// Memory for a vertex that is being adapted, bytes.
const BYTES_AT_WORK: f64 = 1_200.0;

/// Runs `adapt` part by part. Rank 0 alone speaks.
pub fn run(arguments: &Arguments, ranks: &dyn Ranks) -> Outcome {
    if ranks.rank() > 0 {
        terminal::hush();
    }
    let outcome = adapted(arguments, ranks);
    let Err(error) = outcome else { return outcome };
    if ranks.count() == 1 {
        return Err(error);
    }
    // Rank 0 tells it, before mpirun tells that one has ended.
    if ranks.rank() == 0 {
        terminal::error(error);
    }
    ranks.gather(&[]);
    Ok(ExitCode::from(BAD_INPUT))
}

/// The error of any rank.
pub(super) fn agreed<T>(ranks: &dyn Ranks, own: Result<T, Error>) -> Result<T, Error> {
    match ranks.count() {
        1 => own,
        _ => Ok(agree(ranks, own.map_err(|error| error.to_string()))?),
    }
}

fn adapted(arguments: &Arguments, ranks: &dyn Ranks) -> Outcome {
    let start = Instant::now();
    agreed(ranks, arguments.fits_parts())?;
    let targets = || -> Result<_, Error> {
        Ok(Targets::of(&mut arguments.input.files()?, &arguments.output, &arguments.figures, &[])?)
    };
    let targets = agreed(ranks, if ranks.rank() == 0 { targets().map(Some) } else { Ok(None) })?;
    let threads = arguments.threads.map_or_else(crate::cli::cores, usize::from);
    let pool = agreed(ranks, Pool::new(threads).map_err(Error::from))?;
    let plan = Plan { backend: arguments.backend, strategy: arguments.strategy, ..Plan::default() };
    let team = Team::new(&pool, plan);
    stage("start");
    let line = Waiting::for_what("reading the mesh, putting it on its model, and making the metric");
    let mut notices = Vec::new();
    let (begun, source) = Begun::with(arguments, team, ranks, &mut notices)?;
    notices.drain(..).for_each(note);
    drop(line);
    let prepared = start.elapsed();
    let named = |error: String| -> Error { format!("{}: {error}", arguments.input.mesh.display()).into() };
    let on = &begun.on;
    let freeze = parts::frozen(&arguments.freeze, &on.mesh, &on.names).map_err(named)?;
    if !freeze.surfaces.is_empty() {
        arguments.check_references(on).map_err(named)?;
    }
    let options = arguments.options(plan, freeze);
    let run = begun.name(&arguments.how(&options));
    agreed(ranks, is_same(ranks, run))?;
    let given = on.size[0] as f64;
    let vertices = (wanted_vertices(begun.complexity).max(given), given);
    let place = agreed(ranks, arguments.parts.place(&arguments.output, vertices, threads, ranks))?;
    let is_alone = ranks.count() == 1;
    let stop = if is_alone { progress::finish_on_interrupt() } else { progress::finish_on_interrupt_of_mpirun() };
    let progress = Progress::new(stop);
    progress.tell_forecasts(None, &arguments.output);
    let shelf = place.scratch.as_ref().map_or_else(Shelf::in_memory, Scratch::shelf);
    let common = Common {
        model: &on.model,
        options: &options,
        sizes: arguments.parts.sizes(),
        pool: &pool,
        ranks,
        shelf: &shelf,
        memory: arguments.parts.memory,
        observer: &progress,
    };
    let goes_on = |rounds| note(format_args!("a run that was ended before goes on after round {rounds}"));
    let adapted = begun.adapt(common, source, run, goes_on);
    progress.finish();
    agreed(ranks, progress.has_room().map_err(Error::from))?;
    let adapted = adapted.map_err(|error| named(error.to_string()))?;
    let told = Parts::of(&adapted, ranks);
    let result = Ending { arguments, team, progress: &progress, threads, told };
    let code = match targets {
        Some(targets) if place.is_whole => result.in_memory(on, adapted, &targets, (start, prepared)),
        Some(targets) => result.by_slices(on, adapted, &targets, ranks, (start, prepared)),
        None if place.is_whole => adapted.give_slices().map_err(Error::from).map(|()| ExitCode::SUCCESS),
        None => slices::help(ranks, &adapted).map(|()| ExitCode::SUCCESS),
    };
    let code = agreed(ranks, code)?;
    if let (Some(scratch), 0) = (place.scratch, ranks.rank()) {
        scratch.remove();
    }
    Ok(code)
}

/// Refuses inputs that are not those of rank 0: the result would be of both.
pub(super) fn is_same(ranks: &dyn Ranks, run: u64) -> Result<(), Error> {
    if broadcast(ranks, &run.to_le_bytes()) == run.to_le_bytes() {
        return Ok(());
    }
    Err("its mesh, metric or model is not the one that rank 0 has: let all processes see the same files, and run the same program on machines of one \
         kind".into())
}

/// Where pieces lie, and whether the result is made in memory.
struct Place {
    scratch: Option<Scratch>,
    is_whole: bool,
}

impl PartArguments {
    fn sizes(&self) -> Sizes {
        self.part_vertices.map_or_else(Sizes::default, |vertices| Sizes::of(f64::from(vertices)))
    }

    /// Where the pieces of a mesh of so many vertices lie, which is made of one of so many.
    fn place(
        &self,
        output: &Path,
        (vertices, given): (f64, f64),
        threads: usize,
        ranks: &dyn Ranks,
    ) -> Result<Place, Error> {
        let is_binary = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("meshb"));
        let at_work = BYTES_AT_WORK * self.sizes().part.min(vertices) * threads as f64;
        // The metric of a larger one lies in blocks.
        let ground = if given > self.sizes().part { given } else { 0.0 };
        let needed = (BYTES_A_VERTEX * vertices + BYTES_OF_GROUND * ground) / ranks.count() as f64 + at_work;
        if self.memory.is_none_or(|memory| memory as f64 >= needed) {
            return Ok(Place { scratch: None, is_whole: ranks.count() == 1 || !is_binary });
        }
        if !is_binary {
            return Err(format!(
                "{}: a mesh that does not fit into --memory is written as .meshb alone; give that, and then `geo-adapt convert` on a machine with \
                 {:.0} MB",
                output.display(),
                needed / 1e6
            )
            .into());
        }
        let folder = Scratch::folder(self.scratch.as_deref(), output);
        let scratch = if ranks.rank() == 0 { Scratch::open(folder, vertices, ground)? } else { Scratch::of(folder) };
        Ok(Place { scratch: Some(scratch), is_whole: false })
    }
}

impl Arguments {
    /// Refuses what so many processes, or one with --memory, cannot do.
    ///
    /// # Errors
    /// What, and what to give instead.
    pub fn fits_processes(&self, processes: u32) -> Result<(), Error> {
        if processes > 1 || self.parts.memory.is_some() { self.fits_parts() } else { Ok(()) }
    }

    /// Refuses what cannot be done part by part.
    fn fits_parts(&self) -> Result<(), Error> {
        let refused = [
            (self.cycles > 1, "--cycles: one cycle"),
            (self.input.amount.vertices.is_some(), "--vertices: give a --complexity"),
            (self.max_vertices.is_some(), "--max-vertices: give a --complexity"),
        ];
        match refused.iter().find(|(is_asked, _)| *is_asked) {
            Some((_, what)) => Err(format!("{what} part by part (--memory, or several processes)").into()),
            None => Ok(()),
        }
    }

    /// A name for how it is adapted.
    fn how(&self, options: &Options) -> String {
        let Options { criterion, points, freeze, surface, .. } = options;
        format!(
            "{criterion:?} {points:?} {freeze:?} {surface:?} {:?} {}",
            self.parts.sizes(),
            env!("CARGO_PKG_VERSION")
        )
    }
}

/// What a run has come to.
struct Ending<'a> {
    arguments: &'a Arguments,
    team: Team<'a>,
    progress: &'a Progress,
    threads: usize,
    told: Parts,
}

impl Ending<'_> {
    /// The mesh is put together in memory, measured and written as any other.
    fn in_memory(&self, on: &OnModel, adapted: Adapted<'_>, targets: &Targets, from: (Instant, Duration)) -> Outcome {
        let (adapted, near_cuts) = adapted.into_memory()?;
        let finished = from.0.elapsed();
        let line = Waiting::for_what("measuring and writing");
        let asked = self.arguments.asked(self.threads);
        let mut report = Report::new(&asked, on, adapted, self.progress.forecast());
        let mut told = self.told.clone();
        told.near_cuts = near_cuts;
        report.parts = Some(told);
        let (report, lost) = targets.write((self.team, &on.model), report, (from.0, [from.1, finished]))?;
        drop(line);
        lost.iter().for_each(note);
        self.told(&report)
    }

    /// The boundary is measured and written in memory, all else by slices, by all ranks.
    fn by_slices(
        &self,
        on: &OnModel,
        mut adapted: Adapted<'_>,
        targets: &Targets,
        ranks: &dyn Ranks,
        from: (Instant, Duration),
    ) -> Outcome {
        let finished = from.0.elapsed();
        let line = Waiting::for_what("measuring and writing");
        let asked = self.arguments.asked(self.threads);
        let skin = adapted.done().clone().with(adapted.take_skin());
        let mut report = Report::new(&asked, on, skin, self.progress.forecast());
        report.measure_boundary(self.team, &on.model);
        let mut told = self.told.clone();
        told.boundary_measured = (from.0.elapsed() - finished).as_secs_f64();
        report.parts = Some(told);
        let report = targets.by_slices((self.team, ranks), report, &adapted, (from.0, [from.1, finished]))?;
        drop(line);
        self.told(&report)
    }

    /// Prints the report.
    fn told(&self, report: &Report) -> Outcome {
        stage("written");
        self.arguments.figures.print(report, || report.text())?;
        if self.progress.interrupted() {
            return Ok(interrupt::exit_code());
        }
        if report.is_refused() {
            return Ok(ExitCode::from(INVALID));
        }
        if let Some(why) = report.why_incomplete() {
            note(format_args!("the mesh stopped growing: {why}"));
            return Ok(ExitCode::from(memory::end::EXIT_CODE));
        }
        Ok(ExitCode::SUCCESS)
    }
}
