//! Reading a CAD model without being at the mercy of its file.
//!
//! OpenCASCADE can crash on a damaged file, and a crash cannot be caught. So the file is read by a child process, this same program; if
//! that one dies, the user gets an error like any other. What it has read it hands over in a file of its own: joining the solids of an
//! assembly takes seconds, so it is done once.
use super::workplace::Workplace;
use crate::geometry::{Error, Model, names};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// First argument of the child.
const PROBE: &str = "read-model-and-exit";

/// If this process is the child of [`model`]: reads the file, writes what it has read, and exits.
pub fn probe() -> Option<ExitCode> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.next()? != PROBE {
        return None;
    }
    let (file, target) = (arguments.next()?, arguments.next()?);
    // What is wrong with the file, or with the folder of the target, is told by the parent: it reads the file itself then.
    let _ = Model::read(Path::new(&file)).and_then(|model| model.save(Path::new(&target)));
    Some(ExitCode::SUCCESS)
}

/// Reads a model.
///
/// # Errors
/// When the file is no readable model, also when OpenCASCADE crashes on it.
pub fn model(path: &Path) -> Result<Model, Error> {
    let mut read = None;
    if cfg!(feature = "occt") && path.is_file() {
        let place = Workplace::new().ok();
        let target = place.as_ref().map_or_else(PathBuf::new, |place| place.file("model.bin"));
        let child = std::env::current_exe().and_then(|program| {
            let mut command = Command::new(program);
            command
                .arg(PROBE)
                .arg(path)
                .arg(&target)
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
        });
        // A child that could not be started tells nothing of the file.
        if child.is_ok_and(|status| !status.success()) {
            let message = "is damaged: OpenCASCADE crashes on it; export it again from the program that made it";
            return Err(Error::Model { path: path.into(), message: message.into() });
        }
        read = target.is_file().then(|| Model::read_saved(&target).ok()).flatten();
    }
    let mut model = read.map_or_else(|| Model::read(path), Ok)?;
    // BREP files have no names of their own.
    let is_brep = path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("brep"));
    if is_brep && model.names().is_empty() {
        model
            .rename(names::read(path).map_err(|error| Error::Model { path: path.into(), message: error.to_string() })?);
    }
    Ok(model)
}
