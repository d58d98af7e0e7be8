//! `geo-adapt view`.
mod figures;
mod given;
mod look;
mod model;
mod options;

use super::files::reading;
use super::files::{Files, Outputs, Target};
use super::metric::common::{Failure, RunArguments};
use super::surface::SurfaceArguments;
use crate::formats::Dataset;
use crate::metric::Analytic;
use crate::tasks::{Plan, Team, stage};
use crate::view::picture::{self, Options};
use crate::view::{Given, Scene};
use look::LookArguments;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt view`.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("written").required(true).multiple(true).args(["output", "png"])))]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads; names of the references of .mesh and .meshb may lie beside as MESH.names.json. Or a CAD
    /// model, whose faces are shown with their numbers: .step, .stp, .iges, .igs, .brep or .egads
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
    /// The metric at the mesh's vertices that shapes are measured in: .sol or .solb, the name of one in the mesh's file, or none [default: the
    /// one beside the mesh, MESH.solb, where there is one]
    #[arg(long, value_name = "FILE", conflicts_with = "analytic")]
    metric: Option<PathBuf>,
    /// An analytic metric field
    #[arg(long, value_name = "NAME")]
    analytic: Option<Analytic>,
    /// Fields at the mesh's vertices to colour by: .sol or .solb, their names beside as FIELD.names.json, .csv or .dat, or the name of one in
    /// the mesh's file; may be given several times. Without it the page has those of the mesh's file
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
    let (data, mut given) = arguments.read(team)?;
    let mesh = &data.mesh;
    if mesh.tets.is_empty() && mesh.triangles.is_empty() {
        let name = arguments.mesh.display();
        return Err(format!("{name}: neither tetrahedra nor triangles: there is nothing to show").into());
    }
    let file = arguments.mesh.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    given.title = arguments.look.title.clone().unwrap_or(file);
    stage("measured");
    let scene = Scene::new(team, mesh, given);
    stage("scene");
    let options = arguments.options(&scene)?;
    if let Some(message) = picture::nothing_cut(team, &scene, &options) {
        arguments.run.note(&[message]);
    }
    arguments.write([page, picture], team, &scene, &options)?;
    Ok(ExitCode::SUCCESS)
}

type Outcome = Result<ExitCode, Failure>;

impl Arguments {
    /// Page and picture, as far as they are asked for.
    fn targets(&self) -> Result<[Option<Target>; 2], String> {
        let files = if model::is_model(&self.mesh) {
            Files::new().reads_models([&self.mesh])
        } else {
            Files::new().reads_meshes([&self.mesh]).reads(self.metric_beside())
        };
        let files = files.reads_models(&self.cad).reads_any(&self.surface.surface);
        let mut files = files.reads_fields(&self.metric, &self.mesh).reads_fields(&self.field, &self.mesh);
        let mut target = |path: &Option<PathBuf>, by: &str, ending: &str| {
            path.as_ref().map(|path| files.writes(path, by, &[ending])).transpose()
        };
        Ok([target(&self.output, "-o", "html")?, target(&self.png, "--png", "png")?])
    }

    /// What is shown, and what comes with it.
    fn read(&self, team: Team<'_>) -> Result<(Dataset, Given), Failure> {
        if model::is_model(&self.mesh) {
            let has_model = self.cad.is_some() || self.surface.surface.is_some();
            if self.metric.is_some() || self.analytic.is_some() || !self.field.is_empty() || has_model {
                let name = self.mesh.display();
                let message =
                    "a model is shown by itself; --metric, --analytic, --field, --cad and --surface go with a mesh";
                return Err(format!("{name}: {message}").into());
            }
            let (mesh, given, notices) = model::read(&self.mesh)?;
            self.run.note(&notices);
            return Ok((Dataset { mesh, ..Dataset::default() }, given));
        }
        let read = reading::mesh(team, &self.mesh)?;
        self.run.note(&read.notices);
        stage("mesh read");
        let given = self.given(team, &read.content)?;
        Ok((read.content, given))
    }

    fn write(
        &self,
        [page, picture]: [Option<Target>; 2],
        team: Team<'_>,
        scene: &Scene<'_>,
        options: &Options,
    ) -> Result<(), Failure> {
        let mut outputs = Outputs::new();
        if let Some(page) = &page {
            outputs.page(team, page, scene, options)?;
            stage("page written");
        }
        if let Some(picture) = &picture {
            outputs.picture(team, picture, scene, options)?;
            stage("picture written");
        }
        outputs.commit()?;
        for path in [&self.output, &self.png].into_iter().flatten() {
            let megabytes = std::fs::metadata(path).map_or(0.0, |file| file.len() as f64 / 1e6);
            self.run.print(&format!("{}: {megabytes:.2} MB\n", path.display()))?;
        }
        Ok(())
    }
}
