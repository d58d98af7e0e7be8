//! Meshes and fields in the files of other programs.
//!
//! Reading goes bytes → a reader a format (`su2`, `vtu`, `legacy_vtk`, `xdmf`, `cgns`, `msh`, `ugrid`, `abaqus`, `nastran`; `libmeshb` hands over to [`crate::mesh::io`]) → [`Dataset`] →
//! `check` (indices, numbers) → `orientation` (tetrahedra numbered the other way). Writing goes the way back; `unsupported` says what the
//! format cannot carry.
//! Cases of OpenFOAM (`foam`) are folders, with fields at cells. Columns of fields alone (`columns`: SU2's restarts) are read onto a given
//! mesh.
mod abaqus;
mod cells;
mod cgns;
mod check;
mod columns;
mod dataset;
mod error;
pub mod foam;
mod format;
mod hdf5;
mod legacy_vtk;
mod libmeshb;
mod markers;
mod msh;
mod nastran;
mod orientation;
mod placement;
mod scan;
mod sets;
mod stacks;
mod su2;
mod surfaces;
mod tags;
mod text;
pub mod ugrid;
mod unsupported;
pub mod vtu;
mod xdmf;

pub use cells::{cells_to_vertices, vertices_to_cells};
pub use dataset::{Dataset, NamedField};
pub use format::Format;
pub use msh::read_msh;
pub use placement::Placement;
pub use stacks::check_stack;
pub use surfaces::{Shape, read_surface};

use crate::geometry::names;
use crate::mesh::io::{Batch, Error, Read};
use crate::tasks::Team;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// How a file is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// As text where the format would be binary otherwise (.vtu, .msh, cases of OpenFOAM).
    pub text: bool,
}

/// Reads a mesh with its names and fields, by the extension, or by the content where there is none that is known. What lies beside
/// belongs to it: the names and fields of .mesh and .meshb, the names of .ugrid. Prisms, pyramids and hexahedra are the [`Dataset`]'s stack where
/// the format [holds](Format::holds_stacks) them; other elements that cannot stand in a [`crate::mesh::TetMesh`] (curved ones) are refused.
///
/// # Errors
/// [`Error::System`] when a file cannot be read, [`Error::Content`] when what it says cannot be true, or is not for us.
pub fn read(path: &Path) -> Result<Read<Dataset>, Error> {
    read_on(Team::alone(), path)
}

/// As [`read`], on the threads of a team, as far as the format allows: the same mesh.
///
/// # Errors
/// As there.
pub fn read_on(team: Team<'_>, path: &Path) -> Result<Read<Dataset>, Error> {
    if matches!(Format::of(path), Ok(Format::Foam)) {
        let read = foam::read(path)?;
        check::check(team, path, &read.content)?;
        return Ok(read);
    }
    let bytes = error::read_on(team, path)?;
    let format = Format::of_input(path, &bytes)?;
    let mut read = read_bytes_on(team, format, path, &bytes)?;
    match format {
        Format::Libmeshb => libmeshb::read_beside(team, path, &mut read)?,
        Format::Ugrid(_) => ugrid::read_beside(path, &mut read.content.names)?,
        _ => {}
    }
    Ok(read)
}

/// As [`read`], from bytes of such a format, and nothing beside but the arrays of XDMF; `path` is what errors say.
///
/// # Errors
/// [`Error::Content`], as there.
pub fn read_bytes(format: Format, path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    read_bytes_on(Team::alone(), format, path, bytes)
}

fn read_bytes_on(team: Team<'_>, format: Format, path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let mut read = match format {
        Format::Libmeshb => libmeshb::read(team, path, bytes)?,
        Format::Su2 => su2::read(path, bytes)?,
        Format::Vtu => vtu::read(path, bytes)?,
        Format::Xdmf { .. } => xdmf::read(path, bytes)?,
        Format::Cgns => cgns::read(path, bytes)?,
        Format::LegacyVtk => legacy_vtk::read(path, bytes)?,
        Format::Abaqus => abaqus::read(path, bytes)?,
        Format::Nastran => nastran::read(path, bytes)?,
        Format::Msh { .. } => msh::read(path, bytes)?,
        Format::Ugrid(encoding) => ugrid::read(path, bytes, encoding)?,
        Format::Surface(shape) => surfaces::read(path, bytes, shape)?,
        Format::Foam => return Err(error::at(path, "format", "a case of OpenFOAM is a folder of several files")),
        Format::Solution | Format::Table | Format::Restart => {
            let message = "holds fields and no mesh: give the mesh, and this file by --fields";
            return Err(error::at(path, "extension", message));
        }
    };
    check::drop_endless(path, &mut read.content.fields, &mut read.notices);
    check::check(team, path, &read.content)?;
    read.notices
        .extend(orientation::unify(team, &mut read.content).map(|notice| format!("{}: {notice}", path.display())));
    Ok(read)
}

/// Reads the fields that lie beside .mesh or .meshb of so many vertices; none where there are none.
///
/// # Errors
/// As [`read`].
pub fn fields_beside(path: &Path, vertices: usize) -> Result<Read<Vec<NamedField>>, Error> {
    libmeshb::fields_beside(Team::alone(), path, vertices)
}

/// The files that [`read`] reads: the mesh and what belongs to it, whether it is there or not.
pub fn read_files(path: &Path) -> Vec<PathBuf> {
    match Format::of(path) {
        Ok(Format::Foam) => foam::read_files(path),
        Ok(Format::Ugrid(_)) => vec![path.to_owned(), ugrid::names_path(path)],
        Ok(Format::Xdmf { .. }) => [vec![path.to_owned()], xdmf::files(path)].concat(),
        // What has no ending that is known may be a mesh of libMeshb.
        Ok(Format::Libmeshb) | Err(_) => {
            vec![path.to_owned(), path.with_extension("solb"), path.with_extension("sol"), names::beside(path)]
        }
        Ok(_) => vec![path.to_owned()],
    }
}

/// The files that [`write()`] may replace. (The names beside a solution are none of these: the ones that are there are kept.)
///
/// # Errors
/// When the extension is none that is known.
pub fn written_files(path: &Path) -> Result<Vec<PathBuf>, Error> {
    Ok(match Format::of(path)? {
        Format::Foam => foam::written_files(path),
        Format::Libmeshb => vec![path.to_owned(), libmeshb::solution_path(path), names::beside(path)],
        Format::Ugrid(_) => vec![path.to_owned(), ugrid::names_path(path)],
        Format::Xdmf { .. } => vec![path.to_owned(), xdmf::heavy_path(path)],
        _ => vec![path.to_owned()],
    })
}

/// Reads fields (.sol, .solb, .csv, .dat) onto a mesh, instead of those that it has. Returns notices.
///
/// # Errors
/// As [`read`]; and where the file is of a mesh with other vertices.
pub fn read_fields(path: &Path, data: &mut Dataset) -> Result<Vec<String>, Error> {
    read_fields_on(Team::alone(), path, data)
}

/// As [`read_fields`], on the threads of a team, as far as the format allows: the same fields.
///
/// # Errors
/// As there.
pub fn read_fields_on(team: Team<'_>, path: &Path, data: &mut Dataset) -> Result<Vec<String>, Error> {
    let bytes = error::read_on(team, path)?;
    let mut read = match Format::of(path)? {
        Format::Solution => libmeshb::read_solution(team, path, &bytes, data.mesh.vertices.len())?,
        Format::Table | Format::Restart => columns::read(path, &bytes, &data.mesh.vertices)?,
        _ => return Err(error::at(path, "extension", "no file of fields; give .sol, .solb, .csv or .dat")),
    };
    check::drop_endless(path, &mut read.content, &mut read.notices);
    data.fields = read.content;
    check::check(team, path, data)?;
    Ok(read.notices)
}

/// Writes a mesh with its names and fields, by the extension: beside the target first, then renamed. To .sol, .solb, .csv and .dat go the
/// fields alone. Returns notices: what the format cannot carry.
///
/// # Errors
/// [`Error::Content`] for another extension, or what could not be read again, [`Error::System`] when a file cannot be written.
pub fn write(path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    write_on(Team::alone(), path, data, Options::default())
}

/// As [`write`], on the threads of a team: the same file to the last byte.
///
/// # Errors
/// As there.
pub fn write_on(team: Team<'_>, path: &Path, data: &Dataset, options: Options) -> Result<Vec<String>, Error> {
    let mut batch = Batch::new();
    let notices = add(&mut batch, team, path, data, options)?;
    batch.commit()?;
    Ok(notices)
}

/// Adds what [`write_on`] writes to files that belong together; the mesh is the main one.
///
/// # Errors
/// As there.
pub fn add(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    data: &Dataset,
    options: Options,
) -> Result<Vec<String>, Error> {
    let format = Format::of(path)?;
    check::check(team, path, data)?;
    check_stack(path, &data.stack)?;
    // A case of OpenFOAM has values at the pieces of the cells too.
    let has_cells = format.holds_stacks() && format != Format::Foam;
    let written = if has_cells { data.as_written() } else { Cow::Borrowed(data) };
    let data = &*written;
    let mut notices = unsupported::notices(format, data);
    notices.extend(match format {
        Format::Libmeshb => libmeshb::write(batch, team, path, data)?,
        Format::Su2 => su2::write(batch, path, data)?,
        Format::Vtu => vtu::write(batch, team, path, data, options.text)?,
        Format::Xdmf { is_mixed } => xdmf::write(batch, path, data, is_mixed, options.text)?,
        Format::Cgns => cgns::write(batch, path, data)?,
        Format::Surface(shape) => surfaces::write(batch, team, path, data, shape, options.text)?,
        Format::Abaqus => abaqus::write(batch, path, data)?,
        Format::Nastran => nastran::write(batch, path, data)?,
        Format::LegacyVtk => legacy_vtk::write(batch, path, data, options.text)?,
        Format::Foam => foam::add(batch, team, path, data, options.text)?,
        Format::Msh { is_new } => msh::write(batch, path, data, is_new, options.text)?,
        Format::Ugrid(encoding) => ugrid::write(batch, path, data, encoding)?,
        Format::Solution => libmeshb::write_solution(batch, team, path, data)?,
        Format::Table => columns::write_text(batch, path, data)?,
        Format::Restart => columns::write_binary(batch, path, data)?,
    });
    Ok(notices)
}
