//! `geo-adapt metric implied`.
use super::common::{self, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::table::{Table, figure};
use crate::metric::field;
use crate::metric::implied::{Implied, implied};
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric implied`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_meshes([&arguments.mesh]))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(run, team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let Some(Implied { logs, flat, bare }) = implied(team, mesh) else {
        let name = arguments.mesh.display();
        return Err(format!("{name}: all tetrahedra are flat or inverted; turn two nodes of each round").into());
    };
    if flat > 0 {
        run.note(&[format!("{flat} tetrahedra are flat or inverted and were passed over")]);
    }
    if bare > 0 {
        run.note(&[format!("{bare} vertices have no tetrahedron that counts; they get the mean of the mesh")]);
    }
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let complexity = field::complexity_of_logs(team, mesh, &logs);
    let mut table = Table::new();
    table.row("vertices", logs.len());
    table.row("complexity", figure(complexity));
    table.row("vertices / complexity", figure(logs.len() as f64 / complexity));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
