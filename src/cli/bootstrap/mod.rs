//! `geo-adapt bootstrap`: the first mesh of a model.
//!
//! Our own mesher makes some valid mesh of the model (`own`; `triangles` of a surface of triangles), and where it fails another one that is
//! started as a program (`ladder`); our own kernel adapts it to the metric of the geometry (`refine`). The model goes to other programs as we
//! have it in memory, so that its numbers of faces, edges and solids are ours.
mod added;
mod arguments;
pub mod domain;
mod flaws;
mod gmsh;
pub mod heal;
mod ladder;
mod netgen;
#[cfg(feature = "occt")]
mod own;
mod places;
mod queue;
mod refine;
mod rung;
mod solids;
mod triangles;
mod unused;
mod wish;

pub use arguments::Arguments;

use super::adapt::files::Targets;
use super::adapt::report::Asked;
use super::interrupt::{self, Interrupted};
use super::workplace::Workplace;
use super::{Outcome, load};
use crate::cli::waiting::Waiting;
use crate::formats::Dataset;
use crate::geometry::{Geometry, Model, Names};
use crate::tasks::{Plan, Pool, Team, stage};
use arguments::{DOMAIN, HEALED};
use ladder::{Ladder, Meshed, Stopped};
use refine::{Failed, Refined};
use rung::{Choice, OWN};
use solids::{check_solids, small_face};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use wish::Wish;

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let place = Workplace::new().map_err(|error| format!("no folder for the mesher's files: {error}"))?;
    let (targets, log) = arguments.targets(&place)?;
    let threads = arguments.threads.map_or_else(super::cores, usize::from);
    let pool = Pool::new(threads)?;
    let team = Team::new(&pool, Plan::default());
    if triangles::is_surface(&arguments.model) {
        return of_triangles(arguments, &pool, (&targets, threads), start);
    }
    arguments.check_cad()?;
    let path = prepared(arguments, &place)?;
    let model = load::model(&path)?;
    check_solids(&path, &model)?;
    stage("model read");
    let options = arguments.sizes.options(&model, arguments.limits(), None);
    let wish = Wish {
        greatest: options.greatest,
        least: options.least.max(LEAST * small_face(model.topology())),
        diagonal: model.topology().diagonal(),
        segments: options.segments,
        stop: interrupt::end_at_once(),
        limit: Duration::try_from_secs_f64(arguments.time_limit).unwrap_or(Duration::MAX),
    };
    let named = |error: String| format!("{}: {error}", arguments.model.display());
    let mut ladder = Ladder::new(team, &model, &wish, arguments.mesher, (&place, log.path()));
    let stopped = |why: Stopped| -> Outcome {
        Err(match why {
            Stopped::Failed(error) => named(error).into(),
            Stopped::Interrupted(program) => {
                Interrupted(named(format!("{program} was ended; no mesh was written"))).into()
            }
        })
    };
    if arguments.no_adapt {
        return match ladder.climb() {
            Ok(meshed) => write_as_it_is(arguments, team, &meshed, (&model, model.names()), &targets),
            Err(why) => stopped(why),
        };
    }
    let asked =
        Asked { input: arguments.model.clone(), output: arguments.output.clone(), threads, complexity_wanted: None };
    let mut best: Option<Refined> = None;
    for rest in (0..TRIALS).rev() {
        let meshed = match ladder.climb() {
            Ok(meshed) => meshed,
            Err(Stopped::Failed(_)) if best.is_some() => break,
            Err(why) => return stopped(why),
        };
        stage("meshed");
        let by = meshed.by;
        let refined = refine::run(arguments, &pool, meshed, (&model, false), start)
            .map_err(|failed| failed.of(&arguments.model))?;
        interrupt::end_at_once();
        let (flaws, is_interrupted) = (refined.flaws(), refined.is_interrupted());
        if best.as_ref().is_none_or(|best| flaws.are_less_than(&best.flaws())) {
            best = Some(refined);
        }
        match flaws.worst() {
            Some(why) if rest > 0 && !is_interrupted => ladder.refuse(by, why),
            _ => break,
        }
        if best.as_ref().is_some_and(|best| !best.flaws().are_refused()) {
            // Other commands take a mesh with a fold: it is not worth minutes of another mesher.
            ladder.keep(OWN);
        }
    }
    let best = best.ok_or("no rung was tried")?;
    let names = model.names().clone();
    best.write(arguments, team, (&asked, &targets), (model, names), start)
}

/// The model that is meshed: healed and with a far field, where that is asked for.
fn prepared(arguments: &Arguments, place: &Workplace) -> Result<PathBuf, Box<dyn Error>> {
    let mut path = arguments.model.clone();
    if let Some(length) = arguments.heal {
        let _line = Waiting::for_what("OpenCASCADE heals the model");
        // The last that is made is the one that is written.
        let file = place.file(if arguments.far_field.is_some() { HEALED } else { DOMAIN });
        for done in heal::build(&path, length, &file)?.iter() {
            super::note(done);
        }
        path = file;
    }
    if let Some(spec) = &arguments.far_field {
        let _line = Waiting::for_what("OpenCASCADE makes the far field");
        path = domain::build(&path, spec, arguments.symmetry, &place.file(DOMAIN))?;
    }
    Ok(path)
}

/// The same of a surface of triangles.
fn of_triangles(arguments: &Arguments, pool: &Pool, (targets, threads): (&Targets, usize), start: Instant) -> Outcome {
    let unsupported = if arguments.far_field.is_some() {
        Some("--far-field takes a CAD model")
    } else if arguments.heal.is_some() {
        Some("--heal takes a CAD model")
    } else if !matches!(arguments.mesher, Choice::Auto | Choice::Own) {
        Some("a surface of triangles is meshed by geo-adapt itself: leave --mesher out")
    } else {
        None
    };
    if let Some(why) = unsupported {
        return Err(format!("{}: {why}", arguments.model.display()).into());
    }
    let team = Team::new(pool, Plan::default());
    let limit = Duration::try_from_secs_f64(arguments.time_limit).unwrap_or(Duration::MAX);
    let asked =
        Asked { input: arguments.model.clone(), output: arguments.output.clone(), threads, complexity_wanted: None };
    let mut patches = arguments.patches();
    loop {
        let line = Waiting::for_what("tetrahedra of its triangles");
        let (model, meshed, names) = triangles::run(team, &arguments.model, &mut patches, limit)?;
        drop(line);
        stage("meshed");
        if arguments.no_adapt {
            return write_as_it_is(arguments, team, &meshed, (&model, &names), targets);
        }
        let refined = refine::run(arguments, pool, meshed, (&model, patches.smooth), start);
        interrupt::end_at_once();
        let why = match refined {
            Ok(refined) => {
                let flaws = refined.flaws();
                match flaws.worst() {
                    Some(why) if patches.smooth && flaws.are_refused() && !refined.is_interrupted() => why,
                    _ => return refined.write(arguments, team, (&asked, targets), (model, names), start),
                }
            }
            Err(Failed::OnModel(why)) if patches.smooth => why,
            Err(failed) => return Err(failed.of(&arguments.model).into()),
        };
        triangles::take_as_they_are(&mut patches, &why);
    }
}

/// Meshes of the mesher that are adapted where there is a flaw in what comes of the first; the best is taken.
const TRIALS: usize = 3;

/// Least size by curvature that the mesher is told, of a small face: at an apex it would make a thousand times as many cells as are left
/// of them, and more than that our kernel finds by itself.
const LEAST: f64 = 1e-3;

/// Writes the mesher's own mesh, on the model.
fn write_as_it_is(
    arguments: &Arguments,
    team: Team<'_>,
    meshed: &Meshed,
    (model, names): (&Model, &Names),
    targets: &Targets,
) -> Outcome {
    let mut mesh = meshed.mesh.clone();
    match model {
        Model::Discrete(surface) => surface.restore(&mut mesh, &meshed.place),
        #[cfg(feature = "occt")]
        Model::Occt(_) => {
            crate::geometry::classify::associate(&mut mesh, &meshed.place);
        }
    }
    let data = Dataset { mesh, names: names.clone(), ..Dataset::default() };
    let (lost, mesh) = (targets.mesh_alone(team, &data)?, data.mesh);
    lost.iter().for_each(super::note);
    let solids = model.topology().solids;
    super::say(&format!(
        "{}: {} vertices, {} tetrahedra in {solids} solid{}; written: {}\n",
        meshed.by,
        mesh.vertices.len(),
        mesh.tets.len(),
        if solids == 1 { "" } else { "s" },
        arguments.output.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
