//! What a run begins with: the mesh, where it lies on its model, and the metric.
use super::super::files::Files;
use super::super::files::reading::{self, Carrier};
use super::super::load;
use super::super::names::on_mesh;
use super::field::FieldArguments;
use super::parts::{self, Local};
use crate::adapt;
use crate::cli::metric::fields::{Made, MultiscaleArguments};
use crate::cli::metric::geometry::GeometryArguments;
use crate::cli::surface::SurfaceArguments;
use crate::cli::table::place;
use crate::formats::{Dataset, NamedField};
use crate::geometry::classify::{self, Classification};
use crate::geometry::discrete::complete_matched;
use crate::geometry::{Model, Names};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::io::Read;
use crate::mesh::split_nonmanifold::{copy_values, split_nonmanifold};
use crate::mesh::{TetMesh, crossing};
use crate::metric::held::GREATEST_RATIO;
use crate::metric::multiscale::{Bounds, Measure, bounded, diameter};
use crate::metric::{self, Background, Interpolation, Limits, Source, Sym3, field, grade, restrict};
use crate::sizing;
use crate::tasks::{Team, stage};
use std::path::PathBuf;
use std::sync::Arc;

/// The greatest complexity: a unit of it has twelve tetrahedra, ids have 32 bits, and some ids are not used.
const GREATEST_COMPLEXITY: f64 = 2e8;

/// The sizes of the geometry take at most this share of the complexity, so that some is left for the field.
const GEOMETRY_SHARE: f64 = 0.5;

/// What to do where a mesh that was taken apart does not fit its model.
const APART: &str = "The mesh hangs together in edges or vertices alone, where it was taken apart: on such a model each body needs edges and \
                     vertices of its own, as `geo-adapt bootstrap` writes it beside its mesh";

/// The inputs of a run.
#[derive(clap::Args)]
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
    /// Scale the metric to this complexity: about half the number of vertices
    #[arg(long, value_name = "C", value_parser = crate::cli::positive, allow_negative_numbers = true)]
    pub complexity: Option<f64>,
    /// How far a vertex of the input may be from the model, in its units
    #[arg(long, value_name = "T", value_parser = crate::cli::positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Greatest size on a surface or in a region, by reference or name: 3:h=0.01, inlet:h=0.02, region:2:h=0.05
    #[arg(long, value_name = "REF:h=H,…", value_delimiter = ',', allow_negative_numbers = true)]
    local: Vec<Local>,
    #[command(flatten, next_help_heading = "The metric of --field (gradation and bounds of sizes: of --metric too)")]
    multiscale: MultiscaleArguments,
    #[command(flatten)]
    geometry: GeometryArguments,
    /// Leaves the geometry out, whose sizes are intersected when there is a --cad or a --surface
    #[arg(long, conflicts_with_all = ["segments", "feature_cells"])]
    no_geometry: bool,
}

/// A mesh, with the metric at its vertices if it comes from a file.
pub struct Given {
    /// The mesh.
    pub mesh: TetMesh,
    /// ln M at its vertices.
    pub logs: Option<Vec<Sym3>>,
    /// What its references are called, by its file or the one beside it.
    pub names: Names,
    /// The fields of its file.
    pub fields: Vec<NamedField>,
    /// Whether it is the result of a cycle: manifold, and with a report that tells where its boundary crosses itself.
    pub is_result: bool,
}

/// All that the adapter needs.
pub struct Input {
    /// The mesh, its boundary complete.
    pub mesh: Arc<TetMesh>,
    /// Where it lies on the model.
    pub place: Classification,
    /// The model.
    pub model: Model,
    /// The metric, of the complexity that is asked for.
    pub source: Source,
    /// How it was made, from a field.
    pub made: Option<Made>,
    /// What the mesh's references are called, by the file beside it or else by the model.
    pub names: Names,
}

type Error = Box<dyn std::error::Error>;

impl InputArguments {
    /// Whether the model is given: it is no surface of the mesh itself.
    pub fn has_model(&self) -> bool {
        self.cad.is_some() || self.surface.surface.is_some()
    }

    /// The files that are read.
    pub fn files(&self) -> Files {
        let Self { mesh, cad, surface, field, .. } = self;
        Files::new()
            .reads_meshes([mesh])
            .reads_models(cad)
            .reads_any(&surface.surface)
            .reads_fields(&field.metric, mesh)
            .reads_fields(&field.field, mesh)
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
        let Dataset { mesh, names, fields } = content;
        Ok(Given { mesh, logs, names, fields, is_result: false })
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
        let Given { mut mesh, mut logs, mut names, fields, is_result } = given;
        let faces = MatchedFaces::of(team, &mesh.tets.nodes);
        let added = complete_matched(team, &mut mesh, &faces);
        stage("boundary complete");
        if added > 0 {
            notices.push(format!("{added} triangles were missing on the boundary or between regions, and were added"));
        }
        if !is_result {
            self.tell_crossings(team, &mesh, &faces, notices);
        }
        let copies = if is_result { Vec::new() } else { self.take_apart(team, &mut mesh, &faces, notices)? };
        logs.iter_mut().for_each(|logs| copy_values(logs, &copies));
        let mesh = Arc::new(mesh);
        let (model, place) = self.place(team, &mesh, cad, notices).map_err(|error| match copies.is_empty() {
            true => error,
            false => format!("{error}. {APART}").into(),
        })?;
        stage("classified");
        if names.is_empty() {
            names = on_mesh(&mesh, &place, &model);
        }
        let (mut source, made) =
            self.source(team, (&mesh, faces, &copies), (logs, &fields), (&place, &model, &names), notices)?;
        stage("metric ready");
        if source.cut() > 0 {
            notices.push(format!(
                "sizes of more than {GREATEST_RATIO:.0e} times the least at the same vertex were cut to that at {} vertices: a tensor of \
                 doubles does not hold them",
                source.cut()
            ));
        }
        self.scale(team, &mesh, &mut source, made.is_some())?;
        stage("complexity");
        Ok(Input { mesh, place, model, source, made, names })
    }

    /// Tells where the boundary of the mesh passes through itself.
    fn tell_crossings(&self, team: Team<'_>, mesh: &TetMesh, faces: &MatchedFaces, notices: &mut Vec<String>) {
        let crossings = crossing::of_boundary(team, mesh, faces, 1);
        if let [first] = &crossings.first[..] {
            notices.push(format!(
                "the boundary of {} crosses itself: {} pairs of triangles, the first at {}; `geo-adapt inspect` names them, and adapting \
                 need not mend them",
                self.mesh.display(),
                crossings.count,
                place(first.at)
            ));
        }
        stage("boundary held against itself");
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

    /// The metric's source: the analytic field, or the mesh as background with the metric of a file or the one made from a field; and
    /// what was done to make it.
    fn source(
        &self,
        team: Team<'_>,
        (mesh, faces, copies): (&Arc<TetMesh>, MatchedFaces, &[u32]),
        (logs, fields): (Option<Vec<Sym3>>, &[NamedField]),
        on: (&Classification, &Model, &Names),
        notices: &mut Vec<String>,
    ) -> Result<(Source, Option<Made>), Error> {
        if let Some(field) = self.field.analytic {
            return Ok((Source::Analytic { field, log_scale: 0.0 }, None));
        }
        let named = |error: String| format!("{}: {error}", self.mesh.display());
        if mesh.tets.is_empty() {
            return Err(named(adapt::Error::Empty.to_string()).into());
        }
        let (logs, made) = match logs {
            Some(logs) if !self.is_bounded() => (logs, None),
            Some(logs) => (self.bounded(team, mesh, on.2, logs).map_err(named)?, None),
            None => {
                let complexity = self.complexity.ok_or("--field needs a --complexity")?;
                let fixed = self.fixed(team, mesh, on, complexity, notices).map_err(named)?;
                let wanted = (complexity, Measure::Between(Interpolation::default()));
                let vertices = &mesh.vertices[..mesh.vertices.len() - copies.len()];
                let asked = (&self.field.field[..], Carrier { path: &self.mesh, vertices, fields });
                let (logs, made) =
                    self.multiscale.make(team, (mesh, copies), asked, wanted, fixed.as_deref(), notices)?;
                (logs, Some(made))
            }
        };
        Ok((Source::Background(Background::on(team, Arc::clone(mesh), faces, logs)), made))
    }

    /// Whether the metric of a file is to be changed by more than a scale.
    fn is_bounded(&self) -> bool {
        !self.local.is_empty() || self.multiscale.bounds_are_given()
    }

    /// ln of the metric of a file within the bounds that are given, graded, and of the complexity that is asked for.
    fn bounded(&self, team: Team<'_>, mesh: &TetMesh, names: &Names, mut logs: Vec<Sym3>) -> Result<Vec<Sym3>, String> {
        let (limits, gradation) = (self.multiscale.limits()?, self.multiscale.growth());
        let fixed = self.local_sizes(team, mesh, names)?;
        let complexity = self.complexity.unwrap_or(1.0);
        let bounds = Bounds {
            complexity,
            measure: Measure::Between(Interpolation::default()),
            gradation,
            limits,
            fixed: fixed.as_deref(),
        };
        if self.complexity.is_some() {
            return bounded(team, mesh, &logs, &bounds).map(|found| found.0).map_err(|error| error.to_string());
        }
        bounds.apply(team, &mut logs);
        if let Some(ratio) = gradation {
            grade(team, mesh, &mut logs, ratio);
        }
        Ok(logs)
    }

    /// ln of the metric that the local sizes ask for, with very large sizes elsewhere; none without local sizes.
    fn local_sizes(&self, team: Team<'_>, mesh: &TetMesh, names: &Names) -> Result<Option<Vec<Sym3>>, String> {
        if self.local.is_empty() {
            return Ok(None);
        }
        let mut logs = vec![Sym3::ZERO.plus_identity(-2.0 * diameter(team, mesh).ln()); mesh.vertices.len()];
        parts::apply(&self.local, mesh, names, &mut logs)?;
        Ok(Some(logs))
    }

    /// ln of the metric that holds whatever the field says: that of the geometry, on a CAD model, and of the local sizes.
    fn fixed(
        &self,
        team: Team<'_>,
        mesh: &TetMesh,
        (place, model, names): (&Classification, &Model, &Names),
        complexity: f64,
        notices: &mut Vec<String>,
    ) -> Result<Option<Vec<Sym3>>, String> {
        if !self.has_model() || self.no_geometry {
            return self.local_sizes(team, mesh, names);
        }
        let gradation = self.multiscale.growth();
        let options = self.geometry.options(model, self.multiscale.limits()?, None);
        let (raw, _) = sizing::geometry_metric(team, mesh, place, model, &options);
        let mut logs = raw.clone();
        if let Some(ratio) = gradation {
            grade(team, mesh, &mut logs, ratio);
            restrict(team, mesh, &mut logs, ratio);
        }
        let own = field::complexity_between(team, mesh, &logs);
        let most = GEOMETRY_SHARE * complexity;
        if own > most {
            let limits = Limits::default();
            let bounds = Bounds {
                complexity: most,
                measure: Measure::Between(Interpolation::default()),
                gradation,
                limits,
                fixed: None,
            };
            logs = bounded(team, mesh, &raw, &bounds).map_err(|error| format!("the geometry's metric: {error}"))?.0;
            notices.push(format!(
                "the geometry alone asks for a complexity of {own:.0}: its sizes are enlarged, to leave half of {complexity} to \
                 the field (a greater --complexity keeps them, --no-geometry leaves them out)"
            ));
        }
        parts::apply(&self.local, mesh, names, &mut logs)?;
        stage("geometry");
        Ok(Some(logs))
    }

    /// Scales the source to the complexity asked for, unless it was made for that. Refuses a complexity that no mesh can have.
    fn scale(&self, team: Team<'_>, mesh: &TetMesh, source: &mut Source, is_made: bool) -> Result<(), String> {
        let named = |error: metric::Error| format!("{}: {error}", self.mesh.display());
        source.check(team, mesh).map_err(named)?;
        if self.complexity.is_none() && source.complexity_bound(team, mesh) <= GREATEST_COMPLEXITY {
            return Ok(());
        }
        let own = source.complexity(team, mesh);
        if !(own > 0.0 && own.is_finite()) {
            return Err(format!(
                "{}: the metric's complexity on this mesh is {own}; are mesh and metric in the same units?",
                self.mesh.display()
            ));
        }
        if let Some(target) = self.complexity.filter(|_| !is_made && !self.is_bounded()) {
            source.scale(team, field::complexity_factor(own, target).ln());
        }
        let complexity = self.complexity.unwrap_or(own);
        if complexity <= GREATEST_COMPLEXITY {
            return Ok(());
        }
        let remedy = match self.complexity {
            Some(_) => "give a smaller --complexity",
            None => "are mesh and metric in the same units? else give a --complexity",
        };
        let [vertices, most] = [2.0 * complexity, 2.0 * GREATEST_COMPLEXITY];
        Err(format!(
            "{}: the metric asks for about {vertices:.0e} vertices, more than the {most:.0e} of the largest mesh; {remedy}",
            self.mesh.display()
        ))
    }

    /// The model, and where the mesh lies on it.
    fn place(
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
