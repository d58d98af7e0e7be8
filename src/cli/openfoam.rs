//! `geo-adapt openfoam`: runs a case that `geo-adapt cycle` has prepared.
use super::driven::driven;
use super::{Outcome, print};
use crate::cycle::solver::openfoam::drive;
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
    let outcome = driven(|stop, tell| drive::drive(&arguments.case, stop, tell))?;
    let ended = if outcome.still { "stands still" } else { "has used up its steps" };
    let drive::Outcome { steps, repeated, first_order, averaged, .. } = outcome;
    let rough = if first_order > 0 { format!(", {first_order} cells of first order") } else { String::new() };
    let mean =
        if averaged > 0 { format!("; it swings about: the mean of {averaged} looks counts") } else { String::new() };
    print(&format!("{ended} after {steps} steps, {repeated} blocks repeated{rough}{mean}\n"))?;
    Ok(ExitCode::SUCCESS)
}
