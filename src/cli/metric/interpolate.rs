//! `geo-adapt metric interpolate`.
use super::common::{self, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::files::reading::Carrier;
use crate::cli::table::{Table, figure};
use crate::metric::transfer::{Transferred, transfer};
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `geo-adapt metric interpolate`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh that has the metric, in any format that `convert` reads
    old_mesh: PathBuf,
    /// The metric at its vertices: .sol or .solb, or the name of one in the mesh's file
    old_metric: PathBuf,
    /// The mesh that gets it, in any format that `convert` reads
    new_mesh: PathBuf,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(
        &mut Files::new()
            .reads_meshes([&arguments.old_mesh, &arguments.new_mesh])
            .reads_fields([&arguments.old_metric], &arguments.old_mesh),
    )?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let old = common::mesh(run, team, &arguments.old_mesh)?;
    let logs = common::logs(run, team, &arguments.old_metric, Carrier::of(&arguments.old_mesh, &old))?;
    let new = common::mesh(run, team, &arguments.new_mesh)?;
    let Transferred { logs, outside, farthest } = transfer(team, Arc::new(old.mesh), &logs, &new.mesh.vertices);
    common::write_logs(run, team, &target, &logs, common::on(&new))?;
    let mut table = Table::new();
    table.row("vertices", logs.len());
    table.row("outside the old mesh", format_args!("{outside}, they get the metric of its nearest point"));
    table.row("farthest from it", figure(farthest));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
