//! `geo-adapt metric grade`.
use super::common::{self, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::files::reading::Carrier;
use crate::cli::table::{Table, figure};
use crate::metric::{field, grade};
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric grade`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The metric at its vertices: .sol or .solb, or the name of one in the mesh's file
    metric: PathBuf,
    /// Greatest growth of the sizes from an edge to the next (Alauzet 2010, mixed space)
    #[arg(long, value_name = "R", value_parser = common::growth, default_value_t = 1.5, allow_negative_numbers = true)]
    ratio: f64,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to
        .target(&mut Files::new().reads_meshes([&arguments.mesh]).reads_fields([&arguments.metric], &arguments.mesh))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(run, team, &arguments.mesh)?;
    let mut logs = common::logs(run, team, &arguments.metric, Carrier::of(&arguments.mesh, &data))?;
    let mesh = &data.mesh;
    let before = common::complexity(team, &arguments.mesh, mesh, &logs)?;
    let graded = grade(team, mesh, &mut logs, arguments.ratio);
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let mut table = Table::new();
    table.row("vertices changed", format_args!("{} of {}", graded.changed, logs.len()));
    table.row("rounds", format_args!("{}, {} intersections", graded.rounds, graded.updates));
    table.row("complexity before", figure(before));
    table.row("complexity", figure(field::complexity_of_logs(team, mesh, &logs)));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
