//! `geo-adapt metric scale`.
use super::common::{self, Amount, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::files::reading::Carrier;
use crate::cli::table::{Table, figure};
use crate::metric::field;
use crate::tasks::GRAIN;
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric scale`.
#[derive(clap::Args)]
#[command(defer(common::needs_amount))]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The metric at its vertices: .sol or .solb, or the name of one in the mesh's file
    metric: PathBuf,
    #[command(flatten)]
    amount: Amount,
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
    let factor = field::complexity_factor(before, arguments.amount.needed()?);
    team.fill(GRAIN, &mut logs, |_, logs| logs.iter_mut().for_each(|log| *log = log.plus_identity(factor.ln())));
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let mut table = Table::new();
    table.row("complexity before", figure(before));
    table.row("complexity", figure(field::complexity_of_logs(team, mesh, &logs)));
    table.row("factor of the sizes", figure(factor.powf(-0.5)));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
