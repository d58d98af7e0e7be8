//! What a run begins with: the mesh, where it lies on its model, and the metric.
use super::super::files::Files;
use super::super::files::reading::{self, Carrier};
use super::super::load;
use super::chords;
use super::field::FieldArguments;
use super::local::Locals;
use super::meet::Meeting;
use super::source::{How, Making, On, Raw};
use crate::adapt::beside::Beside;
use crate::cli::metric::common::Amount;
use crate::cli::metric::fields::MultiscaleArguments;
use crate::cli::metric::geometry::GeometryArguments;
use crate::cli::metric::wall::WALL;
use crate::cli::surface::SurfaceArguments;
use crate::cli::table::place;
use crate::formats::{Dataset, NamedField};
use crate::geometry::classify::{self, Classification};
use crate::geometry::discrete::complete_matched;
use crate::geometry::{Model, Names, on_mesh};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::crossing::{self, Crossings};
use crate::mesh::io::Read;
use crate::mesh::split_nonmanifold::{copy_values, split_nonmanifold};
use crate::mesh::stack::{Outside, Stack};
use crate::metric::{Source, Sym3};
use crate::sizing::chords::ChordLimit;
use crate::sizing::layer::Walls;
use crate::tasks::{Team, stage};
use std::path::PathBuf;
use std::sync::Arc;

/// What to do where a mesh that was taken apart does not fit its model.
const APART: &str = "The mesh hangs together in edges or vertices alone, where it was taken apart: on such a model each body needs edges and \
                     vertices of its own, as `geo-adapt bootstrap` writes it beside its mesh";

/// The inputs of a run.
#[derive(Clone, clap::Args)]
pub struct InputArguments {
    /// The mesh, in any format that `convert` reads
    pub mesh: PathBuf,
    /// The CAD model the boundary lies on: .step, .stp, .iges, .igs, .brep or .egads. Without it the surface of the input mesh
    #[arg(long, value_name = "MODEL")]
    pub cad: Option<PathBuf>,
    #[command(flatten)]
    pub surface: SurfaceArguments,
    #[command(flatten)]
    pub field: FieldArguments,
    #[command(flatten)]
    pub amount: Amount,
    /// How far a vertex of the input may be from the model, in its units
    #[arg(long, value_name = "T", value_parser = crate::cli::positive, allow_negative_numbers = true)]
    pub(super) tolerance: Option<f64>,
    /// Greatest size on a surface or in a region, by reference or name, or in a box: 3:h=0.01, inlet:h=0.02, region:2:h=0.05,
    /// box:X0,Y0,Z0,X1,Y1,Z1:h=0.1. With growth=1.2 behind it, it goes on around the surface or box, a fifth larger from an edge to the next: with
    /// the distance d the size is h + 0.2 d
    #[arg(long, value_name = "PLACE:h=H[,growth=G],…", allow_negative_numbers = true)]
    pub(super) local: Vec<Locals>,
    /// A wall, and the layers along it, whose sizes hold whatever the metric says. They are made anew on the mesh of each cycle
    #[arg(long = "wall", value_name = "WALL:h=H[,growth=G…],…", allow_negative_numbers = true, long_help = WALL)]
    pub(super) walls: Vec<Walls>,
    /// Cuts sizes along curved walls of the model to this share of √(8 h R), h the size across the wall and R its radius [without a value: 0.5]. The
    /// chord of that length has the sagitta h: longer edges dive through the layers, and no mesh meets such sizes. By default the metric of a file or
    /// a field is cut so on a CAD model where unit edges along its walls would dive through more than four layers; off leaves it
    #[arg(long, value_name = "SHARE|off", num_args = 0..=1, require_equals = true, default_missing_value = "0.5", value_parser = chords::parse, allow_negative_numbers = true)]
    pub(super) limit_chords: Option<ChordLimit>,
    #[command(
        flatten,
        next_help_heading = "The metric of --field or --goal (gradation and bounds of sizes: of --metric and --size too)"
    )]
    pub(super) multiscale: MultiscaleArguments,
    #[command(flatten)]
    pub(super) geometry: GeometryArguments,
    /// Leaves the geometry out, whose sizes are intersected when there is a --cad or a --surface
    #[arg(long, conflicts_with_all = ["segments", "feature_cells"])]
    pub(super) no_geometry: bool,
}

/// A mesh, with the metric at its vertices if it comes from a file.
pub struct Given {
    /// The mesh.
    pub mesh: TetMesh,
    /// Its cells that are no tetrahedra.
    pub stack: Stack,
    /// ln M at its vertices.
    pub logs: Option<Vec<Sym3>>,
    /// What its references are called, by its file or the one beside it.
    pub names: Names,
    /// The fields of its file.
    pub fields: Vec<NamedField>,
    /// Of the result of a cycle, which is manifold: whether its boundary crosses itself. None for a mesh of a file.
    pub result_crosses: Option<bool>,
}

/// All that the adapter needs.
pub struct Input {
    /// The mesh on its model.
    pub on: OnModel,
    /// The metric, of the complexity that is asked for.
    pub source: Source,
    /// What the metric was made of, where another may be wanted: with --vertices.
    pub raw: Option<Raw>,
}

/// A mesh on its model, before its metric is made.
pub(super) struct Placed {
    /// The mesh on its model.
    pub on: OnModel,
    /// What its metric is made of.
    pub raw: Raw,
    /// Its matched faces, until they are taken.
    pub faces: Option<MatchedFaces>,
}

impl Placed {
    /// The matched faces of the mesh.
    pub fn take_faces(&mut self, team: Team<'_>) -> MatchedFaces {
        self.faces.take().unwrap_or_else(|| MatchedFaces::of(team, &self.on.mesh.tets.nodes))
    }
}

/// A mesh on its model, and what is told of it.
pub struct OnModel {
    /// The mesh, its boundary complete; of a mesh that is read by slices the boundary.
    pub mesh: Arc<TetMesh>,
    /// Vertices and tetrahedra of the whole mesh.
    pub size: [usize; 2],
    /// Whether its boundary crosses itself.
    pub crosses: bool,
    /// Where it lies on the model.
    pub place: Classification,
    /// The model.
    pub model: Model,
    /// What the mesh's references are called, by the file beside it or else by the model.
    pub names: Names,
    /// How the metric was made.
    pub how: How,
    /// How the number of vertices was met that --vertices asks for.
    pub meeting: Option<Meeting>,
    /// The cells that are no tetrahedra: then the mesh is what lies beside them.
    pub beside: Option<Beside>,
}

pub(super) type Error = Box<dyn std::error::Error>;

impl InputArguments {
    /// Whether the model is given: it is no surface of the mesh itself.
    pub fn has_model(&self) -> bool {
        self.cad.is_some() || self.surface.surface.is_some()
    }

    /// Whether the metric of a field has the sizes of the geometry in it.
    pub(super) fn has_geometry(&self) -> bool {
        !self.field.field.is_empty() && self.has_model() && !self.no_geometry
    }

    /// The files that are read.
    ///
    /// # Errors
    /// When the file of --goal, which names some, cannot be read.
    pub fn files(&self) -> Result<Files, Error> {
        let Self { mesh, cad, surface, field, .. } = self;
        let of_goal = field.terms()?.map_or_else(Vec::new, |terms| terms.files());
        Ok(Files::new()
            .reads_meshes([mesh])
            .reads_models(cad)
            .reads_any(&surface.surface)
            .reads_fields(&field.metric, mesh)
            .reads_fields(&field.field, mesh)
            .reads(&field.goal)
            .reads_fields(of_goal, mesh))
    }

    /// Reads the mesh and, if it comes from a file, its metric. What the user should know is added to `notices`.
    pub fn read(&self, team: Team<'_>, notices: &mut Vec<String>) -> Result<Given, Error> {
        let Read { content, notices: found } = reading::mesh(team, &self.mesh)?;
        stage("mesh read");
        notices.extend(found);
        let mut logs = None;
        if let Some(asked) = &self.field.metric {
            let vertices = Some(content.mesh.vertices.len());
            let (read, _) = reading::logs(team, asked, Carrier::of(&self.mesh, &content), vertices)?;
            notices.extend(read.notices);
            logs = Some(read.content);
            stage("metric read");
        }
        let Dataset { mesh, stack, names, fields } = content;
        Ok(Given { mesh, stack, logs, names, fields, result_crosses: None })
    }

    /// Completes the boundary, puts the mesh on its model, and brings the metric to its complexity.
    /// `cad` is the model, when it is there already.
    pub fn prepare(
        &self,
        team: Team<'_>,
        given: Given,
        cad: Option<Model>,
        notices: &mut Vec<String>,
    ) -> Result<Input, Error> {
        let placed = self.placed(team, given, cad, notices)?;
        self.ready(team, placed, notices)
    }

    /// Completes the boundary, and puts the mesh on its model.
    pub(super) fn placed(
        &self,
        team: Team<'_>,
        given: Given,
        cad: Option<Model>,
        notices: &mut Vec<String>,
    ) -> Result<Placed, Error> {
        let Given { mut mesh, stack, mut logs, mut names, fields, result_crosses } = given;
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let added = complete_matched(team, &mut mesh, &faces);
        stage("boundary complete");
        if added > 0 {
            notices.push(format!("{added} triangles were missing on the boundary or between regions, and were added"));
        }
        let (crosses, copies) = match result_crosses {
            Some(crosses) => (crosses, Vec::new()),
            None => {
                let crosses = self.tell_crossings(team, &mesh, &faces, notices);
                (crosses, self.take_apart(team, &mut mesh, &faces, notices)?)
            }
        };
        if !stack.is_empty() && !copies.is_empty() {
            return Err(format!("{}: a mesh with {} must not be pinched so", self.mesh.display(), stack.told()).into());
        }
        logs.iter_mut().for_each(|logs| copy_values(logs, &copies));
        let outside = (!stack.is_empty()).then(|| Outside::of(&stack, &mut mesh));
        let (model, mut place) = self.place(team, &mesh, cad, notices).map_err(|error| match copies.is_empty() {
            true => error,
            false => format!("{error}. {APART}").into(),
        })?;
        stage("classified");
        if names.is_empty() {
            names = on_mesh(&mesh, &place, &model);
        }
        let (mut faces, mut beside) = (faces, None);
        if let Some(outside) = outside {
            let found = self.beside(team, (stack, outside), mesh, place, &model)?;
            (mesh, place, beside) = (found.0, found.1, Some(found.2));
            faces = MatchedFaces::of(team, &mesh.tets.nodes);
        }
        let mesh = Arc::new(mesh);
        let raw = Raw { logs, copies, fields };
        let size = [mesh.vertices.len(), mesh.tets.len()];
        let how = How::default();
        let on = OnModel { mesh, size, crosses, place, model, names, how, meeting: None, beside };
        Ok(Placed { on, raw, faces: Some(faces) })
    }

    /// Brings the metric to its complexity, on a mesh on its model.
    pub(super) fn ready(&self, team: Team<'_>, mut placed: Placed, notices: &mut Vec<String>) -> Result<Input, Error> {
        let (source, how) = self.metric(team, &mut placed, notices)?;
        let Placed { mut on, raw, .. } = placed;
        on.how = how;
        Ok(Input { on, source, raw: self.amount.vertices.is_some().then_some(raw) })
    }

    /// The metric of its complexity on a mesh on its model, and how it was made.
    pub(super) fn metric(
        &self,
        team: Team<'_>,
        placed: &mut Placed,
        notices: &mut Vec<String>,
    ) -> Result<(Source, How), Error> {
        let faces = placed.take_faces(team);
        let Placed { on: OnModel { mesh, place, model, names, beside, .. }, raw, .. } = placed;
        let on = On { place, model, names, beside: beside.as_ref() };
        self.source(team, (mesh, faces), raw, on, (self.amount.complexity(), notices))
    }

    /// Tells where the boundary of the mesh passes through itself. Returns whether it does.
    fn tell_crossings(&self, team: Team<'_>, mesh: &TetMesh, faces: &MatchedFaces, notices: &mut Vec<String>) -> bool {
        let crossings = crossing::of_boundary(team, mesh, faces, 1);
        notices.extend(self.crossings_told(&crossings));
        stage("boundary held against itself");
        crossings.count > 0
    }

    /// What is told of crossings, if there are some.
    pub(super) fn crossings_told(&self, crossings: &Crossings) -> Option<String> {
        let first = crossings.first.first()?;
        Some(format!(
            "the boundary of {} crosses itself: {} pairs of triangles, the first at {}; `geo-adapt inspect` names them, and adapting need \
             not mend them",
            self.mesh.display(),
            crossings.count,
            place(first.at)
        ))
    }

    /// The metric made again, of another complexity, cut along walls as it was.
    pub fn source_of(&self, team: Team<'_>, input: &Input, complexity: f64) -> Result<(Source, How), Error> {
        let Input { on: OnModel { mesh, place, model, names, beside, how, .. }, raw, .. } = input;
        let on = On { place, model, names, beside: beside.as_ref() };
        let none = Raw::default();
        let (raw, share) = (raw.as_ref().unwrap_or(&none), how.chords.map(|chords| chords.share));
        let making = Making { mesh, raw, on, share, complexity: Some(complexity) };
        // What there is to say was said of the first.
        let mut made = self.scaled(team, making, MatchedFaces::of(team, &mesh.tets.nodes), &mut Vec::new())?;
        // On a draft the metric of a field is interpolated: how it was made is known of the first mesh.
        let How { made: before, goal, drafts, .. } = how.clone();
        made.1 = How { made: made.1.made.or(before), goal: made.1.goal.or(goal), drafts, ..made.1 };
        Ok(self.beside_stack(team, mesh, on, made))
    }

    /// Takes the mesh apart where it hangs together in edges or vertices alone: the new vertices' origins.
    fn take_apart(
        &self,
        team: Team<'_>,
        mesh: &mut TetMesh,
        faces: &MatchedFaces,
        notices: &mut Vec<String>,
    ) -> Result<Vec<u32>, Error> {
        let copies =
            split_nonmanifold(team, mesh, faces).map_err(|error| format!("{}: {error}", self.mesh.display()))?;
        stage("taken apart");
        if let Some(first) = copies.iter().min() {
            let at = place(mesh.vertices[*first as usize]);
            notices.push(format!(
                "the mesh hangs together in edges or vertices alone, the first is vertex {} at {at}: each side has vertices of its own \
                 there now, {} more",
                first + 1,
                copies.len()
            ));
        }
        Ok(copies)
    }

    /// The model, and where the mesh lies on it.
    pub(super) fn place(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        cad: Option<Model>,
        notices: &mut Vec<String>,
    ) -> Result<(Model, Classification), Error> {
        let name = self.mesh.display();
        let Some(path) = self.cad.as_ref().or(self.surface.surface.as_ref()) else {
            return Ok(self.surface.own(team, mesh).map_err(|error| format!("{name}: {error}"))?);
        };
        let given = match (cad, &self.cad) {
            (Some(model), _) => Some(model),
            (None, Some(path)) => Some(load::model(path)?),
            (None, None) => self.surface.model(team, notices)?,
        };
        let Some(mut model) = given else { return Err(format!("{}: no model", path.display()).into()) };
        let options = classify::Options { tolerance: self.tolerance, ..classify::Options::default() };
        let (place, report) = classify::classify(team, mesh, &model, &options)
            .map_err(|error| format!("{name} on {}: {error}", path.display()))?;
        model.adopt_references(mesh, &place);
        // What a file says of numbers is said of a CAD model's: a surface has none that last.
        notices.extend(report.notices.into_iter().filter(|_| self.cad.is_some()));
        Ok((model, place))
    }
}
