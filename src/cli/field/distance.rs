//! `geo-adapt field distance`.
use super::super::adapt::parts::Part;
use super::super::figures::FigureArguments;
use super::super::files::reading::Fields;
use super::super::files::{Files, JSON, Outputs};
use super::super::metric::common::{self, RunArguments};
use super::super::table::{Table, figure};
use super::super::walls::{Places, names_on, surfaces};
use super::super::{Outcome, load, positive};
use crate::geometry::classify;
use crate::mesh::io::{FieldKind, Solution, SolutionField};
use crate::sizing::layer::{distances, from_triangles, spalding};
use crate::tasks::{GRAIN, Plan, Team};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `geo-adapt field distance`.
///
/// With --cad the distance is that to the model's faces, by closest points of their surfaces within their trimming; else that to the mesh's own
/// triangles. In both cases it is exact, and 0 on them.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The surfaces of the mesh to which the distance is taken, by name or reference: wing, or 3,7
    #[arg(long, value_name = "REF,…", value_delimiter = ',', required = true, allow_negative_numbers = true)]
    faces: Vec<Part>,
    /// The CAD model the boundary lies on: .step, .stp, .iges, .igs, .brep or .egads. Without it the distance is that to the mesh's own triangles
    #[arg(long, value_name = "MODEL")]
    cad: Option<PathBuf>,
    /// Where the field goes: .sol or .solb; or with the mesh: .vtu, or another format that `convert` knows and that holds fields
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// Write y⁺ = d u_τ/ν of the distance d, of a flat plate of Reynolds number --re
    #[arg(long, requires = "re", conflicts_with = "spalding")]
    yplus: bool,
    /// Write u⁺ of the distance, by Spalding's law of the wall: a turbulent boundary layer before any flow is known
    #[arg(long, requires = "re")]
    spalding: bool,
    /// The Reynolds number U L/ν
    #[arg(long, value_name = "RE", value_parser = positive, allow_negative_numbers = true)]
    re: Option<f64>,
    /// Its length L, model units
    #[arg(long, value_name = "L", value_parser = positive, default_value = "1", requires = "re", allow_negative_numbers = true)]
    length: f64,
    /// How far a vertex may be from the model, in its units [default: 1e-6 of its diagonal, or twice what the model states for an entity]
    #[arg(long, value_name = "T", value_parser = positive, requires = "cad", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What `--report` writes. Lengths are in model units.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    #[serde(serialize_with = "crate::cli::files::text::path")]
    mesh: &'a Path,
    #[serde(serialize_with = "crate::cli::files::text::optional_path")]
    cad: Option<&'a Path>,
    /// What is written: distance, yplus or uplus.
    field: &'static str,
    vertices: usize,
    /// Vertices on the faces.
    on_faces: usize,
    /// Least distance of the others, and the greatest.
    distances: [f64; 2],
    /// The height of y⁺ = 1.
    unit: Option<f64>,
    seconds: f64,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let name = &arguments.mesh;
    let mut files = Files::new().reads_meshes([name]).reads_models(&arguments.cad);
    let target = files.writes_fields(&arguments.output, "-o")?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let mut data = common::mesh(&arguments.run, team, name)?;
    common::close(&arguments.run, team, &mut data);
    let mesh = &data.mesh;
    let named = |error: String| format!("{}: {error}", name.display());
    let (found, seconds) = match &arguments.cad {
        Some(path) => {
            let model = load::model(path)?;
            let options = classify::Options { tolerance: arguments.tolerance, ..classify::Options::default() };
            let (place, report) = classify::classify(team, mesh, &model, &options)
                .map_err(|error| format!("{} on {}: {error}", name.display(), path.display()))?;
            arguments.run.note(&report.notices);
            let names = names_on(&data.names, mesh, &place, &model);
            let on = Places { mesh, place: &place, model: &model, names: &names };
            let faces = on.faces(&surfaces("--faces", &arguments.faces, mesh, &names).map_err(named)?);
            let start = Instant::now();
            (distances(team, mesh, &place, &model, &faces), start.elapsed().as_secs_f64())
        }
        None => {
            let references = surfaces("--faces", &arguments.faces, mesh, &data.names).map_err(named)?;
            let start = Instant::now();
            (from_triangles(team, mesh, &references), start.elapsed().as_secs_f64())
        }
    };
    let off = found.iter().copied().filter(|&distance| distance > 0.0);
    let ends = off.fold([f64::INFINITY, 0.0], |[a, b], x| [f64::min(a, x), f64::max(b, x)]);
    let on_faces = found.iter().filter(|&&distance| distance == 0.0).count();
    let unit = arguments.re.map(|re| spalding::viscous_length(re, arguments.length));
    let (field, values) = match unit {
        Some(unit) if arguments.yplus => ("yplus", team.map(GRAIN, found.len(), |v| found[v] / unit)),
        Some(unit) if arguments.spalding => {
            ("uplus", team.map(GRAIN, found.len(), |v| spalding::velocity(found[v] / unit).value))
        }
        _ => ("distance", found),
    };
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        mesh: name,
        cad: arguments.cad.as_deref(),
        field,
        vertices: values.len(),
        on_faces,
        distances: ends.map(|x| if x.is_finite() { x } else { 0.0 }),
        unit,
        seconds,
    };
    let solution = Solution { vertices: values.len(), fields: vec![SolutionField { kind: FieldKind::Scalar, values }] };
    let mut outputs = Outputs::new();
    let fields = Fields { solution, names: vec![field.into()], mesh: None };
    arguments.run.note(&outputs.fields(team, &target, fields, common::on(&data))?);
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || {
        let mut table = Table::new();
        table.row("vertices", format_args!("{}, {on_faces} on the faces", report.vertices));
        let [least, greatest] = report.distances.map(figure);
        table.row("distances of the others", format_args!("{least} to {greatest}"));
        if let Some(unit) = unit {
            table.row("height of y⁺ = 1", figure(unit));
        }
        table.row("seconds", format_args!("{seconds:.2}"));
        table.row("written", format_args!("{}, {field}", arguments.output.display()));
        table.text().into()
    })?;
    Ok(ExitCode::SUCCESS)
}
