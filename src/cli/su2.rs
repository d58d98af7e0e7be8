//! `geo-adapt su2`: runs a configuration of SU2 that `geo-adapt cycle` has prepared.
use super::interrupt::{self, Interrupted};
use super::{Outcome, print};
use crate::cycle::solver::su2::drive;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering::SeqCst;

/// Arguments of `geo-adapt su2`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The folder with plan.json
    folder: PathBuf,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let (stop, mut printed) = (interrupt::end_at_once(), Ok(()));
    let outcome = drive::drive(&arguments.folder, stop, &mut |line| {
        let done = print(&format!("{line}\n"));
        printed = std::mem::replace(&mut printed, Ok(())).and(done);
    });
    let outcome = outcome.map_err(|error| -> Box<dyn std::error::Error> {
        if stop.load(SeqCst) { Interrupted(error).into() } else { error.into() }
    })?;
    printed?;
    print(&format!("{} iterations, diverged {} times\n", outcome.iterations, outcome.diverged))?;
    Ok(ExitCode::SUCCESS)
}
