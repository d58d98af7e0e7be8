//! `geo-adapt metric geometry`.
use super::common::{GradationArgument, LimitArguments, OutputArgument, RunArguments};
use crate::cli::figures::FigureArguments;
use crate::cli::files::{Files, JSON, Outputs, reading};
use crate::cli::surface::SurfaceArguments;
use crate::cli::table::{Table, figure, place};
use crate::cli::{Outcome, positive};
use crate::geometry::{Geometry, Model};
use crate::mesh::io::Read;
use crate::metric::Limits;
use crate::metric::summary::Summary as Figures;
use crate::sizing::{self, Options, Summary};
use crate::tasks::{Plan, Team};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `geo-adapt metric geometry`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, tetrahedra or triangles only, in any format that `convert` reads
    mesh: PathBuf,
    /// The CAD model the boundary lies on: .step, .stp, .iges, .igs, .brep or .egads. Without it the curvature is estimated from the
    /// mesh's own triangles
    #[arg(long, value_name = "MODEL")]
    cad: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArguments,
    #[command(flatten)]
    output: OutputArgument,
    #[command(flatten)]
    sizes: GeometryArguments,
    /// Sizes. By default --hmax is a tenth of the diagonal of the model's box and --hmin 1e-5 of it: that is for apices and for what all but
    /// touches, where sizes have no other end
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    gradation: GradationArgument,
    /// How far a vertex may be from the model, in its units [default: 1e-6 of its diagonal, or twice what the model states for an entity]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What a geometry asks for; `adapt --field` has it too.
#[derive(Clone, clap::Args)]
pub struct GeometryArguments {
    /// Segments for a radian of curvature: the size is 1/(N κ), 2π N segments go round a circle
    #[arg(long, value_name = "N", value_parser = positive, default_value = "2", allow_negative_numbers = true)]
    segments: f64,
    /// Cells across thin parts and gaps, between entities that come near and do not touch; or `off`
    #[arg(long, value_name = "K", value_parser = cells, default_value = "2", allow_negative_numbers = true)]
    feature_cells: Cells,
}

/// A number of cells, or off. (A type of its own, since clap would take an Option for an argument that may be left out.)
#[derive(Clone, Copy)]
struct Cells(Option<f64>);

fn cells(text: &str) -> Result<Cells, String> {
    match text {
        "off" => Ok(Cells(None)),
        _ => positive(text).map(|count| Cells(Some(count))).map_err(|_| "give a positive number, or off".into()),
    }
}

/// What --report writes.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    input: &'a Path,
    #[serde(serialize_with = "crate::cli::files::text::optional_path")]
    cad: Option<&'a Path>,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    output: &'a Path,
    options: Options,
    #[serde(flatten)]
    summary: Summary,
    metric: Figures,
    seconds: Seconds,
}

/// Wall times, s.
#[derive(Clone, Copy, Serialize)]
struct Seconds {
    read_and_classify: f64,
    metric: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads_models(&arguments.cad);
    files = files.reads_any(&arguments.surface.surface);
    let target = arguments.output.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let limits = arguments.limits.limits()?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let Read { content: mut data, notices } = reading::mesh(team, &arguments.mesh)?;
    arguments.run.note(&notices);
    super::common::close(&arguments.run, team, &mut data);
    let mesh = &data.mesh;
    let (cad, tolerance) = (arguments.cad.as_deref(), arguments.tolerance);
    let (model, lies) = arguments.surface.lies(team, (&arguments.mesh, mesh), cad, tolerance)?;
    let read_and_classify = start.elapsed().as_secs_f64();
    let options = arguments.sizes.options(&model, limits, arguments.gradation.ratio());
    let (logs, summary) = sizing::geometry_metric(team, mesh, &lies, &model, &options);
    let metric = start.elapsed().as_secs_f64() - read_and_classify;
    let mut outputs = Outputs::new();
    arguments.run.note(&outputs.logs(team, &target, &logs, super::common::on(&data))?);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        input: &arguments.mesh,
        cad: arguments.cad.as_deref(),
        output: &arguments.output.output,
        options,
        summary,
        metric: Figures::of(team, mesh, &logs),
        seconds: Seconds { read_and_classify, metric },
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || describe(&report, !mesh.tets.is_empty()))?;
    Ok(ExitCode::SUCCESS)
}

impl GeometryArguments {
    /// The defaults for the model where nothing else is given. A given size moves the default of the other, if that is beyond it.
    pub fn options(&self, model: &Model, limits: Limits, gradation: Option<f64>) -> Options {
        let defaults = Options::of(model.topology());
        let greatest = limits.hmax.unwrap_or(defaults.greatest.max(limits.hmin.unwrap_or(0.0)));
        Options {
            segments: self.segments,
            least: limits.hmin.unwrap_or(defaults.least.min(greatest)),
            greatest,
            aspect_ratio: limits.aspect_ratio,
            cells: self.feature_cells.0,
            gradation,
        }
    }
}

/// The text for people.
fn describe(report: &Report, has_volume: bool) -> String {
    let (options, summary, figures) = (&report.options, &report.summary, &report.metric);
    let mut table = Table::new();
    let Summary { on_vertices, on_edges, on_faces, inside, .. } = *summary;
    table.row(
        "vertices",
        format_args!("{on_vertices} on model vertices, {on_edges} on edges, {on_faces} on faces, {inside} inside"),
    );
    table.row("sizes allowed", format_args!("{} to {}", figure(options.least), figure(options.greatest)));
    let [least, greatest] = [figures.least_size.least, figures.greatest_size.greatest];
    table.row("sizes", format_args!("{} to {}", figure(least), figure(greatest)));
    table.row("greatest aspect ratio", figure(figures.aspect_ratio.greatest));
    if summary.at_least_size > 0 {
        table.row(
            "at the least size",
            format_args!(
                "{} vertices: the geometry may ask for less there, give a smaller --hmin",
                summary.at_least_size
            ),
        );
    }
    if summary.singular > 0 {
        table.row("at poles and apices", format_args!("{} vertices", summary.singular));
    }
    if let Some(gap) = summary.nearest_gap {
        let (far, at) = (figure(gap.distance), place(gap.at));
        table.row("thin parts and gaps", format_args!("{} vertices", summary.at_gaps));
        table.row("nearest gap", format_args!("{far}, from {} at {at} to {}", gap.from, gap.to));
    }
    if summary.between > 0 {
        table.row("looked at between vertices", format_args!("{} places, for the mesh is coarse", summary.between));
    }
    if summary.graded > 0 {
        table.row("made smaller by gradation", format_args!("{} vertices", summary.graded));
    }
    if has_volume {
        table.row("complexity", figure(figures.complexity_between));
    }
    let Seconds { read_and_classify, metric } = report.seconds;
    table.row("seconds", format_args!("{metric:.2}, after {read_and_classify:.2} of reading"));
    table.row("written", report.output.display());
    table.text().into()
}
