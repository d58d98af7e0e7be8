//! Surfaces to be models: triangles of STL, OBJ and PLY, or the boundary of a mesh of any format that [`super::read`] reads.
mod obj;
mod ply;
mod soup;
mod stl;
mod write;

pub(super) use write::write;

use super::{Dataset, Format, error};
use crate::geometry::discrete::complete_boundary;
use crate::mesh::io::{Error, Read};
use crate::tasks::Team;
use std::path::Path;

/// A format of triangles alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// STL.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY.
    Ply,
}

/// Reads triangles of a shape, and what they are called.
pub(super) fn read(path: &Path, bytes: &[u8], shape: Shape) -> Result<Read<Dataset>, Error> {
    match shape {
        Shape::Stl => stl::read(path, bytes),
        Shape::Obj => obj::read(path, bytes),
        Shape::Ply => ply::read(path, bytes),
    }
}

/// Reads a surface, by the extension: .stl, .obj, .ply, whose equal points become one vertex, or a mesh (.mesh, .meshb, .vtu, .msh,
/// …), whose boundary is completed. Groups of OBJ and solids of STL are
/// references from 1 on, called as they are; PLY has the property `reference` of its faces, else 1.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when what it says cannot be true, or it has no triangles.
pub fn read_surface(team: Team<'_>, path: &Path) -> Result<Read<Dataset>, Error> {
    let read = if let Ok(Format::Surface(shape)) = Format::of(path) {
        read(path, &error::read(path)?, shape)?
    } else {
        let mut read = super::read(path)?;
        complete_boundary(team, &mut read.content.mesh);
        read
    };
    if read.content.mesh.triangles.is_empty() {
        return Err(error::at(path, "triangles", "none in it: a surface is wanted"));
    }
    Ok(read)
}
