//! `geo-adapt transfer`.
use super::Outcome;
use super::figures::FigureArguments;
use super::files::reading::{self, Carrier, Fields};
use super::files::{Files, JSON, Outputs};
use super::metric::common::{self, Failure, OutputArgument, RunArguments};
use super::table::{Table, figure};
use crate::formats::Dataset;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::io::{FieldKind, Read, Solution, SolutionField};
use crate::mesh::locate::Locator;
use crate::metric::{Field, Sym3, transfer as of_metric};
use crate::tasks::{GRAIN, Plan, Team, stage};
use crate::transfer::{Component, Conserved, Keep, Places, conservative, interpolate, measure};
use clap::ValueEnum;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `geo-adapt transfer`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh that has the fields, in any format that `convert` reads
    old_mesh: PathBuf,
    /// The fields at its vertices: .sol, .solb, a restart of SU2 (.csv, .dat), the mesh again where its file holds them, or the name of one of
    /// these
    old_fields: PathBuf,
    /// The mesh that gets them
    new_mesh: PathBuf,
    #[command(flatten)]
    to: OutputArgument,
    /// Keep the integral of each value over the mesh, with no new extremum, instead of interpolating. Where the meshes differ in volume
    /// (curved boundaries) `mean` keeps the integral by the volume, and a constant one; `mass` the integral, as far as no new extremum comes of it
    #[arg(long, value_name = "KEEP", num_args = 0..=1, require_equals = true, default_missing_value = "mean")]
    conservative: Option<Kept>,
    /// The file is a metric: interpolate its logarithm, so that sizes between two are their geometric mean
    #[arg(long, conflicts_with = "conservative")]
    metric: bool,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What a conservative transfer keeps where the volumes differ.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kept {
    /// The integral by the volume of the mesh
    Mean,
    /// The integral
    Mass,
}

/// What was done.
#[derive(Serialize)]
struct Report {
    method: &'static str,
    vertices: [usize; 2],
    tets: [usize; 2],
    /// New vertices outside the old mesh.
    outside: usize,
    farthest: f64,
    /// Volumes of the old and the new mesh.
    volumes: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    overlap: Option<Overlap>,
    values: Vec<Value>,
    seconds: Seconds,
}

/// How far the meshes cover each other, of a conservative transfer.
#[derive(Serialize)]
struct Overlap {
    common_volume: f64,
    /// New tetrahedra of which a part lies outside the old mesh.
    partly_outside: usize,
    /// New tetrahedra outside the old mesh.
    outside: usize,
}

/// One value of each vertex: a component of a field.
#[derive(Serialize)]
struct Value {
    /// Of the field, from 1.
    field: usize,
    /// In the field, from 1.
    component: usize,
    before: Component,
    after: Component,
    /// By how much the last correction of a conservative transfer changed the integral.
    #[serde(skip_serializing_if = "Option::is_none")]
    corrected: Option<f64>,
}

/// Wall times, s.
#[derive(Default, Serialize)]
struct Seconds {
    read: f64,
    transfer: f64,
    total: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let Arguments { run, to, .. } = arguments;
    let mut files = Files::new().reads_meshes([&arguments.old_mesh, &arguments.new_mesh]);
    files = files.reads_fields([&arguments.old_fields], &arguments.old_mesh);
    let target = to.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let old = common::mesh(run, team, &arguments.old_mesh)?;
    let fields = arguments.fields(team, &old)?;
    let (old, fields, called) = (old.mesh, fields.solution, fields.names);
    let to_mesh = common::mesh(run, team, &arguments.new_mesh)?;
    let new = &to_mesh.mesh;
    let read = start.elapsed().as_secs_f64();
    stage("read");
    let faces = MatchedFaces::of(team, &old.tets.nodes);
    let locator = Locator::on(team, Arc::new(old), faces);
    let places = Places::of(team, &locator, &new.vertices);
    stage("located");
    let width = fields.fields.iter().map(|field| field.kind.values()).sum();
    let rows = rows(team, &fields, width);
    let (found, conserved) = match arguments.conservative {
        Some(kept) => {
            let keep = if kept == Kept::Mean { Keep::Mean } else { Keep::Mass };
            let found = conservative(team, &locator, new, &places, width, &rows, keep);
            let Conserved { values, .. } = found.as_ref().map_err(|error| arguments.named(error))?;
            (values.clone(), found.ok())
        }
        None if arguments.metric => (interpolated_metric(team, &locator, &places, &rows), None),
        None => (interpolate(team, &locator, &places, width, &rows), None),
    };
    let transferred = start.elapsed().as_secs_f64();
    stage("transferred");
    let mut outputs = Outputs::new();
    let transferred_fields = Fields { solution: solution(team, &fields, width, &found), names: called, mesh: None };
    run.note(&outputs.fields(team, &target, transferred_fields, common::on(&to_mesh))?);
    stage("written");
    let (old_volume, before) = measure(team, locator.mesh(), width, &rows);
    let (new_volume, after) = measure(team, new, width, &found);
    let value = |(c, (field, component)): (usize, (usize, usize))| Value {
        field,
        component,
        before: before[c],
        after: after[c],
        corrected: conserved.as_ref().map(|conserved| conserved.corrected[c]),
    };
    let report = Report {
        method: arguments.method(),
        vertices: [locator.vertices().len(), new.vertices.len()],
        tets: [locator.tets().len(), new.tets.len()],
        outside: places.outside,
        farthest: places.farthest,
        volumes: [old_volume, new_volume],
        overlap: conserved.as_ref().map(|found| Overlap {
            common_volume: found.common,
            partly_outside: found.partly,
            outside: found.outside,
        }),
        values: components(&fields).enumerate().map(value).collect(),
        seconds: Seconds { read, transfer: transferred - read, total: start.elapsed().as_secs_f64() },
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || report.text())?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    /// Reads the fields of the old mesh.
    fn fields(&self, team: Team<'_>, old: &Dataset) -> Result<Fields, Failure> {
        let of = Carrier::of(&self.old_mesh, old);
        if !self.metric {
            return common::fields(&self.run, team, &self.old_fields, of);
        }
        // Read as a metric, so that other files are refused with the same message as in all commands.
        let Read { content: mut fields, notices } = reading::metric(team, &self.old_fields, of)?;
        let vertices = Some(of.vertices.len());
        let logs = Field::logs_of_solution(team, &self.old_fields, &fields.solution, vertices)?;
        self.run.note(&[notices, logs.notices].concat());
        if fields.solution.fields[0].kind == FieldKind::Scalar {
            // Isotropic sizes: their tensors are interpolated.
            fields.solution = Field::solution_of_logs(team, &self.old_fields, &logs.content)?;
        }
        Ok(fields)
    }

    fn method(&self) -> &'static str {
        match self.conservative {
            Some(Kept::Mean) => "conservative, the mean kept",
            Some(Kept::Mass) => "conservative, the integral kept",
            None if self.metric => "log-Euclidean interpolation",
            None => "linear interpolation",
        }
    }

    /// An error of the transfer, with the file that it is about.
    fn named(&self, error: &crate::transfer::Error) -> String {
        use crate::transfer::{Error, Which};
        let (Error::Inverted { mesh, .. } | Error::NoVolume(mesh)) = error;
        let path: &Path = if *mesh == Which::Old { &self.old_mesh } else { &self.new_mesh };
        format!("{}: {error}", path.display())
    }
}

/// Number of the field and of the component in it, each from 1, of each value of a vertex.
pub(super) fn components(solution: &Solution) -> impl Iterator<Item = (usize, usize)> {
    let fields = solution.fields.iter().zip(1..);
    fields.flat_map(|(field, number)| (1..=field.kind.values()).map(move |k| (number, k)))
}

/// All fields in rows of `width` values a vertex.
pub(super) fn rows(team: Team<'_>, solution: &Solution, width: usize) -> Vec<f64> {
    let mut rows = vec![0.0; width * solution.vertices];
    team.fill(width * GRAIN, &mut rows, |start, rows| {
        for (row, v) in rows.chunks_exact_mut(width).zip(start / width..) {
            let mut to = row;
            for field in &solution.fields {
                let (here, rest) = to.split_at_mut(field.kind.values());
                here.copy_from_slice(&field.values[v * here.len()..][..here.len()]);
                to = rest;
            }
        }
    });
    rows
}

/// The fields of these kinds, from rows of `width` values a vertex.
fn solution(team: Team<'_>, like: &Solution, width: usize, rows: &[f64]) -> Solution {
    let mut first = 0;
    let mut fields = Vec::with_capacity(like.fields.len());
    for field in &like.fields {
        let count = field.kind.values();
        let from = first;
        let value = |at: usize| rows[at / count * width + from + at % count];
        fields.push(SolutionField { kind: field.kind, values: team.map(GRAIN, rows.len() / width * count, value) });
        first += count;
    }
    Solution { vertices: rows.len() / width, fields }
}

/// The metric at places, from that at the vertices, which is positive definite.
fn interpolated_metric(team: Team<'_>, locator: &Locator, places: &Places, rows: &[f64]) -> Vec<f64> {
    let tensors = rows.as_chunks().0;
    let logs = team.map(GRAIN, tensors.len(), |v| Sym3(tensors[v]).ln());
    let logs = of_metric::at(team, locator, places, &logs);
    team.map(GRAIN, logs.len(), |v| logs[v].exp().0).into_flattened()
}

impl Report {
    /// The table for the terminal.
    fn text(&self) -> String {
        let mut table = Table::new();
        let ([v, w], [t, u]) = (self.vertices, self.tets);
        table.row("method", self.method);
        table.row("vertices", format_args!("{v} -> {w}"));
        table.row("tetrahedra", format_args!("{t} -> {u}"));
        table.row("outside the old mesh", format_args!("{} vertices, which have its nearest values", self.outside));
        table.row("farthest from it", figure(self.farthest));
        let [v, w] = self.volumes;
        table.row("volume", format_args!("{v:.12e} -> {w:.12e} ({:+.1e})", w / v - 1.0));
        if let Some(Overlap { common_volume, partly_outside, outside }) = &self.overlap {
            table.row("volume in common", format_args!("{common_volume:.12e}"));
            table.row("tetrahedra outside", format_args!("{outside}, partly {partly_outside}"));
        }
        for value in &self.values {
            let Value { field, component, before, after, .. } = value;
            let name = |what: &str| format!("{field}.{component} {what}");
            let change = (after.mass - before.mass) / before.mass;
            let change = if change.is_finite() { format!(" ({change:+.1e})") } else { String::new() };
            table.row(&name("integral"), format_args!("{:.12e} -> {:.12e}{change}", before.mass, after.mass));
            let range = |found: &Component| format!("{} to {}", figure(found.least), figure(found.greatest));
            table.row(&name("values"), format_args!("{} -> {}", range(before), range(after)));
        }
        let Seconds { read, transfer, total } = self.seconds;
        table.row("seconds", format_args!("{total:.2} (read {read:.2}, transfer {transfer:.2})"));
        table.text().into()
    }
}
