//! One mesher after the other, one algorithm after the other, until a mesh is valid and lies on the whole model.
use super::places::{gmsh_places, netgen_places};
use super::queue::Queue;
use super::rung::{Choice, Rung};
use super::wish::Wish;
use super::{gmsh, netgen};
use crate::cli::table;
use crate::cli::waiting::Waiting;
use crate::cli::workplace::Workplace;
use crate::formats;
use crate::geometry::classify::{Classification, Error, Options, classify};
use crate::geometry::{Geometry, Model};
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::split_nonmanifold::{copy_values, split_nonmanifold};
use crate::mesh::validity;
use crate::mesh::vector::{Vec3, lerp};
use crate::mesh::{FlawKind, TetMesh};
use crate::process::{Log, Outcome, Runner, Tie, errors_or_last_lines, is_exhausted};
use crate::tasks::Team;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// A mesh on its model.
pub struct Meshed {
    /// The mesh; references are the numbers of faces, edges and solids from 1.
    pub mesh: TetMesh,
    /// Where its boundary lies.
    pub place: Classification,
    /// Who made it.
    pub by: Rung,
    /// What the user should know.
    pub notices: Vec<String>,
}

/// Why there is no mesh.
pub enum Stopped {
    /// The user ended this program.
    Interrupted(&'static str),
    /// No rung gave a good one.
    Failed(String),
}

/// Why a rung gave nothing.
enum Miss {
    /// No such program.
    NotThere(String),
    /// The user ended it.
    Interrupted,
    /// It took too long.
    TooLong(String),
    /// It failed, or its mesh was not good.
    Failed(String),
    /// It failed, and so will all others of its program.
    Hopeless(String),
}

/// The rungs that are left, and what the ones before gave.
pub struct Ladder<'a> {
    team: Team<'a>,
    model: &'a Model,
    wish: &'a Wish,
    log: &'a Path,
    place: &'a Workplace,
    brep: PathBuf,
    queue: Queue,
    /// What is not there, for the user.
    missing: Vec<String>,
    /// Rungs without a good mesh, and why.
    failed: Vec<(Rung, String)>,
}

impl<'a> Ladder<'a> {
    /// Before the first rung.
    pub fn new(
        team: Team<'a>,
        model: &'a Model,
        wish: &'a Wish,
        choice: Choice,
        (place, log): (&'a Workplace, &'a Path),
    ) -> Self {
        let brep = place.file("model.brep");
        let queue = Queue::new(Rung::of(choice), wish.limit);
        let (missing, failed) = Default::default();
        Self { team, model, wish, log, place, brep, queue, missing, failed }
    }

    /// The mesh of the next rung that gives a good one.
    ///
    /// # Errors
    /// When none is left, with what the last ones said; when there is no mesher, with what to install; when the user ended it.
    pub fn climb(&mut self) -> Result<Meshed, Stopped> {
        while let Some((rung, limit)) = self.queue.next() {
            let program = rung.program();
            let began = Instant::now();
            let what = format!("{rung}, of at most {:.0} s", limit.as_secs_f64());
            let given = {
                let _line = Waiting::for_what(&what);
                self.attempt(rung, limit)
            };
            // What waits for a busy machine has more time by the clock.
            self.queue.spend(began.elapsed().min(limit));
            match given {
                Ok((mesh, place)) => {
                    let told = self.failed.iter();
                    let notices = told.map(|(rung, why)| format!("{rung} gave no good mesh: {why}")).collect();
                    return Ok(Meshed { mesh, place, by: rung, notices });
                }
                Err(Miss::NotThere(why)) => {
                    self.queue.is_gone(program);
                    self.missing.push(why);
                }
                Err(Miss::Interrupted) => return Err(Stopped::Interrupted(program)),
                Err(Miss::TooLong(why)) => {
                    self.queue.took_too_long(rung);
                    self.failed.push((rung, why));
                }
                Err(Miss::Failed(why)) => self.failed.push((rung, why)),
                Err(Miss::Hopeless(why)) => {
                    self.queue.give_up(program);
                    self.failed.push((rung, why));
                }
            }
        }
        Err(Stopped::Failed(describe((&self.missing, &self.failed), self.queue.is_over(), self.log, self.model)))
    }

    /// One rung: the mesh, valid and on the model.
    fn attempt(&self, rung: Rung, limit: Duration) -> Result<(TetMesh, Classification), Miss> {
        if let Rung::Own { finer } = rung {
            let Some((mesh, on_model)) = own(self.team, self.model, finer, limit)? else {
                return Err(Miss::TooLong("it was ended (--time-limit)".into()));
            };
            return judge(self.team, mesh, self.model, Some(on_model)).map_err(Miss::Failed);
        }
        self.begin().map_err(Miss::Failed)?;
        let out = self.place.file("out.msh");
        let _ = std::fs::remove_file(&out);
        start((self.wish, limit), rung, self.place, [&self.brep, &out], self.log)?;
        let failed = |why: String| {
            let told = last_words(self.log);
            Miss::Failed(if told.contains("rror") { format!("{why} ({told})") } else { why })
        };
        if !out.is_file() {
            return Err(failed("it wrote no mesh".into()));
        }
        let mesh = formats::read_msh(&out).map_err(|error| failed(error.to_string()))?;
        judge(self.team, mesh, self.model, None).map_err(failed)
    }

    /// Writes the model for other programs and begins their log, unless that was done.
    fn begin(&self) -> Result<(), String> {
        if self.brep.is_file() {
            return Ok(());
        }
        Log::create(self.log).map_err(|error| format!("{}: {error}", self.log.display()))?;
        self.model.write_brep(&self.brep).map_err(|error| error.to_string())
    }

    /// No other program is tried any more.
    pub fn keep(&mut self, program: &str) {
        self.queue.keep(program);
    }

    /// Remembers why the mesh of a rung would not do.
    pub fn refuse(&mut self, rung: Rung, why: String) {
        self.failed.push((rung, why));
    }
}

/// Our own mesh, and where its vertices belong on the model; none where the time was over.
#[cfg(feature = "occt")]
fn own(team: Team<'_>, model: &Model, finer: f64, limit: Duration) -> Result<Option<(TetMesh, Vec<Vec3>)>, Miss> {
    match super::own::run(team, model, finer, limit) {
        Ok(own) => Ok(own.map(|own| (own.mesh, own.on_model))),
        Err(failure) if failure.is_crossing => Err(Miss::Hopeless(failure.why)),
        Err(failure) => Err(Miss::Failed(failure.why)),
    }
}

#[cfg(not(feature = "occt"))]
fn own(_: Team<'_>, _: &Model, _: f64, _: Duration) -> Result<Option<(TetMesh, Vec<Vec3>)>, Miss> {
    Err(Miss::Hopeless("this program was built without OpenCASCADE".into()))
}

/// The error of a ladder without a good rung.
fn describe((missing, failed): (&[String], &[(Rung, String)]), is_over: bool, log: &Path, model: &Model) -> String {
    let missing = missing.join("; ");
    let Some((rung, why)) = failed.last() else {
        return format!("there is no mesher to begin with: {missing}; or give --mesher own, which needs none");
    };
    let time = if is_over { "; the time was over (--time-limit)" } else { "" };
    let also = if missing.is_empty() { String::new() } else { format!("; not tried: {missing}") };
    let remedy = match flaws(model) {
        Some(flaws) => format!("The model itself is faulty: {flaws}. Repair it in the CAD program"),
        None => "Repair the model (tiny edges, faces that intersect) or give another --size".into(),
    };
    let told = match failed {
        [_] => format!("{rung} made no valid mesh of it: {why}"),
        _ => format!("no mesher made a valid mesh of it in {} attempts; the last, {rung}: {why}", failed.len()),
    };
    let said = if failed.iter().all(|(rung, _)| matches!(rung, Rung::Own { .. })) {
        String::new()
    } else {
        format!(" (all that was said is in {})", log.display())
    };
    format!("{told}{also}{time}{said}. {remedy}")
}

/// How many flaws of a model are told.
const TOLD: usize = 3;

/// What OpenCASCADE's check finds wrong with the model, and where.
fn flaws(model: &Model) -> Option<String> {
    let all = model.flaws();
    let tell = |(face, what): &(u32, String)| {
        let [low, high] = model.topology().faces[*face as usize].bounds;
        format!("face {} about {}: {what}", face + 1, table::place(lerp(low, high, 0.5)))
    };
    let told = all.iter().take(TOLD).map(tell).collect::<Vec<_>>().join("; ");
    let more = all.len().saturating_sub(TOLD);
    (!all.is_empty()).then(|| if more > 0 { format!("{told}; and {more} more") } else { told })
}

/// Runs the program, wherever it is found first.
fn start(
    (wish, limit): (&Wish, Duration),
    rung: Rung,
    place: &Workplace,
    files: [&Path; 2],
    log: &Path,
) -> Result<(), Miss> {
    let (variable, remedy, places) = match rung {
        Rung::Own { .. } | Rung::Gmsh { .. } => (gmsh::VARIABLE, gmsh::REMEDY, gmsh_places()),
        Rung::Netgen { .. } => (netgen::VARIABLE, netgen::REMEDY, netgen_places()),
    };
    let failed = |error: std::io::Error| Miss::Failed(format!("no file for it: {error}"));
    for program in places {
        let mut command = command(&program, wish, rung, place, files).map_err(failed)?;
        let mut said = Log::open(log).map_err(failed)?;
        said.command(&format!("{command:?}")).map_err(failed)?;
        let runner = Runner { tie: Tie::Bound, limit: Some(limit), stop: wish.stop, log: Some(&said) };
        let outcome = match runner.run(&mut command, |_| ()) {
            Ok(outcome) => outcome,
            Err(error) if is_exhausted(&error) => {
                return Err(Miss::Failed(format!("no process could be started for it ({error})")));
            }
            Err(_) => continue,
        };
        let why = || format!("it {outcome}: {}", last_words(log));
        match outcome {
            Outcome::Done => return Ok(()),
            Outcome::Interrupted if wish.stop.load(Ordering::SeqCst) => return Err(Miss::Interrupted),
            Outcome::Code(NO_MODULE) if matches!(rung, Rung::Netgen { .. }) => {}
            Outcome::TooLong(_) => {
                return Err(Miss::TooLong(format!("it {outcome} (--time-limit): {}", last_words(log))));
            }
            _ => return Err(Miss::Failed(why())),
        }
    }
    Err(Miss::NotThere(format!("{} was not found ({remedy}, or let {variable} name it)", rung.program())))
}

/// What the mesher said last. Behind its errors gmsh writes a summary, which tells their number.
fn last_words(log: &Path) -> String {
    errors_or_last_lines(log, &["error summary", "Check the full log", " warnings", " errors"])
}

/// Exit code of netgen.py where its Python has no netgen.
const NO_MODULE: i32 = 77;

fn command(
    program: &Path,
    wish: &Wish,
    rung: Rung,
    place: &Workplace,
    files: [&Path; 2],
) -> std::io::Result<std::process::Command> {
    match rung {
        Rung::Gmsh { surface, volume, finer, least } => {
            gmsh::command(program, (surface, volume, finer, least), wish, place, files)
        }
        Rung::Netgen { finer } => netgen::command(program, finer, wish, place, files),
        Rung::Own { .. } => unreachable!("our own is no other program"),
    }
}

/// A mesh is good when it is one, fills every solid, and covers every face, edge and vertex of the model. Where its vertices are not on the
/// model yet, `on_model` says where they belong.
pub fn judge(
    team: Team<'_>,
    mut mesh: TetMesh,
    model: &Model,
    on_model: Option<Vec<Vec3>>,
) -> Result<(TetMesh, Classification), String> {
    let topology = model.topology();
    // Solids that touch in an edge or a vertex alone: the mesher joins them there, our kernel and our model have them apart.
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    let doubled =
        split_nonmanifold(team, &mut mesh, &faces).map_err(|error| format!("its mesh is not valid: {error}"))?;
    if !doubled.is_empty() {
        // What it says of edges and vertices is of the sides together.
        (mesh.edges, mesh.association) = Default::default();
        [&mut mesh.corners, &mut mesh.ridges, &mut mesh.required_edges].into_iter().for_each(Vec::clear);
    }
    // Seams and poles are no features: what is listed on them would be taken for ridges.
    let is_ridge = |id: i32| {
        let edge = id as usize;
        edge >= 1 && edge <= topology.edges.len() && topology.is_ridge(edge as u32 - 1)
    };
    let listed = std::mem::take(&mut mesh.edges);
    listed.iter().filter(|(_, id)| is_ridge(*id)).for_each(|(nodes, id)| mesh.edges.push(nodes, id));
    mesh.association.edges.retain(|on| is_ridge(on.id));
    let validity = validity::check(&mesh);
    // Where its coarse chords cross across a narrow void, finer ones may not; what is left of it is told in the end.
    if let Some(flaw) = validity.flaws.iter().find(|flaw| flaw.kind != FlawKind::CrossingTriangles) {
        return Err(format!("its mesh is not valid: {flaw}"));
    }
    let empty = (1..=topology.solids as i32).find(|solid| !mesh.tets.refs.contains(solid));
    if let Some(solid) = empty {
        return Err(format!("its mesh has no tetrahedra in solid {solid} of {}", topology.solids));
    }
    let place = match on_model {
        None => classified(team, &mesh, model),
        Some(mut on_model) => {
            copy_values(&mut on_model, &doubled);
            std::mem::swap(&mut mesh.vertices, &mut on_model);
            let place = classified(team, &mesh, model);
            mesh.vertices = on_model;
            place
        }
    }
    .map_err(|error| error.to_string())?;
    mesh.triangles.refs = place.faces.iter().map(|&face| face as i32 + 1).collect();
    Ok((mesh, place))
}

/// Where the mesh lies. Edges of a sewn model may be off its faces by more than these state: then the largest tolerance that the model
/// states for anything holds for everything.
fn classified(team: Team<'_>, mesh: &TetMesh, model: &Model) -> Result<Classification, Error> {
    let error = match classify(team, mesh, model, &Options::default()) {
        Ok((place, _)) => return Ok(place),
        Err(error) => error,
    };
    let tolerance = Some(2.0 * model.topology().tolerance);
    classify(team, mesh, model, &Options { tolerance, ..Options::default() }).map(|(place, _)| place).map_err(|_| error)
}
