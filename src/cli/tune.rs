//! `geo-adapt tune`: which back-end, strategy and grain are the fastest, on the user's case and machine.
use super::Outcome;
use super::adapt::input::{Input, InputArguments, OnModel};
use super::figures::FigureArguments;
use super::files::{JSON, Outputs};
use crate::adapt::{self, Grains, Kind, Options, Scheduler, Silent};
use crate::tasks::{Backend, Plan, Pool, Strategy, Team};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;

/// The operations whose tasks have a grain worth measuring.
const OPERATIONS: [Kind; 4] = [Kind::Split, Kind::Reconnect, Kind::Collapse, Kind::Smooth];

/// Arguments of `geo-adapt tune`.
#[derive(clap::Args)]
#[command(defer(super::adapt::field::only_with_field))]
pub struct Arguments {
    #[command(flatten)]
    input: InputArguments,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Items a task that are tried
    #[arg(
        long,
        value_name = "N,…",
        value_delimiter = ',',
        default_value = "1,16,64,128,512,2048",
        allow_negative_numbers = true
    )]
    grains: Vec<Grains>,
    /// Back-ends that are tried [default: all that the program was built with]
    #[arg(long, value_name = "NAME,…", value_enum, value_delimiter = ',')]
    backends: Vec<Backend>,
    /// Strategies that are tried
    #[arg(long, value_name = "NAME,…", value_enum, value_delimiter = ',', default_values_t = Strategy::ALL)]
    strategies: Vec<Strategy>,
    /// Runs of each combination; the fastest counts
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=100), allow_negative_numbers = true)]
    repeat: u16,
    #[command(flatten)]
    figures: FigureArguments,
}

/// The times of one combination, s.
#[derive(Clone, Serialize)]
struct Timing {
    scheduler: Scheduler,
    backend: Backend,
    strategy: Strategy,
    /// None for schedulers whose tasks do not depend on it.
    grain: Option<usize>,
    /// By operation, in the order of [`OPERATIONS`].
    seconds: [f64; OPERATIONS.len()],
    /// Attempts that met another thread.
    conflicts: u64,
}

impl Timing {
    fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }

    fn name(&self) -> String {
        format!("{:<9}{}", self.backend.name(), self.strategy.name())
    }
}

/// What is measured on, and how often.
struct Bench<'b> {
    arguments: &'b Arguments,
    input: &'b Input,
    pool: &'b Pool,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let json = arguments.figures.target(&mut arguments.input.files()?, JSON)?;
    let pool = Pool::new(arguments.threads.map_or_else(super::cores, usize::from))?;
    let backends = match &arguments.backends[..] {
        [] => Backend::ALL.into_iter().filter(|backend| backend.is_built()).collect(),
        some => some.to_vec(),
    };
    backends.iter().try_for_each(|&backend| pool.prepare(backend))?;
    let team = Team::new(&pool, Plan::default());
    let mut notices = Vec::new();
    let given = arguments.input.read(team, &mut notices)?.without_stack(&arguments.input.mesh, "tune")?;
    let input = arguments.input.prepare(team, given, None, &mut notices)?;
    notices.iter().for_each(crate::cli::note);
    let bench = Bench { arguments, input: &input, pool: &pool };
    let reference = bench.measure(Scheduler::Sequential, Plan::default(), None)?;
    let (mut speculative, mut deterministic) = (Vec::new(), Vec::new());
    for backend in backends {
        for &strategy in &arguments.strategies {
            let plan = Plan { backend, strategy, ..Plan::default() };
            deterministic.push(bench.measure(Scheduler::Deterministic, plan, None)?);
            for &grains in &arguments.grains {
                speculative.push(bench.measure(Scheduler::Speculative, plan, Some(grains))?);
            }
        }
    }
    let tables = text(&bench, &reference, &speculative, &deterministic);
    let all: Vec<_> = [reference].into_iter().chain(speculative).chain(deterministic).collect();
    let mut outputs = Outputs::new();
    outputs.json(json.as_ref(), &all)?;
    outputs.commit()?;
    arguments.figures.answer(&all, || tables)?;
    Ok(ExitCode::SUCCESS)
}

impl Bench<'_> {
    /// The least time of each operation over the repetitions.
    fn measure(&self, scheduler: Scheduler, plan: Plan, grains: Option<Grains>) -> Result<Timing, String> {
        let grain = grains.map(|grains| grains.of(OPERATIONS[0]));
        let Plan { backend, strategy, .. } = plan;
        let mut best = Timing { scheduler, backend, strategy, grain, seconds: [f64::INFINITY; 4], conflicts: u64::MAX };
        let Input { on: OnModel { mesh, place, model, .. }, source, .. } = self.input;
        let options = Options { scheduler, plan, grains: grains.unwrap_or_default(), ..Options::default() };
        for _ in 0..self.arguments.repeat {
            let adapted = adapt::adapt(mesh, place, model, source, &options, self.pool, &Silent)
                .map_err(|error| format!("{}: {error}", self.arguments.input.mesh.display()))?;
            for (least, kind) in best.seconds.iter_mut().zip(OPERATIONS) {
                *least = least.min(adapted.work[kind as usize].time.as_secs_f64());
            }
            let conflicts =
                adapted.work.iter().map(|work| work.counts.refused[adapt::Refusal::Conflict as usize]).sum();
            best.conflicts = best.conflicts.min(conflicts);
        }
        if !super::terminal::is_quiet() {
            let grain = grain.map(|grain| format!(", {grain} items a task")).unwrap_or_default();
            let (scheduler, name, seconds) = (scheduler.name(), best.name(), best.total());
            super::tell(format_args!("geo-adapt: {scheduler} {name}{grain}: {seconds:.2} s"));
        }
        Ok(best)
    }
}

/// The tables, and what follows from them.
fn text(bench: &Bench<'_>, reference: &Timing, speculative: &[Timing], deterministic: &[Timing]) -> String {
    let mut text = String::new();
    let threads = bench.pool.threads();
    let _ = writeln!(
        text,
        "Seconds on {threads} threads, the fastest of {} runs each; * marks the best.",
        bench.arguments.repeat
    );
    let mut grains = Grains::default();
    for (index, kind) in OPERATIONS.into_iter().enumerate() {
        let best = least(speculative, |timing| timing.seconds[index]);
        grains.set(kind, best.grain.unwrap_or(1));
        let _ = writeln!(text, "\n{}, sequentially {:.3}; by items a task:", kind.name(), reference.seconds[index]);
        rows(&mut text, speculative, best, |timing| timing.seconds[index]);
    }
    let best = least(speculative, Timing::total);
    let _ = writeln!(text, "\nall four, sequentially {:.3}; by items a task:", reference.total());
    rows(&mut text, speculative, best, Timing::total);
    let steady = least(deterministic, Timing::total);
    let _ = writeln!(text, "\nthe deterministic scheduler, whose parts do not depend on this:");
    for timing in deterministic {
        let mark = if std::ptr::eq(timing, steady) { "*" } else { "" };
        let _ = writeln!(text, "{:<24}{:>9.3}{mark}", timing.name(), timing.total());
    }
    let flags = |timing: &Timing| format!("--backend {} --strategy {}", timing.backend.name(), timing.strategy.name());
    let _ = writeln!(text, "\nbest, the same mesh each time: --deterministic {}", flags(steady));
    let _ = writeln!(text, "best, another mesh each time:  --scheduler speculative {} --grain {grains}", flags(best));
    text
}

/// A row for each back-end and strategy, a column for each grain.
fn rows(text: &mut String, timings: &[Timing], best: &Timing, seconds: impl Fn(&Timing) -> f64) {
    let of_first = |timing: &&Timing| timing.name() == timings[0].name();
    let columns: String =
        timings.iter().take_while(of_first).map(|t| format!("{:>10}", t.grain.unwrap_or(1))).collect();
    let _ = writeln!(text, "{:<23}{columns}", "");
    for row in timings.chunk_by(|a, b| a.name() == b.name()) {
        let _ = write!(text, "{:<23}", row[0].name());
        for timing in row {
            let mark = if std::ptr::eq(timing, best) { "*" } else { "" };
            let _ = write!(text, "{:>10}", format!("{:.3}{mark}", seconds(timing)));
        }
        text.push('\n');
    }
}

fn least(timings: &[Timing], seconds: impl Fn(&Timing) -> f64) -> &Timing {
    timings.iter().min_by(|a, b| seconds(a).total_cmp(&seconds(b))).expect("at least one was measured")
}
