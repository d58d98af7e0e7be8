//! `geo-adapt metric wall`.
use super::common::{Amount, OutputArgument, RunArguments};
use crate::cli::figures::FigureArguments;
use crate::cli::files::{Files, JSON, Outputs};
use crate::cli::surface::SurfaceArguments;
use crate::cli::table::{Table, figure};
use crate::cli::walls::{Places, names_on};
use crate::cli::{Outcome, positive};
use crate::geometry::Geometry;
use crate::metric::multiscale::Norm;
use crate::metric::summary::Summary as Figures;
use crate::sizing::layer::{self, OfWall, Options, Outside, Summary, Walls, wall_metric};
use crate::tasks::{Plan, Team};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Help on --wall.
pub const WALL: &str = "A wall, and the layers along it. WALL is a surface of the mesh by name or reference, or several that are one wall: 3+4+tail. h=1e-6 is the first height; or \
yplus=1 is its y⁺ at the Reynolds number re=6e6 of the length length=1, by the friction of a flat plate. growth=1.2 is the ratio of the heights of a \
layer and the one below it: at the distance d the size across is h + 0.2 d. Sizes along the wall are 1/(segments κ) of its curvature κ, or \
tangential=H, and at most 0.5 √(8 h R), R its radius; chord=SHARE is another share, chord=off leaves that out. law=spalding makes the metric of the \
profile of a turbulent boundary layer instead, which is best for a complexity; with growth= both hold. Several walls are intersected";

/// Arguments of `geo-adapt metric wall`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The CAD model the boundary lies on: .step, .stp, .iges, .igs, .brep or .egads. Without it the walls are smooth patches through the mesh's
    /// own triangles
    #[arg(long, value_name = "MODEL")]
    cad: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArguments,
    #[command(flatten)]
    output: OutputArgument,
    /// A wall, and the layers along it
    #[arg(long = "wall", value_name = "WALL:h=H[,growth=G…]", required = true, allow_negative_numbers = true, long_help = WALL)]
    walls: Vec<Walls>,
    /// Greatest size, that of what is beyond the layers, in model units [default: a tenth of the diagonal of the model's box]
    #[arg(long, value_name = "H", value_parser = positive, allow_negative_numbers = true)]
    hmax: Option<f64>,
    /// Segments for a radian of the wall's curvature
    #[arg(long, value_name = "N", value_parser = positive, default_value = "2", allow_negative_numbers = true)]
    segments: f64,
    /// With law=spalding: the p of the L^p norm of the interpolation error of u⁺
    #[arg(long, value_name = "P", default_value_t = Norm::default(), allow_negative_numbers = true)]
    norm: Norm,
    /// Sizes as they are asked for at each vertex. Else they are graded: where a wall's curvature changes from one vertex to the next, sizes along it may
    /// double from an edge to the next
    #[arg(long)]
    exact: bool,
    #[command(flatten)]
    amount: Amount,
    /// How far a vertex may be from the model, in its units [default: 1e-6 of its diagonal, or twice what the model states for an entity]
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
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
    outside: Outside,
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
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let mut data = super::common::mesh(&arguments.run, team, &arguments.mesh)?;
    super::common::close(&arguments.run, team, &mut data);
    let (name, mesh) = (&arguments.mesh, &data.mesh);
    let (model, place) = arguments.surface.lies(team, (name, mesh), arguments.cad.as_deref(), arguments.tolerance)?;
    let names = names_on(&data.names, mesh, &place, &model);
    let on = Places { mesh, place: &place, model: &model, names: &names };
    let named = |error: String| format!("{}: {error}", name.display());
    let asked = on.walls(&arguments.walls).map_err(named)?;
    let read_and_classify = start.elapsed().as_secs_f64();
    let greatest = arguments.hmax.unwrap_or(GREATEST * model.topology().diagonal());
    let outside = Outside { greatest, segments: arguments.segments };
    let options =
        Options { outside, complexity: arguments.amount.complexity(), norm: arguments.norm, exact: arguments.exact };
    let made = wall_metric(team, (mesh, &place, &model), &asked, &options);
    let (logs, summary) = made.map_err(|error| named(remedied(error)))?;
    let metric = start.elapsed().as_secs_f64() - read_and_classify;
    let mut outputs = Outputs::new();
    arguments.run.note(&outputs.logs(team, &target, &logs, super::common::on(&data))?);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        input: name,
        cad: arguments.cad.as_deref(),
        output: &arguments.output.output,
        outside,
        summary,
        metric: Figures::of(team, mesh, &logs),
        seconds: Seconds { read_and_classify, metric },
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || describe(&report))?;
    Ok(ExitCode::SUCCESS)
}

/// The greatest size by default, as a share of the model's diagonal: that of `metric geometry`.
pub const GREATEST: f64 = 0.1;

/// An error with the option that mends it.
fn remedied(error: layer::Error) -> String {
    match error {
        layer::Error::NoComplexity => format!("{error}, by --complexity or --vertices"),
        layer::Error::Multiscale(error) => error.to_string(),
    }
}

/// Rows that tell of walls.
pub fn rows(table: &mut Table, summary: &Summary) {
    for OfWall { wall, faces, vertices, first_heights } in &summary.walls {
        table.row(&format!("wall {}", wall.place), format_args!("{vertices} vertices on {faces} faces"));
        if let Some(growth) = &wall.growth {
            let [first, ratio] = [growth.first, growth.growth].map(figure);
            table.row("  asked", format_args!("first height {first}, growth {ratio}"));
        }
        if let Some(unit) = wall.spalding {
            table.row("  Spalding's law", format_args!("y⁺ = 1 at {}", figure(unit)));
        }
        if let Some([least, greatest]) = first_heights.map(|heights| heights.map(figure)) {
            table.row("  size across, on it", format_args!("{least} to {greatest}"));
        }
    }
    if summary.graded > 0 {
        table.row("made smaller by gradation", format_args!("{} vertices", summary.graded));
    }
}

/// The text for people.
fn describe(report: &Report) -> String {
    let mut table = Table::new();
    rows(&mut table, &report.summary);
    let figures = &report.metric;
    let [least, greatest] = [figures.least_size.least, figures.greatest_size.greatest];
    table.row("sizes", format_args!("{} to {}", figure(least), figure(greatest)));
    table.row("greatest aspect ratio", figure(figures.aspect_ratio.greatest));
    table.row("complexity", figure(figures.complexity_between));
    let Seconds { read_and_classify, metric } = report.seconds;
    table.row("seconds", format_args!("{metric:.2}, after {read_and_classify:.2} of reading"));
    table.row("written", report.output.display());
    table.text().into()
}
