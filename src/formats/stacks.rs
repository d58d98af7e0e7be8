//! Prisms, pyramids and hexahedra, and which formats have them.
use super::format::vtk::{HEXAHEDRON, PRISM, PYRAMID};
use super::{Format, error};
use crate::mesh::io::Error;
pub(super) use crate::mesh::io::join_stack as join;
use crate::mesh::stack::{Kind, Stack};
use std::path::Path;

/// The numbers of the cells as VTK and SU2 have them.
const VTK: [(i64, Kind); 3] = [(PYRAMID, Kind::Pyramid), (PRISM, Kind::Prism), (HEXAHEDRON, Kind::Hexahedron)];

/// The kind of cells that VTK and SU2 call so.
pub(super) fn kind_of(number: i64) -> Option<Kind> {
    VTK.into_iter().find(|(other, _)| *other == number).map(|(_, kind)| kind)
}

/// What VTK and SU2 call the cells of a kind.
pub(super) fn number_of(kind: Kind) -> i64 {
    VTK.into_iter().find(|(_, other)| *other == kind).map_or(0, |(number, _)| number)
}

/// Refuses to write prisms, pyramids and hexahedra to a file whose format has no place for them.
///
/// # Errors
/// [`Error::Content`], with the remedy; and when the format is not known.
pub fn check_stack(path: &Path, stack: &Stack) -> Result<(), Error> {
    let format = Format::of(path)?;
    if stack.is_empty() || format.holds_stacks() || format.is_fields() || matches!(format, Format::Surface(_)) {
        return Ok(());
    }
    let message = format!(
        "the mesh has {}, for which this format is not written: give .meshb, .su2, .ugrid, .msh, .vtu, .cgns or a case of OpenFOAM, or split them by \
         `geo-adapt convert --split`",
        stack.told()
    );
    Err(error::at(path, "extension", message))
}
