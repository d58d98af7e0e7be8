//! `geo-adapt adapt`.
use super::Outcome;

/// Arguments of `geo-adapt adapt`.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the subcommand.
pub fn run(_arguments: &Arguments) -> Outcome {
    Err("not there yet".into())
}
