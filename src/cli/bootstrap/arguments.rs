//! What can be asked of `geo-adapt bootstrap`.
use super::rung::Choice;
use super::triangles::is_surface;
use super::{domain, heal};
use crate::cli::adapt::files::Targets;
use crate::cli::figures::FigureArguments;
use crate::cli::files::{Files, JSON, Target};
use crate::cli::metric::geometry::GeometryArguments;
use crate::cli::surface::ridge_angle;
use crate::cli::workplace::Workplace;
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, DiscreteOptions};
use std::path::PathBuf;

/// Help on --far-field.
const FAR_FIELD: &str = "Mesh the space around the solids instead, for external flow: box:XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or box:FACTOR \
(so many extents of the body beyond it on all sides), sphere:RADIUS (about the body's middle) or sphere:X,Y,Z,RADIUS, without them. Its \
faces are called farfield, those of the body as in the model, else wall. This domain is written beside the mesh as .brep, with its names \
as .names.json, for `adapt --cad`. On the body sizes are at most a tenth of its diagonal";

/// Help on --heal.
const HEAL: &str = "Heal the model first: edges shorter than this length (model units) are collapsed, narrower faces merged into their neighbours, \
and where there is no solid faces are sewn across gaps as wide as that. What was done is told, and the healed model is written beside the mesh as \
.brep, with its names as .names.json, for `adapt --cad` [default length: a ten-thousandth of the diagonal]";

/// The model that is made, in the workplace until it is written with the mesh: a far field, or a healed model.
pub const DOMAIN: &str = "domain.brep";
/// The healed model that a far field is made of.
pub const HEALED: &str = "healed.brep";

/// Arguments of `geo-adapt bootstrap`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model, of one or several solids: .step, .stp, .iges, .igs, .brep or .egads; or a closed surface of triangles: .stl, .obj, .ply, or
    /// the boundary of a mesh, .mesh, .meshb, .vtu, .msh
    pub model: PathBuf,
    /// Where the mesh goes, in any format that `convert` writes; its metric is in the file or beside it as .solb, what the mesher said beside it
    /// as .log
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    pub output: PathBuf,
    /// Greatest size, in model units [default: a tenth of the diagonal of the model's box]
    #[arg(long, value_name = "H", value_parser = crate::cli::positive, allow_negative_numbers = true)]
    pub size: Option<f64>,
    #[command(flatten)]
    pub sizes: GeometryArguments,
    /// Greatest complexity, about half the number of vertices: where the geometry asks for more its sizes are enlarged
    #[arg(long, value_name = "C", value_parser = crate::cli::positive, default_value = "100000", allow_negative_numbers = true)]
    pub complexity: f64,
    /// Most vertices: a mesh that has so many gets no more, is finished as it is and written, and the exit code is 3 [default: as many as there
    /// is memory for]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true, conflicts_with = "no_adapt")]
    pub max_vertices: Option<u32>,
    /// Mesh the space around the solids instead, for external flow: a box or a sphere without them
    #[arg(long, value_name = "box:…|sphere:…", long_help = FAR_FIELD)]
    pub far_field: Option<domain::Spec>,
    /// The body is one half: cut the far field at the plane face where the body ends in this direction, and call that symmetry
    #[arg(long, value_enum, value_name = "AXIS", requires = "far_field")]
    pub symmetry: Option<domain::Axis>,
    /// Heal the model first: what is smaller than a length is no part of it
    #[arg(long, value_name = "LENGTH", num_args = 0..=1, require_equals = true, default_missing_value = "-", long_help = HEAL)]
    pub heal: Option<heal::Length>,
    /// Leave the mesh as the mesher made it; our own makes few vertices, whatever the sizes
    #[arg(long, conflicts_with_all = ["report", "json"])]
    pub no_adapt: bool,
    /// Who makes the mesh that is adapted
    #[arg(long, value_enum, default_value_t = Choice::default())]
    pub mesher: Choice,
    /// Seconds that all attempts at a mesh may take together, without waiting for a busy machine; each a third of them at first
    #[arg(long, value_name = "S", value_parser = crate::cli::positive, default_value = "120", allow_negative_numbers = true)]
    pub time_limit: f64,
    /// Of a surface of triangles: angle in degrees between them beyond which their edge is a ridge; or `none` [default: 45]
    #[arg(long, value_name = "DEG", value_parser = ridge_angle, allow_negative_numbers = true)]
    ridge_angle: Option<f64>,
    /// Of a surface of triangles: these are taken as they are, flat; else smooth patches go through their vertices, unless those do not fit
    #[arg(long)]
    flat_surface: bool,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub figures: FigureArguments,
}

impl Arguments {
    /// The files that are written, refused before the work where that would fail after it: those of the mesh, and the mesher's log.
    pub fn targets(&self, place: &Workplace) -> Result<(Targets, Target), String> {
        let mut files = if is_surface(&self.model) {
            Files::new().reads_any([&self.model])
        } else {
            Files::new().reads_models([&self.model])
        };
        let mut targets = Targets::of(&mut files, &self.output, &self.figures, JSON)?;
        let log = files.writes(&self.output.with_extension("log"), "the log beside -o", &[])?;
        if self.far_field.is_some() || self.heal.is_some() {
            let domain = files.writes(&self.output.with_extension("brep"), "the model beside -o", &[])?;
            targets.with_model(place.file(DOMAIN), domain);
        }
        Ok((targets, log))
    }

    /// Refuses what is said of triangles where the model is no surface of them.
    pub fn check_cad(&self) -> Result<(), String> {
        let option = match (self.ridge_angle, self.flat_surface) {
            (Some(_), _) => "--ridge-angle",
            (None, true) => "--flat-surface",
            (None, false) => return Ok(()),
        };
        Err(format!("{}: {option} is for a surface of triangles; leave it out", self.model.display()))
    }

    /// How triangles become a model.
    pub fn patches(&self) -> DiscreteOptions {
        DiscreteOptions { ridge_angle_deg: self.ridge_angle.unwrap_or(DEFAULT_RIDGE_ANGLE), smooth: !self.flat_surface }
    }

    pub fn limits(&self) -> crate::metric::Limits {
        crate::metric::Limits { hmax: self.size, ..Default::default() }
    }
}
