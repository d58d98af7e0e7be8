//! `adapt --memory`, and `mpirun geo-adapt adapt`: part by part ([`crate::decomposition`]).
use super::input::{Error, Input};
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
use crate::decomposition::{self, Adapted, Common, Shelf, Sizes, wanted_vertices};
use crate::memory;
use crate::metric::statistics::Statistics;
use crate::ranks::{Ranks, agree};
use crate::tasks::{Plan, Pool, Team, stage};
use std::hash::{DefaultHasher, Hash, Hasher};
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
fn agreed<T>(ranks: &dyn Ranks, own: Result<T, Error>) -> Result<T, Error> {
    match ranks.count() {
        1 => own,
        _ => Ok(agree(ranks, own.map_err(|error| error.to_string()))?),
    }
}

fn adapted(arguments: &Arguments, ranks: &dyn Ranks) -> Outcome {
    let start = Instant::now();
    agreed(ranks, arguments.fits_parts())?;
    let targets = || -> Result<_, Error> {
        Ok(Targets::of(&mut arguments.input.files(), &arguments.output, &arguments.figures, &[])?)
    };
    let targets = agreed(ranks, if ranks.rank() == 0 { targets().map(Some) } else { Ok(None) })?;
    let threads = arguments.threads.map_or_else(crate::cli::cores, usize::from);
    let pool = agreed(ranks, Pool::new(threads).map_err(Error::from))?;
    let plan = Plan { backend: arguments.backend, strategy: arguments.strategy, ..Plan::default() };
    let team = Team::new(&pool, plan);
    stage("start");
    let line = Waiting::for_what("reading the mesh, putting it on its model, and making the metric");
    let mut notices = Vec::new();
    let given = arguments.input.read(team, &mut notices);
    let input = given.and_then(|given| arguments.input.prepare(team, given, None, &mut notices));
    let mut input = agreed(ranks, input)?;
    notices.drain(..).for_each(note);
    drop(line);
    let prepared = start.elapsed();
    let named = |error: String| -> Error { format!("{}: {error}", arguments.input.mesh.display()).into() };
    let freeze = parts::frozen(&arguments.freeze, &input.mesh, &input.names).map_err(named)?;
    if !freeze.surfaces.is_empty() {
        arguments.check_references(&input).map_err(named)?;
    }
    let options = arguments.options(plan, freeze);
    let vertices = wanted_vertices(input.source.complexity(team, &input.mesh)).max(input.mesh.vertices.len() as f64);
    let place = agreed(ranks, arguments.parts.place(&arguments.output, vertices, threads, ranks))?;
    let progress = Progress::new(progress::finish_on_interrupt());
    progress.tell_forecasts(None, &arguments.output);
    let shelf = place.scratch.as_ref().map_or_else(Shelf::in_memory, Scratch::shelf);
    let run = arguments.run_name(&input, &options);
    let common = Common {
        model: &input.model,
        options: &options,
        sizes: arguments.parts.sizes(),
        pool: &pool,
        ranks,
        shelf: &shelf,
        memory: arguments.parts.memory,
        observer: &progress,
    };
    let goes_on = |rounds| note(format_args!("a run that was ended before goes on after round {rounds}"));
    let adapted = decomposition::adapt(common, (&input.mesh, &input.place), &mut input.source, run, goes_on);
    progress.finish();
    agreed(ranks, progress.has_room().map_err(Error::from))?;
    let adapted = adapted.map_err(|error| named(error.to_string()))?;
    let told = Parts::of(&adapted, ranks);
    let result = Ending { arguments, team, progress: &progress, threads, told };
    let code = match targets {
        Some(targets) if place.is_whole => result.in_memory(&input, adapted, &targets, (start, prepared)),
        Some(targets) => result.by_slices(&input, adapted, &targets, ranks, (start, prepared)),
        None if place.is_whole => adapted.give_slices().map_err(Error::from).map(|()| ExitCode::SUCCESS),
        None => slices::help(ranks, &adapted).map(|()| ExitCode::SUCCESS),
    };
    let code = agreed(ranks, code)?;
    if let (Some(scratch), 0) = (place.scratch, ranks.rank()) {
        scratch.remove();
    }
    Ok(code)
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

    /// Where the pieces of a mesh of so many vertices lie.
    fn place(&self, output: &Path, vertices: f64, threads: usize, ranks: &dyn Ranks) -> Result<Place, Error> {
        let is_binary = output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("meshb"));
        let at_work = BYTES_AT_WORK * self.sizes().part.min(vertices) * threads as f64;
        let needed = BYTES_A_VERTEX * vertices / ranks.count() as f64 + at_work;
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
        let scratch = if ranks.rank() == 0 { Scratch::open(folder, vertices)? } else { Scratch::of(folder) };
        Ok(Place { scratch: Some(scratch), is_whole: false })
    }
}

impl Arguments {
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

    /// A name for what is adapted and how.
    fn run_name(&self, input: &Input, options: &Options) -> u64 {
        let mut name = DefaultHasher::new();
        let mesh = &input.mesh;
        bytemuck::cast_slice::<_, u8>(&mesh.vertices).hash(&mut name);
        mesh.tets.nodes.hash(&mut name);
        mesh.tets.refs.hash(&mut name);
        mesh.triangles.nodes.hash(&mut name);
        input.place.entities.hash(&mut name);
        input.place.faces.hash(&mut name);
        let mut hint = 0;
        for &p in &mesh.vertices {
            input.source.log_at(p, &mut hint).0.map(f64::to_bits).hash(&mut name);
        }
        let Options { criterion, points, freeze, surface, .. } = options;
        let how = format!("{criterion:?} {points:?} {freeze:?} {surface:?} {:?}", self.parts.sizes());
        (how, env!("CARGO_PKG_VERSION")).hash(&mut name);
        name.finish()
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
    fn in_memory(&self, input: &Input, adapted: Adapted<'_>, targets: &Targets, from: (Instant, Duration)) -> Outcome {
        let adapted = adapted.into_memory()?;
        let finished = from.0.elapsed();
        let line = Waiting::for_what("measuring and writing");
        let asked = self.arguments.asked(self.threads);
        let mut report = Report::new(self.team, &asked, input, adapted, (self.progress.forecast(), None));
        report.parts = Some(self.told.clone());
        let times = [from.1, finished, from.0.elapsed()];
        let (report, lost) = targets.write(self.team, report, times)?;
        drop(line);
        lost.iter().for_each(note);
        self.told(&report)
    }

    /// The boundary is measured and written in memory, all else by slices, by all ranks.
    fn by_slices(
        &self,
        input: &Input,
        mut adapted: Adapted<'_>,
        targets: &Targets,
        ranks: &dyn Ranks,
        from: (Instant, Duration),
    ) -> Outcome {
        let finished = from.0.elapsed();
        let line = Waiting::for_what("measuring and writing");
        let asked = self.arguments.asked(self.threads);
        let skin = adapted.done().clone().with(adapted.take_skin());
        let mut report =
            Report::new(self.team, &asked, input, skin, (self.progress.forecast(), Some(Statistics::default())));
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
