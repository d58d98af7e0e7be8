//! `geo-adapt metric multiscale`.
use super::common::{self, Amount, OutputArgument, RunArguments};
use super::fields::MultiscaleArguments;
use crate::cli::Outcome;
use crate::cli::figures::FigureArguments;
use crate::cli::files::reading::Carrier;
use crate::cli::files::{Files, JSON, Outputs};
use crate::cli::table::Table;
use crate::metric::multiscale::Measure;
use crate::metric::summary::Summary;
use crate::tasks::{Plan, Team, stage};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `geo-adapt metric multiscale`.
#[derive(clap::Args)]
#[command(defer(common::needs_amount))]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The field at its vertices: .sol, .solb, .csv or .dat, or the name of one in the mesh's file. Several are steps in time, several scalars in a file count alike
    #[arg(required = true, value_name = "FIELD")]
    fields: Vec<PathBuf>,
    #[command(flatten)]
    output: OutputArgument,
    #[command(flatten)]
    amount: Amount,
    #[command(flatten)]
    multiscale: MultiscaleArguments,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What is written as JSON.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    mesh: &'a Path,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    output: &'a Path,
    multiscale: super::fields::Made,
    metric: Summary,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads_fields(&arguments.fields, &arguments.mesh);
    let target = arguments.output.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    stage("start");
    let data = common::mesh(&arguments.run, team, &arguments.mesh)?;
    stage("mesh read");
    let (mut notices, wanted) = (Vec::new(), (arguments.amount.needed()?, Measure::AtVertices));
    let (given, mesh) = ((&arguments.fields[..], Carrier::of(&arguments.mesh, &data)), &data.mesh);
    let (logs, made) = arguments.multiscale.make(team, (mesh, &[]), given, wanted, (None, None), &mut notices)?;
    arguments.run.note(&notices);
    let mut outputs = Outputs::new();
    arguments.run.note(&outputs.logs(team, &target, &logs, common::on(&data))?);
    stage("written");
    if arguments.figures.are_not_wanted() {
        outputs.commit()?;
        return Ok(ExitCode::SUCCESS);
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: &arguments.mesh,
        output: &arguments.output.output,
        multiscale: made,
        metric: Summary::of(team, mesh, &logs),
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || {
        let mut table = Table::new();
        report.multiscale.rows(&mut table);
        super::show::rows(&mut table, &report.metric, None);
        table.row("written", arguments.output.output.display());
        table.text().into()
    })?;
    Ok(ExitCode::SUCCESS)
}
