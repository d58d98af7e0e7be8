//! `geo-adapt metric isotropic`.
use super::common::{self, OutputArgument, RunArguments};
use crate::adapt::meeting::VERTICES_PER_COMPLEXITY;
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::files::reading::Carrier;
use crate::cli::table::{Table, figure};
use crate::metric::{Sym3, field};
use crate::tasks::{GRAIN, Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric isotropic`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh: .mesh or .meshb
    mesh: PathBuf,
    /// Sizes at its vertices, a scalar each, as mmg3d takes them: .sol or .solb. Of a metric of tensors the least size at each vertex
    sizes: PathBuf,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_meshes([&arguments.mesh]).reads([&arguments.sizes]))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(run, team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let given = common::logs(run, team, &arguments.sizes, Carrier::of(&arguments.mesh, &data))?;
    let greatest = |log: &Sym3| log.eigen().values[2];
    let logs = team.map(GRAIN, given.len(), |v| Sym3::ZERO.plus_identity(greatest(&given[v])));
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let complexity = field::complexity_between(team, mesh, &logs);
    let sizes = logs.iter().map(|log| log.sizes_of_log()[0]);
    let (least, most) = sizes.fold((f64::INFINITY, 0.0), |(least, most), h| (h.min(least), h.max(most)));
    let mut table = Table::new();
    table.row("vertices", logs.len());
    table.row("sizes", format_args!("{} to {}", figure(least), figure(most)));
    table.row("complexity", figure(complexity));
    table.row("vertices to expect", format_args!("about {:.0}", VERTICES_PER_COMPLEXITY * complexity));
    table.row("written", to.output.display());
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
