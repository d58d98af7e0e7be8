//! `geo-adapt su2`: runs a configuration of SU2 that `geo-adapt cycle` has prepared.
use super::driven::driven;
use super::{Outcome, print};
use crate::cycle::solver::su2::drive;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt su2`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The folder with plan.json
    folder: PathBuf,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let outcome = driven(|stop, tell| drive::drive(&arguments.folder, stop, tell))?;
    print(&format!("{} iterations, diverged {} times\n", outcome.iterations, outcome.diverged))?;
    Ok(ExitCode::SUCCESS)
}
