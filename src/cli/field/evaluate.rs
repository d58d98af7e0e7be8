//! `geo-adapt field evaluate`.
use super::super::Outcome;
use super::super::figures::FigureArguments;
use super::super::files::reading::Fields;
use super::super::files::{Files, JSON, Outputs};
use super::super::metric::common::{self, RunArguments};
use super::super::table::{Table, figure};
use crate::mesh::io::{FieldKind, Solution, SolutionField};
use crate::metric::Scalar;
use crate::tasks::{Plan, Team};
use clap::ValueEnum;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt field evaluate`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The function, on the unit cube (Tsolakis 2021, equations 21 to 23)
    #[arg(long, value_enum, value_name = "NAME")]
    function: Scalar,
    /// Where the field goes: .sol or .solb; or with the mesh: .vtu, or another format that `convert` knows and that holds fields
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What `--report` writes.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    mesh: PathBuf,
    function: Scalar,
    vertices: usize,
    tets: usize,
    /// L2 norm of the difference between the function and its linear interpolation.
    error: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut files = Files::new().reads_meshes([&arguments.mesh]);
    let target = files.writes_fields(&arguments.output, "-o")?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(&arguments.run, team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let values = arguments.function.on(team, mesh);
    let error = arguments.function.error(team, mesh, &values);
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let name = arguments.mesh.display();
        return Err(
            format!("{name}: the function is {} at vertex {}: it is one of the unit cube", values[at], at + 1).into()
        );
    }
    let solution = Solution { vertices: values.len(), fields: vec![SolutionField { kind: FieldKind::Scalar, values }] };
    let mut outputs = Outputs::new();
    let names = arguments.function.to_possible_value().map(|value| value.get_name().to_owned()).into_iter().collect();
    let fields = Fields { solution, names, mesh: None };
    arguments.run.note(&outputs.fields(team, &target, fields, common::on(&data))?);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: arguments.mesh.clone(),
        function: arguments.function,
        vertices: mesh.vertices.len(),
        tets: mesh.tets.len(),
        error,
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || {
        let mut table = Table::new();
        table.row("vertices", report.vertices);
        table.row("L2 interpolation error", figure(report.error));
        table.row("written", arguments.output.display());
        table.text().into()
    })?;
    Ok(ExitCode::SUCCESS)
}
