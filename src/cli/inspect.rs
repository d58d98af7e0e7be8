//! `geo-adapt inspect`.
use super::Outcome;

/// Arguments of `geo-adapt inspect`.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the subcommand.
pub fn run(_arguments: &Arguments) -> Outcome {
    Err("not there yet".into())
}
