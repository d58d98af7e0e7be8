//! The command line: one file a subcommand. Parsing, progress and printing; no algorithm lives here.
use crate::tasks::{self, Pool};
use crate::{geometry, memory, ranks};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use terminal::{note, print, say, tell};
use waiting::Waiting;

mod adapt;
mod amount;
mod bootstrap;
mod child;
mod classify;
mod completions;
mod convert;
mod cycle;
mod driven;
mod events;
mod examples;
mod field;
mod figures;
mod files;
mod habits;
mod image_mesh;
mod inspect;
mod interrupt;
mod load;
mod man;
mod metric;
mod model;
mod openfoam;
#[cfg(feature = "serve")]
mod remote;
#[cfg(all(feature = "serve", target_os = "linux"))]
mod serve;
mod su2;
mod surface;
mod table;
mod terminal;
mod transfer;
mod translation;
mod tune;
mod value_enums;
mod view;
mod waiting;
mod walls;
mod workplace;

/// Adapts tetrahedral meshes to a metric, on the real CAD model.
#[derive(Parser)]
#[command(name = "geo-adapt", version, about, max_term_width = 100)]
struct Arguments {
    #[command(flatten, next_help_heading = "Of all commands")]
    how: terminal::How,
    #[cfg(feature = "serve")]
    #[command(flatten)]
    place: remote::Where,
    #[command(subcommand)]
    command: Command,
}

impl Arguments {
    /// The CAD model that this process reads; none where a service reads it, or several processes do.
    fn reads_here(&self) -> Option<&Path> {
        #[cfg(feature = "serve")]
        if self.place.server.is_some() {
            return None;
        }
        self.command.model().filter(|_| !ranks::is_one_of_several())
    }
}

#[derive(Subcommand)]
enum Command {
    /// Adapt a mesh to a metric
    Adapt(adapt::Arguments),
    /// Make the first mesh of a CAD model
    Bootstrap(bootstrap::Arguments),
    /// Put a mesh's boundary on the entities of a CAD model
    Classify(classify::Arguments),
    /// Print a script that completes commands and options in a shell
    Completions(completions::Arguments),
    /// Bring a mesh with its names and fields into the format of another program
    Convert(convert::Arguments),
    /// Adapt and solve in turn, until it is fine enough
    Cycle(cycle::Arguments),
    /// Make and pick fields at vertices
    Field(field::Arguments),
    /// Mesh the regions of a 3D image
    ImageMesh(image_mesh::Arguments),
    /// Check a mesh and measure it in a metric
    Inspect(inspect::Arguments),
    /// Write the manual pages
    Man(man::Arguments),
    /// Make, combine and measure metrics
    Metric(metric::Arguments),
    /// List the entities of a CAD model, name its faces, or write it in another unit
    Model(model::Arguments),
    /// Run a case of OpenFOAM that `cycle` has prepared
    #[command(hide = true)]
    Openfoam(openfoam::Arguments),
    /// Run a configuration of SU2 that `cycle` has prepared
    #[command(hide = true)]
    Su2(su2::Arguments),
    /// Start as one of several processes, meet the others, and end
    #[command(hide = true)]
    Ranks,
    /// Serve models, meshes and jobs over HTTP, with a workbench for the browser
    #[cfg(all(feature = "serve", target_os = "linux"))]
    Serve(serve::Arguments),
    /// Bring fields from one mesh to another
    Transfer(transfer::Arguments),
    /// Measure which back-end, strategy and grain are the fastest on a case
    Tune(tune::Arguments),
    /// Show a mesh: a page for the browser, or a picture
    View(view::Arguments),
}

impl Command {
    /// Whether a service can run it. What is about this machine, or runs a solver here, it cannot.
    #[cfg(feature = "serve")]
    fn may_be_elsewhere(&self) -> bool {
        match self {
            Self::Completions(_) | Self::Man(_) | Self::Ranks | Self::Openfoam(_) | Self::Su2(_) | Self::Tune(_) => {
                false
            }
            #[cfg(target_os = "linux")]
            Self::Serve(_) => false,
            _ => true,
        }
    }

    /// The CAD model that it reads once it has looked at its other inputs.
    fn model(&self) -> Option<&Path> {
        match self {
            Self::Adapt(arguments) => arguments.input.cad.as_deref(),
            Self::Classify(arguments) => arguments.cad.as_deref(),
            Self::Inspect(arguments) => arguments.cad.as_deref(),
            Self::Model(arguments) => Some(&arguments.file),
            _ => None,
        }
    }

    /// What the terminal says while it works, of a command that has no progress of its own.
    fn line(&self) -> Option<Waiting> {
        let what = match self {
            Self::Adapt(_) | Self::Bootstrap(_) | Self::Cycle(_) | Self::Openfoam(_) | Self::Su2(_) | Self::Tune(_) => {
                return None;
            }
            Self::Completions(_) | Self::Man(_) | Self::Ranks => return None,
            #[cfg(all(feature = "serve", target_os = "linux"))]
            Self::Serve(_) => return None,
            Self::Classify(_) => "putting the mesh on the model",
            Self::Convert(_) => "converting",
            Self::Field(_) => "working on fields",
            Self::ImageMesh(_) => "meshing the image",
            Self::Inspect(_) => "checking and measuring the mesh",
            Self::Metric(_) => "working on the metric",
            Self::Model(_) => "listing the model",
            Self::Transfer(_) => "bringing fields to the other mesh",
            Self::View(_) => "drawing",
        };
        Some(Waiting::for_what(what))
    }
}

/// What a subcommand returns: its exit code, or an error that ends the program with code 2.
/// The error is printed as `geo-adapt: error: …` in one piece.
type Outcome = Result<ExitCode, Box<dyn std::error::Error>>;

/// Exit code of bad input.
const BAD_INPUT: u8 = 2;

/// Exit code for a mesh that is not valid, or not on its model.
const INVALID: u8 = 1;

/// Parses the command line, runs the subcommand, prints its error.
pub fn main() -> ExitCode {
    memory::end::take_stack();
    memory::end::take_over_panics();
    memory::end::take_over_aborts();
    geometry::on_memory_end(memory::end::leave_if_ended);
    if let Some(code) = load::child().or_else(bootstrap::domain::child).or_else(bootstrap::heal::child) {
        return code;
    }
    let (words, notices) = match words() {
        Ok(words) => words,
        Err(error) => {
            terminal::error(error);
            return ExitCode::from(BAD_INPUT);
        }
    };
    let all = command();
    let parsed = all.clone().try_get_matches_from(words);
    let parsed = parsed.and_then(|matches| Ok((Arguments::from_arg_matches(&matches)?, matches)));
    let (arguments, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(said) => return usage(&said),
    };
    arguments.how.set();
    notices.iter().for_each(note);
    // A process is forked for it, so this comes before the thread that listens to interrupts. One that comes meanwhile waits: else it would end
    // this program, and the files of the process would stay.
    let held = crate::process::HeldSignals::new();
    let _begun = arguments.reads_here().map(load::Begun::with);
    interrupt::listen();
    drop(held);
    if !matches!(arguments.command, Command::Adapt(_) | Command::Ranks) && ranks::is_one_of_several() {
        terminal::error(
            "several processes were started, and each would do all of the work: `adapt` alone shares it (start this one without mpirun or srun)",
        );
        return ExitCode::from(BAD_INPUT);
    }
    let line = arguments.command.line();
    #[cfg(feature = "serve")]
    if let Some(server) = arguments.place.server.filter(|_| arguments.command.may_be_elsewhere()) {
        let outcome = remote::run(&server, &all, &matches);
        drop(line);
        return ended(outcome);
    }
    #[cfg(not(feature = "serve"))]
    drop((all, matches));
    let outcome = match arguments.command {
        Command::Adapt(arguments) => adapt::run(&arguments),
        Command::Bootstrap(arguments) => bootstrap::run(&arguments),
        Command::Classify(arguments) => classify::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Cycle(arguments) => cycle::run(&arguments),
        Command::Field(arguments) => field::run(&arguments),
        Command::ImageMesh(arguments) => image_mesh::run(&arguments),
        Command::Inspect(arguments) => inspect::run(&arguments),
        Command::Man(arguments) => man::run(&arguments),
        Command::Metric(arguments) => metric::run(&arguments),
        Command::Model(arguments) => model::run(&arguments),
        Command::Openfoam(arguments) => openfoam::run(&arguments),
        Command::Su2(arguments) => su2::run(&arguments),
        Command::Ranks => ranks::start().map(drop).map(|()| ExitCode::SUCCESS).map_err(Into::into),
        #[cfg(all(feature = "serve", target_os = "linux"))]
        Command::Serve(arguments) => serve::run(&arguments),
        Command::Transfer(arguments) => transfer::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        Command::View(arguments) => view::run(&arguments),
    };
    drop(line);
    ended(outcome)
}

/// Prints the error of a command.
fn ended(outcome: Outcome) -> ExitCode {
    outcome.unwrap_or_else(|error| {
        terminal::error(&error);
        ExitCode::from(code_of(&*error))
    })
}

/// All commands with their help.
fn command() -> clap::Command {
    examples::add(Arguments::command())
}

/// The command line, brought into our spelling where it is one of another adapter; and what the user should know of that.
fn words() -> Result<(Vec<OsString>, Vec<String>), String> {
    let mut given = std::env::args_os();
    let program = given.next().unwrap_or_default();
    #[cfg(all(feature = "serve", target_os = "linux"))]
    if let Some(words) = serve::warm::words() {
        return Ok((std::iter::once(program).chain(words).collect(), Vec::new()));
    }
    let mut words: Vec<OsString> = given.collect();
    let mut notices = Vec::new();
    if let Some(translated) = habits::translated(&words) {
        let translated = translated?;
        notices.push(format!("this is `{}`", habits::typed(&translated.words)));
        notices.extend(translated.notices);
        words = translated.words;
    }
    words.insert(0, program);
    Ok((words, notices))
}

/// What is not the input's fault has a code of its own.
fn code_of(error: &(dyn std::error::Error + 'static)) -> u8 {
    let no_threads = matches!(error.downcast_ref(), Some(tasks::Error::Threads { .. }));
    if error.is::<interrupt::Interrupted>() {
        interrupt::EXIT_CODE
    } else if no_threads || error.is::<child::OutOfMemory>() {
        memory::end::EXIT_CODE
    } else {
        BAD_INPUT
    }
}

/// Says what is wrong with the command line, or the help or version that it asks for.
fn usage(said: &clap::Error) -> ExitCode {
    let printed = said.print();
    match terminal::check(printed) {
        Err(error) if !said.use_stderr() => {
            terminal::error(error);
            ExitCode::from(BAD_INPUT)
        }
        _ => ExitCode::from(u8::try_from(said.exit_code()).unwrap_or(BAD_INPUT)),
    }
}

/// How many cores this process may use.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// A thread for each core.
fn pool() -> Result<Pool, tasks::Error> {
    Pool::new(cores())
}

/// Parses a positive number.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("give a positive number".into()),
    }
}
