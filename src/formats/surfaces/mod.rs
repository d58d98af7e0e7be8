//! Surfaces to be models: triangles of STL, OBJ and PLY, or the boundary of a mesh of any format that [`super::read`] reads.
mod obj;
mod ply;
mod soup;
mod stl;
mod write;

pub(super) use write::write;

use super::error;
use crate::geometry::discrete::complete_boundary;
use crate::mesh::TetMesh;
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

/// Reads triangles of a shape.
pub(super) fn read(path: &Path, bytes: &[u8], shape: Shape) -> Result<Read<TetMesh>, Error> {
    match shape {
        Shape::Stl => stl::read(path, bytes),
        Shape::Obj => obj::read(path, bytes),
        Shape::Ply => ply::read(path, bytes),
    }
}

/// Reads a surface, by the extension: .stl, .obj, .ply, whose equal points become one vertex, or a mesh (.mesh, .meshb, .vtu, .msh,
/// …), whose boundary is completed. Groups of OBJ are references from 1 on; STL and PLY have the reference 1.
///
/// # Errors
/// [`Error::System`] when the file cannot be read, [`Error::Content`] when what it says cannot be true, or it has no triangles.
pub fn read_surface(team: Team<'_>, path: &Path) -> Result<Read<TetMesh>, Error> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let read = match ending.as_deref() {
        Some("stl") => stl::read(path, &error::read(path)?)?,
        Some("obj") => obj::read(path, &error::read(path)?)?,
        Some("ply") => ply::read(path, &error::read(path)?)?,
        _ => {
            let mut read = super::read(path)?;
            complete_boundary(team, &mut read.content.mesh);
            Read { content: read.content.mesh, notices: read.notices }
        }
    };
    if read.content.triangles.is_empty() {
        return Err(error::at(path, "triangles", "none in it: a surface is wanted"));
    }
    Ok(read)
}
