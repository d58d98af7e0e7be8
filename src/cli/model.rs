//! `geo-adapt model`.
use super::Outcome;

/// Arguments of `geo-adapt model`.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the subcommand.
pub fn run(_arguments: &Arguments) -> Outcome {
    Err("not there yet".into())
}
