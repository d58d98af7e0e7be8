//! `geo-adapt metric limit`.
use super::common::{self, LimitArguments, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::table::Table;
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric limit`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The metric at the vertices of a mesh: .sol or .solb
    metric: PathBuf,
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_fields([&arguments.metric], &arguments.metric))?;
    let limits = arguments.limits.limits()?;
    if limits.are_none() {
        return Err("nothing to limit: give --hmin, --hmax or --aspect-ratio".into());
    }
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let (mut logs, data) = common::all_logs(run, team, &arguments.metric, None)?;
    let changed = limits.apply(team, &mut logs);
    common::write_logs(run, team, &target, &logs, data.as_ref().and_then(common::on))?;
    let mut table = Table::new();
    table.row("vertices changed", format_args!("{changed} of {}", logs.len()));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
