//! `geo-adapt metric`: metric fields made, combined and measured; one file a subcommand.
mod common;
pub(super) mod fields;
mod multiscale;
mod show;

use super::Outcome;
use clap::Subcommand;

/// Arguments of `geo-adapt metric`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make the metric that resolves a field best for its complexity: L^p multiscale
    Multiscale(multiscale::Arguments),
    /// Measure a metric: complexity, sizes, aspect ratios, how fast sizes grow
    Show(show::Arguments),
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.command {
        Command::Multiscale(arguments) => multiscale::run(arguments),
        Command::Show(arguments) => show::run(arguments),
    }
}
