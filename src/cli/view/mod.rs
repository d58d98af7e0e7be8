//! `geo-adapt view`.
mod look;

use super::files::reading::{self, Carrier};
use super::files::{Files, Outputs, Target};
use super::metric::common::{self, Failure, RunArguments};
use super::surface::SurfaceArguments;
use super::table::figure;
use crate::formats::{Dataset, NamedField};
use crate::geometry::{Evaluate, Geometry, Model, classify, fidelity};
use crate::mesh::TetMesh;
use crate::mesh::io::Read;
use crate::mesh::vector::Vec3;
use crate::metric::{Analytic, Statistics, Sym3};
use crate::tasks::{GRAIN, Plan, Team, stage};
use crate::view::cut::Part;
use crate::view::picture::{Colour, Options};
use crate::view::{Given, ScalarField, Scene};
use look::LookArguments;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `geo-adapt view`.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("written").required(true).multiple(true).args(["output", "png"])))]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads; names of the references of .mesh and .meshb may lie beside as MESH.names.json
    mesh: PathBuf,
    /// A page for the browser: .html. All is in this one file
    #[arg(short, long, visible_short_alias = 'x', value_name = "PAGE.html")]
    output: Option<PathBuf>,
    /// A picture: .png
    #[arg(long, value_name = "PICTURE.png")]
    png: Option<PathBuf>,
    /// The CAD model: its edges, and distances from it
    #[arg(long, value_name = "MODEL")]
    cad: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArguments,
    /// The metric at the mesh's vertices that shapes are measured in: .sol or .solb, or the name of one in the mesh's file
    #[arg(long, value_name = "FILE", conflicts_with = "analytic")]
    metric: Option<PathBuf>,
    /// An analytic metric field
    #[arg(long, value_name = "NAME")]
    analytic: Option<Analytic>,
    /// Fields at the mesh's vertices to colour by: .sol, .solb, .csv or .dat, or the name of one in the mesh's file; may be given several times.
    /// Without it the page has those of the mesh's file
    #[arg(long, value_name = "FILE")]
    field: Vec<PathBuf>,
    #[command(flatten)]
    look: LookArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let [page, picture] = arguments.targets()?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let read = reading::mesh(team, &arguments.mesh)?;
    arguments.run.note(&read.notices);
    let (data, mesh) = (&read.content, &read.content.mesh);
    if mesh.tets.is_empty() && mesh.triangles.is_empty() {
        let name = arguments.mesh.display();
        return Err(format!("{name}: neither tetrahedra nor triangles: there is nothing to show").into());
    }
    stage("mesh read");
    let given = arguments.given(team, data)?;
    stage("measured");
    let scene = Scene::new(team, mesh, given);
    stage("scene");
    let options = arguments.options(&scene)?;
    let mut outputs = Outputs::new();
    if let Some(page) = &page {
        outputs.page(team, page, &scene, &options)?;
        stage("page written");
    }
    if let Some(picture) = &picture {
        outputs.picture(team, picture, &scene, &options)?;
        stage("picture written");
    }
    outputs.commit()?;
    for path in [&arguments.output, &arguments.png].into_iter().flatten() {
        let megabytes = std::fs::metadata(path).map_or(0.0, |file| file.len() as f64 / 1e6);
        arguments.run.print(&format!("{}: {megabytes:.2} MB\n", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

type Outcome = Result<ExitCode, Failure>;

impl Arguments {
    /// Page and picture, as far as they are asked for.
    fn targets(&self) -> Result<[Option<Target>; 2], String> {
        let files = Files::new().reads_meshes([&self.mesh]).reads_models(&self.cad).reads_any(&self.surface.surface);
        let mut files = files.reads_fields(&self.metric, &self.mesh).reads_fields(&self.field, &self.mesh);
        let mut target = |path: &Option<PathBuf>, by: &str, ending: &str| {
            path.as_ref().map(|path| files.writes(path, by, &[ending])).transpose()
        };
        Ok([target(&self.output, "-o", "html")?, target(&self.png, "--png", "png")?])
    }

    /// Reads and measures what comes with the mesh.
    fn given(&self, team: Team<'_>, data: &Dataset) -> Result<Given, Failure> {
        let (mesh, of) = (&data.mesh, Carrier::of(&self.mesh, data));
        let logs = self.logs(team, of)?;
        let metrics = logs.as_ref().map(|logs| team.map(GRAIN, logs.len(), |v| logs[v].exp()));
        let statistics = match &metrics {
            Some(metrics) => Statistics::in_metric(team, mesh, metrics),
            None => Statistics::in_space(team, mesh),
        };
        let mut figures = figures(&statistics);
        let mut fields = Vec::new();
        for path in &self.field {
            fields.extend(self.read_field(team, path, of)?);
        }
        if self.field.is_empty() {
            fields.extend(named(team, &data.fields));
        }
        let mut model_edges = Vec::new();
        if let Some(model) = self.surface.model_or(team, self.cad.as_deref())? {
            model_edges = edges_of(&model);
            fields.push(self.distances(team, mesh, &model, &mut figures));
        }
        let file = self.mesh.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let title = self.look.title.clone().unwrap_or(file);
        Ok(Given { title, logs, fields, names: data.names.clone(), model_edges, figures })
    }

    /// ln M at the vertices, when there is a metric.
    fn logs(&self, team: Team<'_>, of: Carrier<'_>) -> Result<Option<Vec<Sym3>>, Failure> {
        if let Some(path) = &self.metric {
            return common::logs(&self.run, team, path, of).map(Some);
        }
        Ok(self.analytic.map(|field| team.map(GRAIN, of.vertices.len(), |v| field.log_at(of.vertices[v]))))
    }

    fn read_field(&self, team: Team<'_>, path: &Path, of: Carrier<'_>) -> Result<Vec<ScalarField>, Failure> {
        let Read { content, notices } = reading::fields(team, path, of)?;
        self.run.note(&notices);
        let (name, found, vertices) = (path.display(), content.solution.vertices, of.vertices.len());
        if found != vertices {
            let message = format!("values at {found} vertices, but the mesh has {vertices}: give a field of this mesh");
            return Err(format!("{name}: {message}").into());
        }
        if content.solution.fields.is_empty() {
            return Err(format!("{name}: no field at the vertices; a field file holds one or more").into());
        }
        if !content.names.is_empty() {
            return Ok(named(team, &content.into_named()));
        }
        let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Ok(ScalarField::of_solution(team, &stem, &content.solution))
    }

    /// Distances of the vertices from what they lie on; where the mesh does not fit the model, from its nearest face.
    fn distances(&self, team: Team<'_>, mesh: &TetMesh, model: &Model, figures: &mut Vec<[String; 2]>) -> ScalarField {
        let distances = match classify::classify(team, mesh, model, &classify::Options::default()) {
            Ok((classification, report)) => {
                self.run.note(&report.notices);
                figures.push(row("on the model", "yes"));
                fidelity::distances(team, mesh, model, &classification)
            }
            Err(error) => {
                self.run.note(&[format!("{}: {error}", self.mesh.display())]);
                figures.push(row("on the model", &format!("no: {error}")));
                fidelity::distances_from_faces(team, mesh, model)
            }
        };
        let greatest = distances.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
        figures.push(row("greatest distance from the model", &figure(greatest)));
        ScalarField::new(team, "distance".into(), team.map(GRAIN, distances.len(), |v| distances[v] as f32))
    }

    /// How it is to look.
    fn options(&self, scene: &Scene<'_>) -> Result<Options, Failure> {
        let look = &self.look;
        if let Some(unknown) = look.hide.iter().find(|&&one| scene.surfaces.iter().all(|known| known.reference != one))
        {
            let known: Vec<String> = scene.surfaces.iter().take(20).map(|one| one.reference.to_string()).collect();
            let (name, known) = (self.mesh.display(), known.join(", "));
            return Err(format!("{name}: --hide: no triangle has the reference {unknown}; there are {known}").into());
        }
        if look.below.is_some() && scene.mesh.tets.is_empty() {
            return Err(format!("{}: --below: there are no tetrahedra", self.mesh.display()).into());
        }
        let hidden = look.hide.iter().copied().collect();
        let part = Part { plane: look.cut, hidden, below: look.below.map(|below| below as f32) };
        Ok(Options {
            size: look.size,
            view: look.view.map(|view| view.0),
            at: look.at.map(|at| at.0),
            zoom: look.zoom,
            colour: self.colour(scene, &part)?,
            part,
            range: look.range.map(|range| range.0),
            wire: !look.no_wire,
        })
    }

    fn colour(&self, scene: &Scene<'_>, part: &Part) -> Result<Colour, Failure> {
        let fields = &scene.given.fields;
        let Some(by) = &self.look.color else {
            let measured = self.metric.is_some() || self.analytic.is_some();
            return Ok(if !self.field.is_empty() {
                Colour::Field(0)
            } else if part.plane.is_some() || part.below.is_some() || measured {
                Colour::Quality
            } else {
                Colour::Reference
            });
        };
        match by.as_str() {
            "reference" => return Ok(Colour::Reference),
            "quality" => return Ok(Colour::Quality),
            "field" if !self.field.is_empty() => return Ok(Colour::Field(0)),
            _ => {}
        }
        if let Some(number) = fields.iter().position(|field| field.name == *by) {
            return Ok(Colour::Field(number));
        }
        let names = ["reference", "quality"].into_iter().chain(fields.iter().map(|field| field.name.as_str()));
        let names = names.collect::<Vec<_>>().join(", ");
        let remedy = match by.as_str() {
            "field" => "; give a --field",
            "distance" => "; give a --cad",
            "size" | "aspect" => "; give a --metric",
            _ => "",
        };
        Err(format!("--color: nothing is called '{by}'{remedy}; there are {names}").into())
    }
}

/// Fields that have names of their own.
fn named(team: Team<'_>, fields: &[NamedField]) -> Vec<ScalarField> {
    fields.iter().map(|field| ScalarField::of_values(team, &field.name, field.kind, &field.values)).collect()
}

/// Chords of a curve that is not straight.
const CHORDS: u32 = 96;

/// The edges of a model as polygons.
fn edges_of(model: &Model) -> Vec<Vec<Vec3>> {
    let mut evaluator = model.evaluator();
    let topology = model.topology();
    let edges = (0..topology.edges.len() as u32).filter(|&edge| topology.is_ridge(edge));
    edges
        .map(|edge| {
            let [first, last] = topology.edges[edge as usize].range;
            let along = |i: u32| first + (last - first) * f64::from(i) / f64::from(CHORDS);
            (0..=CHORDS).map(|i| evaluator.edge_frame(edge, along(i)).point).collect()
        })
        .collect()
}

fn row(name: &str, value: &str) -> [String; 2] {
    [name.into(), value.into()]
}

/// The figures of a mesh for its page.
fn figures(statistics: &Statistics) -> Vec<[String; 2]> {
    let (lengths, ratios) = (&statistics.edge_lengths, &statistics.mean_ratios);
    let mut rows = vec![
        row("vertices", &statistics.vertices.to_string()),
        row("tetrahedra", &statistics.tets.to_string()),
        row("triangles", &statistics.triangles.to_string()),
        row("tagged edges", &statistics.tagged_edges.to_string()),
    ];
    if statistics.tets > 0 {
        rows.push(row("volume", &figure(statistics.volume)));
        rows.push(row("mean ratio, least", &figure(ratios.min)));
        rows.push(row("mean ratio, mean", &figure(ratios.mean)));
        let unit = if statistics.metric.is_some() { "in the metric" } else { "model units" };
        for (what, value) in [("least", lengths.min), ("mean", lengths.mean), ("greatest", lengths.max)] {
            rows.push(row(&format!("edge length, {unit}, {what}"), &figure(value)));
        }
    }
    if let Some(metric) = &statistics.metric {
        rows.push(row("unit edges (1/√2 to √2)", &format!("{:.2} %", 100.0 * metric.unit_edges)));
        rows.push(row("complexity", &figure(metric.complexity)));
        rows.push(row("vertices / complexity", &figure(metric.vertices_per_complexity)));
    }
    rows
}
