//! Mesh and solution files: libMeshb's .mesh/.meshb and .sol/.solb.
mod error;
mod solution;

pub use error::Error;
pub use solution::{FieldKind, Solution, SolutionField};

use super::TetMesh;
use std::path::Path;

/// What was read, and what was passed over: one line a notice, to be shown to the user.
#[derive(Clone, Debug)]
pub struct Read<T> {
    /// The mesh or solution.
    pub content: T,
    /// Notices (keywords that are not known and were skipped).
    pub notices: Vec<String>,
}

/// Reads .mesh or .meshb, told apart by the content; every index in range, every coordinate finite.
pub fn read_mesh(path: &Path) -> Result<Read<TetMesh>, Error> {
    let _ = path;
    unimplemented!()
}

/// Writes .mesh or .meshb by the extension: beside the target first, then renamed.
pub fn write_mesh(path: &Path, mesh: &TetMesh) -> Result<(), Error> {
    let _ = (path, mesh);
    unimplemented!()
}

/// Reads .sol or .solb (fields at vertices).
pub fn read_solution(path: &Path) -> Result<Read<Solution>, Error> {
    let _ = path;
    unimplemented!()
}

/// Writes .sol or .solb by the extension: beside the target first, then renamed.
pub fn write_solution(path: &Path, solution: &Solution) -> Result<(), Error> {
    let _ = (path, solution);
    unimplemented!()
}
