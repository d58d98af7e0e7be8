//! `geo-adapt metric multiscale`.
use super::common::{self, Amount, Failure, MemoryArguments, OutputArgument, RunArguments};
use super::fields::{Made, MultiscaleArguments};
use crate::cli::Outcome;
use crate::cli::figures::FigureArguments;
use crate::cli::files::reading::{self, Carrier};
use crate::cli::files::{Files, JSON, Outputs, Target};
use crate::cli::table::Table;
use crate::metric::multiscale::Measure;
use crate::metric::out_of_core;
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
    memory: MemoryArguments,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// Bytes that a vertex takes in the scratch folder: four tensors, neighbours, tetrahedra, coordinates, a value.
const BYTES_A_VERTEX: f64 = 450.0;

/// What is written as JSON.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    mesh: &'a Path,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    output: &'a Path,
    multiscale: Made,
    metric: Summary,
}

/// What a run has made: the files, what was done, and the figures of the metric if they are wanted.
type Done = (Outputs, Made, Option<Summary>);

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads_fields(&arguments.fields, &arguments.mesh);
    let target = arguments.output.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    stage("start");
    let (mut outputs, made, metric) = match arguments.memory.memory {
        Some(memory) => arguments.of_files(team, &target, memory)?,
        None => arguments.in_memory(team, &target)?,
    };
    stage("written");
    let Some(metric) = metric else {
        outputs.commit()?;
        return Ok(ExitCode::SUCCESS);
    };
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: &arguments.mesh,
        output: &arguments.output.output,
        multiscale: made,
        metric,
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

impl Arguments {
    /// Reads all, makes the metric and writes it.
    fn in_memory(&self, team: Team<'_>, target: &Target) -> Result<Done, Failure> {
        let data = common::mesh(&self.run, team, &self.mesh)?;
        stage("mesh read");
        let (mut notices, wanted) = (Vec::new(), (self.amount.needed()?, Measure::AtVertices));
        let (given, mesh) = ((&self.fields[..], Carrier::of(&self.mesh, &data)), &data.mesh);
        let (logs, made) = self.multiscale.make(team, (mesh, &[]), given, wanted, (None, None), &mut notices)?;
        self.run.note(&notices);
        let mut outputs = Outputs::new();
        self.run.note(&outputs.logs(team, target, &logs, common::on(&data))?);
        let is_wanted = !self.figures.are_not_wanted();
        Ok((outputs, made, is_wanted.then(|| Summary::of(team, mesh, &logs))))
    }

    /// The same from the files, by slices, within so many bytes.
    fn of_files(&self, team: Team<'_>, target: &Target, memory: u64) -> Result<Done, Failure> {
        if target.path().extension().is_none_or(|extension| extension != "solb") {
            let path = target.path().display();
            return Err(format!(
                "{path}: with --memory the metric goes to a .solb: give -o one, or leave --memory out"
            )
            .into());
        }
        let mesh = reading::mesh_by_slices(&self.mesh)?;
        let vertices = mesh.counts().vertices;
        let scratch = self.memory.scratch(target.path(), BYTES_A_VERTEX * vertices as f64)?;
        let (mut notices, wanted) = (Vec::new(), self.amount.needed()?);
        let made = self.multiscale.make_of_files(team, &mesh, &self.fields, wanted, (memory, &scratch), &mut notices);
        self.run.note(&notices);
        let (metric, made) = made.map_err(|error| self.named(error))?;
        let mut outputs = Outputs::new();
        let to = outputs.metric_by_slices(target, vertices)?;
        metric.put(&to)?;
        to.finish()?;
        let is_wanted = !self.figures.are_not_wanted();
        Ok((outputs, made, is_wanted.then(|| metric.summary()).transpose()?))
    }

    /// An error with the mesh, where it is of the mesh and does not say so.
    fn named(&self, error: Failure) -> Failure {
        match error.downcast_ref() {
            Some(
                out_of_core::Error::TooFew { .. }
                | out_of_core::Error::Memory { .. }
                | out_of_core::Error::Tetrahedra { .. },
            ) => format!("{}: {error}", self.mesh.display()).into(),
            _ => error,
        }
    }
}
