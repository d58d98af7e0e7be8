//! `geo-adapt cycle`: the loop of solver and adaptation.
mod check;
mod plan;
mod progress;

use super::child::OutOfMemory;
use super::table::figure;
use super::terminal::is_quiet;
use super::{Outcome, interrupt, print};
use crate::cycle::{self, Error, Loaded, Options, Solvers, example};
use progress::Progress;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `geo-adapt cycle`.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["config", "example"])))]
pub struct Arguments {
    /// The configuration: .toml. The same command goes on where a loop was ended, also by a kill
    #[arg(value_name = "CONFIG.toml")]
    config: Option<PathBuf>,
    /// Print a configuration to begin with, of this solver
    #[arg(long, value_name = "SOLVER", value_parser = clap::builder::PossibleValuesParser::new(example::ALL.map(|(name, _)| name)))]
    example: Option<String>,
    /// Throw away what is in the loop's folder and begin anew
    #[arg(long, requires = "config")]
    restart: bool,
    /// Say what would be done, and do nothing
    #[arg(long, requires = "config")]
    dry_run: bool,
    /// Threads, instead of what the configuration says [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// The configuration is somebody else's: it may use the analytic solver and those of this file, and name no folder
    #[arg(long, value_name = "SOLVERS.toml", requires = "config")]
    confined: Option<PathBuf>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    if let Some(text) = arguments.example.as_deref().and_then(example::of) {
        print(text)?;
        return Ok(ExitCode::SUCCESS);
    }
    let Some(path) = &arguments.config else { return Err("give a configuration".into()) };
    let mut loaded = match &arguments.confined {
        Some(solvers) => Loaded::read_confined(path, &Solvers::read(solvers)?)?,
        None => Loaded::read(path)?,
    };
    loaded.config.threads = arguments.threads.or(loaded.config.threads);
    check::words(&loaded)?;
    let threads = loaded.config.threads.map_or_else(super::cores, usize::from);
    let options = Options { threads, restart: arguments.restart };
    if arguments.dry_run {
        print(&plan::text(&loaded, &options)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::finish_on(
        "ends after this step (again: ends it at once); the same command goes on after the last finished step",
    );
    let progress = Progress::new(!is_quiet(), &loaded.config.schedule);
    let ended = cycle::run(&loaded, &options, &progress, interrupt::stop());
    let printed = progress.finish();
    match ended {
        Ok(ended) => {
            printed?;
            if !is_quiet() {
                let seconds: f64 = ended.history.cycles.iter().flat_map(|cycle| cycle.seconds.values()).sum();
                print(&format!(
                    "{}: ended after {} s of work\n",
                    ended.reason,
                    figure(seconds + ended.history.start_seconds)
                ))?;
                // Who sent the configuration has its folder elsewhere.
                let base = arguments.confined.as_ref().map(|_| loaded.base.as_path());
                let shown = |path: &Path| {
                    let inside = base.and_then(|base| path.strip_prefix(base).ok());
                    inside.unwrap_or(path).display().to_string()
                };
                let rows: Vec<String> =
                    ended.files.iter().map(|(what, path)| format!("{what:<14} {}\n", shown(path))).collect();
                print(&rows.concat())?;
            }
            Ok(ExitCode::SUCCESS)
        }
        // That was told when it was asked for.
        Err(Error::Interrupted) => Ok(interrupt::exit_code()),
        Err(Error::OutOfMemory(message)) => Err(OutOfMemory(message).into()),
        Err(error) => Err(error.into()),
    }
}
