//! netgen (LGPL: started in a Python of its own, never linked).
use super::wish::Wish;
use crate::cli::workplace::Workplace;
use std::path::Path;
use std::process::Command;

/// Names a Python that has it, where the one in the search path has not.
pub const VARIABLE: &str = "GEO_ADAPT_NETGEN_PYTHON";

/// What to do where it is missing.
pub const REMEDY: &str = "pip install netgen-mesher";

/// The program that Python runs.
const SCRIPT: &str = include_str!("netgen.py");

/// The command: meshes `model` (BREP) into `out` (MSH 4.1).
pub fn command(
    python: &Path,
    finer: f64,
    wish: &Wish,
    place: &Workplace,
    [model, out]: [&Path; 2],
) -> std::io::Result<Command> {
    let path = place.file("netgen_driver.py");
    std::fs::write(&path, SCRIPT)?;
    let mut command = Command::new(python);
    command.arg(path).arg(model).arg(out);
    command.args([wish.greatest / finer, wish.segments * finer].map(|number| format!("{number:e}")));
    Ok(command)
}
