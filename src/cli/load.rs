//! Reads CAD models in a child process ([`super::child`]), so that a damaged file does no harm. The child hands over what it has read in a file
//! of its own: to join the solids of an assembly takes seconds, so it is done once.
use super::child::{self, Answer, Task};
use super::table;
use super::waiting::Waiting;
use super::workplace::Workplace;
use crate::geometry::{Error, Geometry, Model, names};
use crate::process::{Program, may_fork};
use std::error;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The file for what a child has read.
const TARGET: &str = "model.bin";

/// First argument of the child; then the model and the file for what was read.
const CHILD: &str = "read-model-and-exit";

/// If this process is the child of [`model`]: reads the file, writes what it has read, and tells the exit code.
pub fn child() -> Option<ExitCode> {
    child::answer(CHILD, read)
}

/// The work of the child.
fn read(arguments: &[OsString]) -> Result<(), String> {
    let [file, target] = arguments else { return Err("a model and a target are wanted".into()) };
    let model = Model::read(Path::new(file)).map_err(|error| match error {
        // The parent names the file.
        Error::Model { message, .. } => message,
        Error::Open { source, .. } => source.to_string(),
        Error::Classification(error) => error.to_string(),
    })?;
    model.try_trimming();
    // Where there is no room for it the parent reads the model again: now it is known to be harmless.
    let _ = model.save(Path::new(target));
    Ok(())
}

/// Reads a model.
///
/// # Errors
/// When the file is no readable model, also when OpenCASCADE crashes on it, or never comes back; when memory ends; when it is interrupted.
pub fn model(path: &Path) -> Result<Model, Box<dyn error::Error>> {
    let mut model = match kept(path) {
        Some(model) => model,
        None => from_file(path)?,
    };
    for wall in model.double_walls() {
        super::note(format_args!(
            "{}: faces of a solid lie on each other, at {}: they are one now, and what was one solid is {}",
            path.display(),
            table::place(wall.at),
            wall.solids
        ));
    }
    give_names(&mut model, path)?;
    Ok(model)
}

fn from_file(path: &Path) -> Result<Model, Box<dyn error::Error>> {
    let _line = Waiting::for_what(&format!("OpenCASCADE reads {}", path.display()));
    match in_child(path)? {
        Some(model) => Ok(model),
        None => Ok(Model::read(path)?),
    }
}

/// A child that reads a model before it is asked for. It is ended where nobody asks.
pub struct Begun;

/// The path of that model, and the child.
static BEGUN: Mutex<Option<(PathBuf, Reading)>> = Mutex::new(None);

/// A child that reads, and its files, which go after it.
struct Reading {
    program: Program,
    place: Workplace,
}

impl Begun {
    /// Begins to read a model that will be asked for, if a process may be forked for that. What is wrong is told when it is asked for.
    pub fn with(path: &Path) -> Self {
        let is_kept = lock(&KEPT).as_ref().is_some_and(|(name, _)| name == path);
        if !is_kept && is_to_be_read(path) && may_fork() {
            *lock(&BEGUN) = Workplace::new().ok().and_then(|place| {
                let target = place.file(TARGET);
                let program = task(path, &[path.as_os_str(), target.as_os_str()]).begin(&place, read).ok()?;
                Some((path.to_owned(), Reading { program, place }))
            });
        }
        Self
    }
}

impl Drop for Begun {
    fn drop(&mut self) {
        *lock(&BEGUN) = None;
    }
}

fn lock<T>(what: &Mutex<T>) -> MutexGuard<'_, T> {
    what.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A model that was read before it was asked for, and the path that it will be asked for by.
static KEPT: Mutex<Option<(PathBuf, Model)>> = Mutex::new(None);

/// Reads a model and keeps it in memory, without the names of a file beside it.
///
/// # Errors
/// As [`model`].
#[cfg(all(feature = "serve", target_os = "linux"))]
pub fn keep(path: &Path) -> Result<(), Box<dyn error::Error>> {
    let model = from_file(path)?;
    *lock(&KEPT) = Some((path.to_owned(), model));
    Ok(())
}

/// The model that is kept is what will be asked for by this path, once.
#[cfg(all(feature = "serve", target_os = "linux"))]
pub fn call(path: &Path) {
    if let Some((name, _)) = &mut *lock(&KEPT) {
        *name = path.to_owned();
    }
}

fn kept(path: &Path) -> Option<Model> {
    lock(&KEPT).take_if(|(name, _)| name == path).map(|(_, model)| model)
}

/// Gives a model the names and colours of the file beside it ([`names::beside_model`]), which come before those in the model itself.
///
/// # Errors
/// When that file is no names file, or is the model's own and names a face, edge or solid that is not there.
pub fn give_names(model: &mut Model, path: &Path) -> Result<(), Box<dyn error::Error>> {
    let mut given = names::read_of_model(path)?;
    let file = names::beside_model(path);
    // A file that is a mesh's too may name references of that.
    let is_own = file == names::of_model(path);
    let topology = model.topology();
    let counts = [topology.faces.len(), topology.edges.len(), topology.solids as usize];
    let labels = [&mut given.triangles, &mut given.edges, &mut given.tetrahedra];
    for ((labels, count), what) in labels.into_iter().zip(counts).zip(["face", "edge", "solid"]) {
        let is_there = |number: i32| number >= 1 && number as usize <= count;
        if let Some(number) = labels.keys().find(|number| is_own && !is_there(**number)) {
            let (file, model) = (file.display(), path.display());
            let remedy = "take that name out, or move the file away";
            return Err(format!("{file}: names {what} {number}, but {model} has {count}; {remedy}").into());
        }
        labels.retain(|&number, _| is_there(number));
    }
    let mut all = model.names().clone();
    all.update(given);
    model.rename(all);
    Ok(())
}

fn is_to_be_read(path: &Path) -> bool {
    cfg!(feature = "occt") && path.is_file()
}

/// The task of a child that reads a model; its arguments are that and the target.
fn task<'a>(path: &'a Path, arguments: &'a [&'a OsStr; 2]) -> Task<'a> {
    Task {
        name: CHILD,
        arguments,
        file: path,
        doing: "reading it",
        crash: "is damaged: OpenCASCADE crashes on it; export it again from the program that made it",
    }
}

/// What a child has read; none where there is no child to be had, or nothing to read.
fn in_child(path: &Path) -> Result<Option<Model>, Box<dyn error::Error>> {
    if !is_to_be_read(path) {
        return Ok(None);
    }
    let begun = lock(&BEGUN).take_if(|(name, _)| name == path).map(|(_, reading)| reading);
    let (program, place) = match begun {
        Some(Reading { program, place }) => (Some(program), place),
        None => match Workplace::new() {
            Ok(place) => (None, place),
            Err(_) => return Ok(None),
        },
    };
    let target = place.file(TARGET);
    let arguments = [path.as_os_str(), target.as_os_str()];
    let task = task(path, &arguments);
    match program.map_or_else(|| task.run(&place), |program| task.finish(&place, program))? {
        Answer::Done if target.is_file() => Ok(Model::read_saved(&target).ok()),
        Answer::Refused(message) => Err(Error::Model { path: path.into(), message }.into()),
        Answer::Done | Answer::NotStarted => Ok(None),
    }
}
