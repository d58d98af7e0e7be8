//! `geo-adapt classify`.
use super::Outcome;

/// Arguments of `geo-adapt classify`.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the subcommand.
pub fn run(_arguments: &Arguments) -> Outcome {
    Err("not there yet".into())
}
