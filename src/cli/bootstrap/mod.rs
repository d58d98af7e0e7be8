//! `geo-adapt bootstrap`: the first mesh of a model.
//!
//! A mesher that is started as a program makes some valid mesh of the model (`ladder`), and our own kernel adapts it to the metric of the
//! geometry (`refine`). The model goes to the mesher as we have it in memory, so that its numbers of faces, edges and solids are ours.
pub mod domain;
mod driver;
mod gmsh;
mod ladder;
mod netgen;
mod process;
mod queue;
mod refine;

use super::adapt::INTERRUPTED;
use super::adapt::files::Targets;
use super::adapt::progress::stop_on_interrupt;
use super::adapt::report::Asked;
use super::files::{Files, JSON, Target};
use super::metric::geometry::GeometryArguments;
use super::workplace::Workplace;
use super::{Outcome, load};
use crate::geometry::classify::associate;
use crate::geometry::{Evaluate, Geometry, Model, Topology};
use crate::mesh::vector::distance;
use crate::tasks::{Plan, Pool, Team, stage};
use driver::Choice;
use ladder::{Ladder, Meshed, Wish};
use refine::Refined;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Help on --far-field.
const FAR_FIELD: &str = "Mesh the space around the solids instead, for external flow: box:XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or box:FACTOR \
(so many extents of the body beyond it on all sides), sphere:RADIUS (about the body's middle) or sphere:X,Y,Z,RADIUS, without them. Its \
faces are called farfield, those of the body as in the model, else wall. This domain is written beside the mesh as .brep, with its names \
as .names.json, for `adapt --cad`. On the body sizes are at most a tenth of its diagonal";

/// Arguments of `geo-adapt bootstrap`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model, of one or several solids: .step, .stp, .iges, .igs, .brep or .egads
    model: PathBuf,
    /// Where the mesh goes: .mesh or .meshb; its metric is written beside it as .solb, what the mesher said as .log
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// Greatest size, in model units [default: a tenth of the diagonal of the model's box]
    #[arg(long, value_name = "H", value_parser = super::positive, allow_negative_numbers = true)]
    size: Option<f64>,
    #[command(flatten)]
    sizes: GeometryArguments,
    /// Greatest complexity, about half the number of vertices: where the geometry asks for more its sizes are enlarged
    #[arg(long, value_name = "C", value_parser = super::positive, default_value = "100000", allow_negative_numbers = true)]
    complexity: f64,
    /// Mesh the space around the solids instead, for external flow: a box or a sphere without them
    #[arg(long, value_name = "box:…|sphere:…", long_help = FAR_FIELD)]
    far_field: Option<domain::Spec>,
    /// The body is one half: cut the far field at the plane face where the body ends in this direction, and call that symmetry
    #[arg(long, value_enum, value_name = "AXIS", requires = "far_field")]
    symmetry: Option<domain::Axis>,
    /// Leave the mesh as the mesher made it
    #[arg(long)]
    no_adapt: bool,
    /// Who makes the mesh that is adapted; by default gmsh, and netgen where gmsh fails
    #[arg(long, value_enum, default_value_t = Choice::default())]
    mesher: Choice,
    /// Seconds that one run of the mesher may take, without waiting for a busy machine; a third of them at first, all where nothing else
    /// made a mesh
    #[arg(long, value_name = "S", value_parser = super::positive, default_value = "120", allow_negative_numbers = true)]
    time_limit: f64,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Write what was done as JSON
    #[arg(long, value_name = "FILE.json", conflicts_with = "no_adapt")]
    report: Option<PathBuf>,
    /// No progress and no table; errors only
    #[arg(short, long)]
    quiet: bool,
}

/// The domain of a far field, until it is written with the mesh.
const DOMAIN: &str = "domain.brep";

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let place = Workplace::new().map_err(|error| format!("no folder for the mesher's files: {error}"))?;
    let (targets, log) = arguments.targets(&place)?;
    let threads = arguments.threads.map_or_else(super::cores, usize::from);
    let pool = Pool::new(threads)?;
    let team = Team::new(&pool, Plan::default());
    let domain = arguments.far_field.as_ref();
    let domain = domain.map(|spec| domain::build(&arguments.model, spec, arguments.symmetry, &place.file(DOMAIN)));
    let domain = domain.transpose()?;
    let path = domain.as_ref().unwrap_or(&arguments.model);
    let model = load::model(path)?;
    check_solids(path, &model)?;
    stage("model read");
    let options = arguments.sizes.options(&model, arguments.limits(), None);
    let wish = Wish {
        greatest: options.greatest,
        least: options.least.max(LEAST * small_face(model.topology())),
        diagonal: model.topology().diagonal(),
        segments: options.segments,
        stop: stop_on_interrupt(),
        limit: Duration::try_from_secs_f64(arguments.time_limit).unwrap_or(Duration::MAX),
    };
    let named = |error: String| format!("{}: {error}", arguments.model.display());
    let mut ladder = Ladder::new(team, &model, &wish, arguments.mesher, (&place, log.path())).map_err(named)?;
    let ended = |error: String| -> Outcome {
        if !wish.stop.load(Ordering::Relaxed) {
            return Err(named(error).into());
        }
        super::tell(format_args!("geo-adapt: error: {}", named(error)));
        Ok(ExitCode::from(INTERRUPTED))
    };
    if arguments.no_adapt {
        return match ladder.climb() {
            Ok(meshed) => arguments.write_as_it_is(&meshed, &model, &targets),
            Err(error) => ended(error),
        };
    }
    let asked =
        Asked { input: arguments.model.clone(), output: arguments.output.clone(), threads, complexity_wanted: None };
    let mut best: Option<Refined> = None;
    for rest in (0..TRIALS).rev() {
        let meshed = match ladder.climb() {
            Ok(meshed) => meshed,
            Err(_) if best.is_some() => break,
            Err(error) => return ended(error),
        };
        stage("meshed");
        let by = meshed.by;
        let refined = refine::run(arguments, &pool, meshed, &model, (start, &wish.stop))?;
        let flaw = refined.flaw();
        if best.as_ref().is_none_or(|best| refined.is_better_than(best)) {
            best = Some(refined);
        }
        match flaw {
            Some(why) if rest > 0 => ladder.refuse(by, why),
            _ => break,
        }
    }
    let best = best.ok_or("no rung was tried")?;
    best.write(arguments, team, (&asked, &targets), model, start)
}

/// Meshes of the mesher that are adapted where there is a flaw in what comes of the first; the best is taken.
const TRIALS: usize = 3;

/// Least size by curvature that the mesher is told, of a small face: at an apex it would make a thousand times as many cells as are left
/// of them, and more than that our kernel finds by itself.
const LEAST: f64 = 1e-3;

/// The diagonal of a face's box, a quarter of the faces being smaller: the body's scale, also in a far field.
fn small_face(topology: &Topology) -> f64 {
    let mut diagonals: Vec<f64> = topology.faces.iter().map(|face| distance(face.bounds[0], face.bounds[1])).collect();
    diagonals.sort_by(f64::total_cmp);
    diagonals.get(diagonals.len() / 4).copied().unwrap_or_default()
}

/// Refuses a model that is no volume.
fn check_solids(path: &Path, model: &Model) -> Result<(), String> {
    if model.topology().solids > 0 {
        return Ok(());
    }
    let topology = model.topology();
    let faces = topology.faces.len();
    Err(format!(
        "{}: the model has no solid, only surfaces ({faces} faces{}): there is nothing to fill; join them to a closed solid in the CAD \
         program and export that",
        path.display(),
        open_edges(model)
    ))
}

/// How many edges have one face alone, and where one of those is: there a face is missing, or does not meet its neighbour.
fn open_edges(model: &Model) -> String {
    let edges = &model.topology().edges;
    let open = |edge: &usize| edges[*edge].faces.len() == 1 && !edges[*edge].seam && !edges[*edge].degenerate;
    let Some(first) = (0..edges.len()).find(open) else { return String::new() };
    let middle = 0.5 * (edges[first].range[0] + edges[first].range[1]);
    let at = model.evaluator().edge_frame(first as u32, middle).point;
    let (count, all) = ((0..edges.len()).filter(open).count(), edges.len());
    format!("; {count} of {all} edges have a face on one side alone, the first at {}", super::table::place(at))
}

impl Arguments {
    /// Refuses before the work what would fail after it.
    fn targets(&self, place: &Workplace) -> Result<(Targets, Target), String> {
        let mut files = Files::new().reads_models([&self.model]);
        let mut targets = Targets::of(&mut files, &self.output, self.report.as_ref(), JSON)?;
        let log = files.writes(&self.output.with_extension("log"), "the log beside -o", &[])?;
        if self.far_field.is_some() {
            let domain = files.writes(&self.output.with_extension("brep"), "the domain beside -o", &[])?;
            targets.with_model(place.file(DOMAIN), domain);
        }
        Ok((targets, log))
    }

    fn limits(&self) -> crate::metric::Limits {
        crate::metric::Limits { hmax: self.size, ..Default::default() }
    }

    /// Writes the mesher's own mesh, on the model.
    fn write_as_it_is(&self, meshed: &Meshed, model: &Model, targets: &Targets) -> Outcome {
        let mut mesh = meshed.mesh.clone();
        associate(&mut mesh, &meshed.place);
        targets.write_mesh(&mesh, model.names())?;
        if !self.quiet {
            let solids = model.topology().solids;
            super::print(&format!(
                "{}: {} vertices, {} tetrahedra in {solids} solid{}; written: {}\n",
                meshed.by,
                mesh.vertices.len(),
                mesh.tets.len(),
                if solids == 1 { "" } else { "s" },
                self.output.display()
            ))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}
