//! `geo-adapt field`: fields at the vertices of a mesh, evaluated, picked out of others, or measured against another; and distances.
mod distance;
mod error;
mod evaluate;
mod pick;

use super::Outcome;
use clap::Subcommand;

/// Arguments of `geo-adapt field`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// An analytic function at the vertices of a mesh, and the error of its linear interpolation there
    Evaluate(evaluate::Arguments),
    /// The exact distance of the vertices from faces of a CAD model, or from triangles of the mesh
    Distance(distance::Arguments),
    /// Some of the values of a file: components, or lengths of vectors
    Pick(pick::Arguments),
    /// How far a field is from that of another mesh, a finer one, say, which is taken as the truth
    Error(error::Arguments),
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    match &arguments.command {
        Command::Evaluate(arguments) => evaluate::run(arguments),
        Command::Distance(arguments) => distance::run(arguments),
        Command::Pick(arguments) => pick::run(arguments),
        Command::Error(arguments) => error::run(arguments),
    }
}
