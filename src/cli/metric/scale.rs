//! `geo-adapt metric scale`.
use super::common::{self, Amount, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
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
    /// The mesh: .mesh or .meshb
    mesh: PathBuf,
    /// The metric at its vertices: .sol or .solb
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
    let target = to.target(&mut Files::new().reads_meshes([&arguments.mesh]).reads([&arguments.metric]))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let mesh = common::mesh(run, team, &arguments.mesh)?;
    let mut logs = common::logs(run, team, &arguments.metric, mesh.vertices.len())?;
    let before = common::complexity(team, &arguments.mesh, &mesh, &logs)?;
    let factor = field::complexity_factor(before, arguments.amount.needed()?);
    team.fill(GRAIN, &mut logs, |_, logs| logs.iter_mut().for_each(|log| *log = log.plus_identity(factor.ln())));
    common::write_logs(team, &target, &logs)?;
    let mut table = Table::new();
    table.row("complexity before", figure(before));
    table.row("complexity", figure(field::complexity_of_logs(team, &mesh, &logs)));
    table.row("factor of the sizes", figure(factor.powf(-0.5)));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
