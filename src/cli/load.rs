//! Reads CAD models in a child process ([`super::child`]), so that a damaged file does no harm. The child hands over what it has read in a file
//! of its own: to join the solids of an assembly takes seconds, so it is done once.
use super::child::{self, Answer, Task};
use super::table;
use super::waiting::Waiting;
use super::workplace::Workplace;
use crate::geometry::{Error, Geometry, Model, names};
use std::error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// First argument of the child; then the model and the file for what was read.
const CHILD: &str = "read-model-and-exit";

/// If this process is the child of [`model`]: reads the file, writes what it has read, and tells the exit code.
pub fn child() -> Option<ExitCode> {
    child::answer(CHILD, |arguments| {
        let [file, target] = arguments else { return Err("a model and a target are wanted".into()) };
        read(file, target)
    })
}

fn read(file: &OsString, target: &OsString) -> Result<(), String> {
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

/// A model that was read before it was asked for, and the path that it will be asked for by.
static KEPT: Mutex<Option<(PathBuf, Model)>> = Mutex::new(None);

/// Reads a model and keeps it in memory, without the names of a file beside it.
///
/// # Errors
/// As [`model`].
#[cfg(all(feature = "serve", target_os = "linux"))]
pub fn keep(path: &Path) -> Result<(), Box<dyn error::Error>> {
    let model = from_file(path)?;
    *KEPT.lock().unwrap_or_else(PoisonError::into_inner) = Some((path.to_owned(), model));
    Ok(())
}

/// The model that is kept is what will be asked for by this path, once.
#[cfg(all(feature = "serve", target_os = "linux"))]
pub fn call(path: &Path) {
    if let Some((name, _)) = &mut *KEPT.lock().unwrap_or_else(PoisonError::into_inner) {
        *name = path.to_owned();
    }
}

fn kept(path: &Path) -> Option<Model> {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    kept.take_if(|(name, _)| name == path).map(|(_, model)| model)
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

/// What a child has read; none where there is no child to be had, or nothing to read.
fn in_child(path: &Path) -> Result<Option<Model>, Box<dyn error::Error>> {
    if !cfg!(feature = "occt") || !path.is_file() {
        return Ok(None);
    }
    let Ok(place) = Workplace::new() else { return Ok(None) };
    let target = place.file("model.bin");
    let task = Task {
        name: CHILD,
        arguments: &[path.as_os_str(), target.as_os_str()],
        file: path,
        doing: "reading it",
        crash: "is damaged: OpenCASCADE crashes on it; export it again from the program that made it",
    };
    match task.run(&place)? {
        Answer::Done if target.is_file() => Ok(Model::read_saved(&target).ok()),
        Answer::Refused(message) => Err(Error::Model { path: path.into(), message }.into()),
        Answer::Done | Answer::NotStarted => Ok(None),
    }
}
