//! `geo-adapt inspect`.
use super::Outcome;
use super::amount::bytes;
use super::figures::FigureArguments;
use super::files::reading::{self, Carrier};
use super::files::{Files, JSON, Outputs};
use super::metric::wall::WALL;
use super::surface::SurfaceArguments;
use super::table::{Table, place};
use super::walls::{self, OfWall};
use crate::formats::Dataset;
use crate::geometry::classify::Classification;
use crate::geometry::fidelity::{self, Fidelity};
use crate::geometry::{Model, classify};
use crate::inspection::{self, Inspected, Metrics};
use crate::mesh::TetMesh;
use crate::mesh::io::Read;
use crate::mesh::numbers::from_one;
use crate::mesh::validity::{self, Validity};
use crate::mesh::vector::{Vec3, add, scale};
use crate::metric::{Analytic, Field, Statistics, Sym3};
use crate::sizing::layer::Walls;
use crate::tasks::{Plan, Team};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `geo-adapt inspect`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The metric at the mesh's vertices: .sol or .solb, or the name of one in the mesh's file
    #[arg(long, value_name = "FILE", conflicts_with = "analytic")]
    metric: Option<PathBuf>,
    /// An analytic metric field
    #[arg(long, value_name = "NAME")]
    analytic: Option<Analytic>,
    /// The CAD model the mesh lies on: .step, .stp, .iges, .igs, .brep or .egads
    #[arg(long, value_name = "MODEL")]
    pub(super) cad: Option<PathBuf>,
    /// Checks and measures the mesh from its file within this memory: 500MB, 4GiB. For .meshb with a metric in .solb, without a model; all else
    /// is checked as without it. The boundary must fit
    #[arg(long, value_name = "SIZE", value_parser = bytes, conflicts_with_all = ["cad", "surface"])]
    memory: Option<u64>,
    /// A wall, and the layers that it is to have: first heights and points across are measured against these
    #[arg(long = "wall", value_name = "WALL:h=H[,growth=G…],…", conflicts_with = "memory", allow_negative_numbers = true, long_help = WALL)]
    walls: Vec<Walls>,
    #[command(flatten)]
    surface: SurfaceArguments,
    #[command(flatten)]
    figures: FigureArguments,
}

/// The tetrahedron of the least mean ratio.
#[derive(Serialize)]
struct WorstTet {
    #[serde(serialize_with = "from_one")]
    index: usize,
    mean_ratio: f64,
    at: Vec3,
}

/// The mesh on its model.
#[derive(Serialize)]
#[serde(untagged)]
enum Cad {
    On(Fidelity),
    /// Why the mesh does not fit the model.
    Off {
        error: String,
    },
}

/// All that is found.
#[derive(Serialize)]
struct Inspection {
    valid: bool,
    #[serde(flatten)]
    validity: Validity,
    #[serde(flatten)]
    statistics: Statistics,
    worst_tet: Option<WorstTet>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cad: Option<Cad>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    walls: Vec<OfWall>,
}

/// Runs the subcommand: code 0 for a valid mesh (that fits the model, if one is given), else 1.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { mesh, metric, cad, surface, .. } = arguments;
    let files = Files::new().reads_meshes([mesh]).reads(metric).reads_models(cad).reads_any(&surface.surface);
    let json = arguments.figures.target(&mut { files }, JSON)?;
    let pool = super::pool()?;
    let team = Team::new(&pool, Plan::default());
    let inspection = match arguments.memory {
        Some(memory) => of_file(team, arguments, memory)?,
        None => in_memory(team, arguments)?,
    };
    let mut outputs = Outputs::new();
    outputs.json(json.as_ref(), &inspection)?;
    outputs.commit()?;
    arguments.figures.print(&inspection, || describe(&inspection))?;
    Ok(if inspection.valid { ExitCode::SUCCESS } else { ExitCode::from(super::INVALID) })
}

/// Reads all, checks and measures.
fn in_memory(team: Team<'_>, arguments: &Arguments) -> Result<Inspection, Box<dyn std::error::Error>> {
    let data = read(team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let model = arguments.surface.model_or(team, arguments.cad.as_deref())?;
    let statistics = match metrics(team, arguments, &data)? {
        Some(metrics) => Statistics::in_metric(team, mesh, &metrics),
        None => Statistics::in_space(team, mesh),
    };
    let validity = validity::check_on(team, mesh);
    let placed = model.as_ref().map(|model| on_model(team, mesh, model));
    let (cad, place) = placed.map_or((None, None), |(cad, place)| (Some(cad), place));
    let lies = model.as_ref().zip(place.as_ref());
    let walls = walls::measured(team, (&arguments.mesh, &data), lies, &arguments.walls)?;
    let valid = validity.is_valid() && !matches!(cad, Some(Cad::Off { .. }));
    let worst_tet = worst(mesh, &statistics);
    Ok(Inspection { valid, validity, statistics, worst_tet, cad, walls })
}

/// Checks and measures from the file, within so many bytes.
fn of_file(team: Team<'_>, arguments: &Arguments, memory: u64) -> Result<Inspection, Box<dyn std::error::Error>> {
    let path = &arguments.mesh;
    let mesh = reading::mesh_by_slices(path)?;
    let file = match &arguments.metric {
        Some(path) => Some(Field::open(path, mesh.counts().vertices)?),
        None => None,
    };
    file.iter().for_each(|file| show(file.notices()));
    let metrics = match (&file, arguments.analytic) {
        (Some(file), _) => Metrics::File(file),
        (None, Some(field)) => Metrics::Analytic(field),
        (None, None) => Metrics::None,
    };
    let named = |error: inspection::Error| match error {
        inspection::Error::Mesh(_) | inspection::Error::Metric(_) => error.to_string(),
        error => format!("{}: {error}", path.display()),
    };
    let Inspected { validity, statistics, worst } = inspection::inspect(team, &mesh, metrics, memory).map_err(named)?;
    let worst_tet = worst.map(|corners| WorstTet::of(&statistics, corners));
    Ok(Inspection { valid: validity.is_valid(), validity, statistics, worst_tet, cad: None, walls: Vec::new() })
}

/// Reads the mesh and shows the notices.
fn read(team: Team<'_>, path: &Path) -> Result<Dataset, Box<dyn std::error::Error>> {
    let read = reading::mesh(team, path)?;
    show(&read.notices);
    if read.content.mesh.tets.is_empty() {
        return Err(format!("{}: no tetrahedra: a volume mesh is needed", path.display()).into());
    }
    Ok(read.content)
}

fn show(notices: &[String]) {
    for notice in notices {
        crate::cli::note(notice);
    }
}

/// The metric at the vertices, when one is given.
fn metrics(
    team: Team<'_>,
    arguments: &Arguments,
    data: &Dataset,
) -> Result<Option<Vec<Sym3>>, Box<dyn std::error::Error>> {
    if let Some(asked) = &arguments.metric {
        let Read { content, notices } = reading::metric(team, asked, Carrier::of(&arguments.mesh, data))?;
        show(&notices);
        return Ok(Some(Field::of_solution(asked, &content.solution, data.mesh.vertices.len())?.metrics));
    }
    Ok(arguments.analytic.map(|field| data.mesh.vertices.iter().map(|&p| field.at(p)).collect()))
}

fn on_model(team: Team<'_>, mesh: &TetMesh, model: &Model) -> (Cad, Option<Classification>) {
    match classify::classify(team, mesh, model, &classify::Options::default()) {
        Ok((classification, report)) => {
            show(&report.notices);
            (Cad::On(fidelity::measure(team, mesh, model, &classification)), Some(classification))
        }
        Err(error) => (Cad::Off { error: error.to_string() }, None),
    }
}

fn worst(mesh: &TetMesh, statistics: &Statistics) -> Option<WorstTet> {
    let nodes = mesh.tets.nodes.get(statistics.mean_ratios.argmin)?;
    Some(WorstTet::of(statistics, nodes.map(|v| mesh.vertices[v as usize])))
}

impl WorstTet {
    /// By its corners.
    fn of(statistics: &Statistics, corners: [Vec3; 4]) -> Self {
        let sum = corners.into_iter().fold([0.0; 3], add);
        let ratios = &statistics.mean_ratios;
        Self { index: ratios.argmin, mean_ratio: ratios.min, at: scale(sum, 0.25) }
    }
}

/// The text for people.
fn describe(inspection: &Inspection) -> String {
    let mut table = Table::new();
    if inspection.validity.is_valid() {
        table.row("validity", "valid");
    } else {
        table.row("validity", "INVALID");
        for flaw in &inspection.validity.flaws {
            table.line(&format!("  {flaw}"));
        }
    }
    table.statistics(&inspection.statistics);
    if let Some(WorstTet { index, at, .. }) = inspection.worst_tet {
        table.row("worst tetrahedron", format_args!("no. {} at {}", index + 1, place(at)));
    }
    match &inspection.cad {
        Some(Cad::On(fidelity)) => table.fidelity(fidelity),
        Some(Cad::Off { error }) => table.row("on the model", format_args!("NO: {error}")),
        None => {}
    }
    inspection.walls.iter().for_each(|wall| wall.rows(&mut table));
    table.text().into()
}
