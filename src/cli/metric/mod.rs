//! `geo-adapt metric`: metric fields made, combined and measured; one file a subcommand.
mod common;
mod geometry;
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
    /// Make the metric that the geometry asks for: curvature, thin parts, gaps
    Geometry(geometry::Arguments),
    /// Measure a metric: complexity, sizes, aspect ratios, how fast sizes grow
    Show(show::Arguments),
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.command {
        Command::Geometry(arguments) => geometry::run(arguments),
        Command::Show(arguments) => show::run(arguments),
    }
}
