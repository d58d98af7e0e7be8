//! `geo-adapt metric show`.
use super::common::{self, RunArguments};
use crate::cli::Outcome;
use crate::cli::figures::FigureArguments;
use crate::cli::files::reading::Carrier;
use crate::cli::files::{Files, JSON, Outputs};
use crate::cli::table::{Table, figure};
use crate::metric::gradation::{self, Growths};
use crate::metric::summary::{Percentiles, Summary};
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric show`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The metric at its vertices: .sol or .solb, or the name of one in the mesh's file
    metric: PathBuf,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// All that is found.
#[derive(serde::Serialize)]
struct Shown {
    #[serde(flatten)]
    summary: Summary,
    /// The ratio that each edge would need to stay as it is.
    gradation: Growths,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads_fields([&arguments.metric], &arguments.mesh);
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(&arguments.run, team, &arguments.mesh)?;
    let logs = common::logs(&arguments.run, team, &arguments.metric, Carrier::of(&arguments.mesh, &data))?;
    let mesh = &data.mesh;
    let shown = Shown { summary: Summary::of(team, mesh, &logs), gradation: gradation::measure(team, mesh, &logs) };
    let mut outputs = Outputs::new();
    outputs.json(json.as_ref(), &shown)?;
    outputs.commit()?;
    arguments.figures.print(&shown, || describe(&shown))?;
    Ok(ExitCode::SUCCESS)
}

/// The text for people.
fn describe(shown: &Shown) -> String {
    let Shown { summary, gradation } = shown;
    let mut table = Table::new();
    table.row("vertices", summary.vertices);
    table.row("complexity", figure(summary.complexity));
    table.row("complexity, interpolated", figure(summary.complexity_between));
    rows(&mut table, summary, Some(gradation));
    table.text().into()
}

/// Percentiles of sizes and their ratios, and of growth if that was measured: a row each, below a head.
pub fn rows(table: &mut Table, summary: &Summary, gradation: Option<&Growths>) {
    table.line(&format!(
        "{:<26} {}",
        "",
        row(["least", "1 %", "10 %", "50 %", "90 %", "99 %", "greatest"].map(String::from))
    ));
    let rows = [
        ("least size", Some(&summary.least_size)),
        ("greatest size", Some(&summary.greatest_size)),
        ("aspect ratio", Some(&summary.aspect_ratio)),
        ("anisotropic quotient", Some(&summary.anisotropic_quotient)),
        ("gradation, by edge", gradation),
    ];
    for (name, found) in rows {
        let Some(&Percentiles { least, p1, p10, median, p90, p99, greatest }) = found else { continue };
        table.row(name, row([least, p1, p10, median, p90, p99, greatest].map(figure)));
    }
}

fn row(cells: [String; 7]) -> String {
    cells.map(|cell| format!("{cell:>10}")).join(" ")
}
