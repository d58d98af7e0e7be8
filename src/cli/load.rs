//! Reading a CAD model without being at the mercy of its file.
//!
//! OpenCASCADE can crash on a damaged file, and a crash cannot be caught. So the file is first read by a child process, this same
//! program; if that one dies, the user gets an error like any other. It costs the reading twice, which is little beside an adaptation.
use crate::geometry::{Error, Model, names};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// First argument of the child.
const PROBE: &str = "read-model-and-exit";

/// If this process is the child of [`model`]: reads the file and exits.
pub fn probe() -> Option<ExitCode> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.next()? != PROBE {
        return None;
    }
    // Whether the file is good is told by the parent: it reads it again, and has the error then.
    let _ = Model::read(Path::new(&arguments.next()?));
    Some(ExitCode::SUCCESS)
}

/// Reads a model.
///
/// # Errors
/// When the file is no readable model, also when OpenCASCADE crashes on it.
pub fn model(path: &Path) -> Result<Model, Error> {
    if cfg!(feature = "occt") && path.is_file() {
        let child = std::env::current_exe().and_then(|program| {
            let mut command = Command::new(program);
            command.arg(PROBE).arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status()
        });
        // A child that could not be started tells nothing of the file.
        if child.is_ok_and(|status| !status.success()) {
            let message = "is damaged: OpenCASCADE crashes on it; export it again from the program that made it";
            return Err(Error::Model { path: path.into(), message: message.into() });
        }
    }
    let mut model = Model::read(path)?;
    // BREP files have no names of their own.
    let is_brep = path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("brep"));
    if is_brep && model.names().is_empty() {
        model
            .rename(names::read(path).map_err(|error| Error::Model { path: path.into(), message: error.to_string() })?);
    }
    Ok(model)
}
