//! `geo-adapt openfoam`: runs a case that `geo-adapt cycle` has prepared.
use super::{Outcome, print};
use crate::cycle::solver::openfoam::drive::drive;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt openfoam`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The case: the folder with plan.json
    case: PathBuf,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let outcome = drive(&arguments.case, &mut |line| print(&format!("{line}\n")))?;
    let ended = if outcome.still { "stands still" } else { "has used up its steps" };
    print(&format!("{ended} after {} steps, {} blocks repeated\n", outcome.steps, outcome.repeated));
    Ok(ExitCode::SUCCESS)
}
