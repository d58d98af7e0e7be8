//! `geo-adapt field error`.
use super::super::Outcome;
use super::super::figures::FigureArguments;
use super::super::files::reading::Carrier;
use super::super::files::{Files, JSON, Outputs};
use super::super::metric::common::{self, RunArguments};
use super::super::table::{Table, figure};
use super::super::transfer::{components, rows};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::locate::Locator;
use crate::metric::multiscale::Norm;
use crate::tasks::{Plan, Team};
use crate::transfer::{Distance, Places, distance, interpolate};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Arguments of `geo-adapt field error`.
///
/// The field is interpolated at the vertices of the truth's mesh, as the error is measured in the community's benchmarks.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh of the field, in any format that `convert` reads
    mesh: PathBuf,
    /// The field at its vertices: .sol, .solb, .csv or .dat, the mesh again where its file holds fields, or the name of one of these
    field: PathBuf,
    /// The mesh and the field that are taken as the truth, a mesh that is finer all over the same domain
    #[arg(long, num_args = 2, value_names = ["MESH", "FIELD"], required = true)]
    truth: Vec<PathBuf>,
    /// L^P norm of the difference over the truth's mesh: 1 to inf
    #[arg(long, value_name = "P", default_value = "2", allow_negative_numbers = true)]
    norm: Norm,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What `--report` writes.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    norm: Norm,
    /// Vertices of the mesh and of the truth's mesh.
    vertices: [usize; 2],
    tets: [usize; 2],
    /// The truth's vertices outside the mesh, which get its nearest values, and how far the farthest is.
    outside: usize,
    farthest: f64,
    values: Vec<Value>,
}

/// One value of each vertex: a component of a field.
#[derive(Serialize)]
struct Value {
    /// Of the field, from 1.
    field: usize,
    /// In the field, from 1.
    component: usize,
    #[serde(flatten)]
    error: Distance,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, mesh, field, truth, .. } = arguments;
    let [truth, true_field] = [&truth[0], &truth[1]];
    let mut files =
        Files::new().reads_meshes([mesh, truth]).reads_fields([field], mesh).reads_fields([true_field], truth);
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let coarse = common::mesh(run, team, mesh)?;
    let fields = common::fields(run, team, field, Carrier::of(mesh, &coarse))?.solution;
    let fine = common::mesh(run, team, truth)?;
    let true_fields = common::fields(run, team, true_field, Carrier::of(truth, &fine))?.solution;
    let (coarse, fine) = (coarse.mesh, fine.mesh);
    let kinds = |solution: &crate::mesh::io::Solution| solution.fields.iter().map(|f| f.kind).collect::<Vec<_>>();
    if kinds(&fields) != kinds(&true_fields) {
        let (a, b) = (field.display(), true_field.display());
        return Err(format!("{a}: other fields than {b}; give the same ones, in the same order").into());
    }
    let width = fields.fields.iter().map(|field| field.kind.values()).sum();
    let (vertices, tets) = ([&coarse, &fine].map(|m| m.vertices.len()), [&coarse, &fine].map(|m| m.tets.len()));
    let faces = MatchedFaces::of(team, &coarse.tets.nodes);
    let locator = Locator::on(team, Arc::new(coarse), faces);
    let places = Places::of(team, &locator, &fine.vertices);
    let found = interpolate(team, &locator, &places, width, &rows(team, &fields, width));
    let errors = distance(team, &fine, width, &found, &rows(team, &true_fields, width), arguments.norm.exponent());
    let values = components(&fields).zip(errors);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        norm: arguments.norm,
        vertices,
        tets,
        outside: places.outside,
        farthest: places.farthest,
        values: values.map(|((field, component), error)| Value { field, component, error }).collect(),
    };
    let mut outputs = Outputs::new();
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || report.text())?;
    Ok(ExitCode::SUCCESS)
}

impl Report {
    /// The table for the terminal.
    fn text(&self) -> String {
        let mut table = Table::new();
        let [v, w] = self.vertices;
        table.row("vertices", format_args!("{v}, of the truth {w}"));
        table.row("outside", format_args!("{} of the truth's, {} at most", self.outside, figure(self.farthest)));
        for Value { field, component, error } in &self.values {
            let Distance { norm, of_truth, greatest } = *error;
            let name = |what: &str| format!("{field}.{component} {what}");
            let part =
                if of_truth > 0.0 { format!(" ({} of the truth's)", figure(norm / of_truth)) } else { String::new() };
            table.row(&name(&format!("L{} error", self.norm)), format_args!("{}{part}", figure(norm)));
            table.row(&name("greatest"), figure(greatest));
        }
        table.text().into()
    }
}
