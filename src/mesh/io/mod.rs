//! Mesh and solution files: libMeshb's .mesh/.meshb and .sol/.solb.
//!
//! Reading goes bytes → `source` (sections; found by `ascii` or `binary`) → `read` (arrays, through a `cursor`);
//! writing goes arrays → `write` (checked) → `layout` (what stands where; `rows` by a `sink`) → `batch`.
//! Binary files larger than memory are read and written by [`slices`].
mod ascii;
mod batch;
mod binary;
mod bytes;
mod counts;
mod cursor;
mod error;
mod keyword;
mod layout;
mod missing;
pub mod number;
mod place;
mod points;
mod read;
mod rows;
mod sink;
pub mod slices;
mod solution;
mod source;
mod write;

pub use batch::{Batch, write_beside};
pub use bytes::{check_regular, read_file, read_file_on, read_head};
pub use counts::MeshCounts;
pub use error::Error;
pub use missing::meant;
pub use place::{check_writable, follow};
pub use points::read_points;
pub use read::join_stack;
pub use rows::Slice;
pub use solution::{FieldKind, Solution, SolutionField};

use super::TetMesh;
use super::stack::Stack;
use crate::tasks::Team;
use std::path::Path;

/// What was read, and what was passed over: one line a notice, to be shown to the user.
#[derive(Clone, Debug)]
pub struct Read<T> {
    /// The mesh or solution.
    pub content: T,
    /// Notices (keywords that are not known and were skipped).
    pub notices: Vec<String>,
}

/// Reads .mesh or .meshb, told apart by the content; every index in range, every coordinate finite. Prisms, pyramids and hexahedra are cut
/// into tetrahedra, which come behind the others ([`Stack::join`]).
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when what it says cannot be true.
pub fn read_mesh(path: &Path) -> Result<Read<TetMesh>, Error> {
    read_mesh_on(Team::alone(), path)
}

/// As [`read_mesh`], on the threads of a team: binary files section by section, every section by all of them.
///
/// # Errors
/// As there.
pub fn read_mesh_on(team: Team<'_>, path: &Path) -> Result<Read<TetMesh>, Error> {
    let Read { content: (mesh, _), notices } = read_mesh_and_stack(team, path)?;
    Ok(Read { content: mesh, notices })
}

/// As [`read_mesh_on`], with the stack that the mesh was joined with.
///
/// # Errors
/// As there.
pub fn read_mesh_and_stack(team: Team<'_>, path: &Path) -> Result<Read<(TetMesh, Stack)>, Error> {
    read::mesh_from(team, path, &read_file_on(team, path)?)
}

/// As [`read_mesh_and_stack`], from the bytes of such a file; `path` is what errors say.
///
/// # Errors
/// As there.
pub fn mesh_of_bytes(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<(TetMesh, Stack)>, Error> {
    read::mesh_from(team, path, bytes)
}

/// As [`read_solution_on`], from the bytes of such a file; `path` is what errors say.
///
/// # Errors
/// As there.
pub fn solution_of_bytes(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<Solution>, Error> {
    read::solution_from(team, path, bytes)
}

/// Writes .mesh or .meshb by the extension: beside the target first, then renamed.
///
/// # Errors
/// [`Error::Content`] for another extension, an index out of range or a value that is not finite,
/// [`Error::System`] when the file cannot be written.
pub fn write_mesh(path: &Path, mesh: &TetMesh) -> Result<(), Error> {
    let mut batch = Batch::new();
    add_mesh(&mut batch, Team::alone(), path, mesh)?;
    batch.commit()
}

/// Adds .mesh or .meshb, as [`write_mesh`] writes it, to files that belong together: as the main one. The team's threads write the same file
/// to the last byte.
///
/// # Errors
/// As there.
pub fn add_mesh(batch: &mut Batch, team: Team<'_>, path: &Path, mesh: &TetMesh) -> Result<(), Error> {
    add_mesh_and_stack(batch, team, path, (mesh, &Stack::default()))
}

/// As [`add_mesh`], with the stack of a mesh, which is given without what was cut out of it ([`Stack::without`]).
///
/// # Errors
/// As there.
pub fn add_mesh_and_stack(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    both: (&TetMesh, &Stack),
) -> Result<(), Error> {
    write::mesh_to(batch, team, path, both)
}

/// Reads .sol or .solb (fields at vertices), told apart by the content; every value finite.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when what it says cannot be true.
pub fn read_solution(path: &Path) -> Result<Read<Solution>, Error> {
    read_solution_on(Team::alone(), path)
}

/// As [`read_solution`], on the threads of a team.
///
/// # Errors
/// As there.
pub fn read_solution_on(team: Team<'_>, path: &Path) -> Result<Read<Solution>, Error> {
    read::solution_from(team, path, &read_file_on(team, path)?)
}

/// Writes .sol or .solb by the extension: beside the target first, then renamed.
///
/// # Errors
/// [`Error::Content`] for another extension, a wrong number of values or a value that is not finite,
/// [`Error::System`] when the file cannot be written.
pub fn write_solution(path: &Path, solution: &Solution) -> Result<(), Error> {
    write_solution_on(Team::alone(), path, solution)
}

/// As [`write_solution`], on the threads of a team: the same file to the last byte.
///
/// # Errors
/// As there.
pub fn write_solution_on(team: Team<'_>, path: &Path, solution: &Solution) -> Result<(), Error> {
    let mut batch = Batch::new();
    add_solution(&mut batch, team, path, solution)?;
    batch.commit()
}

/// Adds .sol or .solb, as [`write_solution_on`] writes it, to files that belong together.
///
/// # Errors
/// As there.
pub fn add_solution(batch: &mut Batch, team: Team<'_>, path: &Path, solution: &Solution) -> Result<(), Error> {
    write::solution_to(batch, team, path, solution)
}
