//! A grid of several files: .pvtu, whose pieces ParaView reads by themselves, on as many processes as it has.
use super::super::Dataset;
use super::write::{order, shared_arrays, write_piece};
use crate::mesh::io::{Batch, Error};
use crate::tasks::Team;
use quick_xml::escape::escape;
use std::path::{Path, PathBuf};

/// The file of a piece of a .pvtu: from `flow.pvtu` to `flow_0003.vtu`.
pub fn piece_path(path: &Path, number: usize) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("_{number:04}.vtu"));
    path.with_file_name(name)
}

/// Adds a piece of a .pvtu. All pieces must have fields of the same names, in the same order; references of vertices are left out.
///
/// # Errors
/// When it cannot be written.
pub fn add_piece(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    number: usize,
    data: &mut Dataset,
) -> Result<(), Error> {
    data.mesh.vertex_refs.fill(0);
    write_piece(batch, team, &piece_path(path, number), data)
}

/// Adds the .pvtu of so many pieces, with the fields of one of them. Pieces of an older result that it does not have are removed.
///
/// # Errors
/// As of [`add_piece`].
pub fn add_pieces(batch: &mut Batch, path: &Path, count: usize, one: &Dataset) -> Result<(), Error> {
    let source = |number| {
        let piece = piece_path(path, number);
        let name = piece.file_name().unwrap_or_default().to_string_lossy().into_owned();
        format!("<Piece Source=\"{}\"/>\n", escape(&name))
    };
    let (order, arrays, pieces) = (order(), shared_arrays(one), (0..count).map(source).collect::<String>());
    let text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"{order}\" header_type=\"UInt64\">\n\
         <PUnstructuredGrid GhostLevel=\"0\">\n{arrays}{pieces}</PUnstructuredGrid>\n</VTKFile>\n"
    );
    let old = (count..).map(|number| piece_path(path, number)).take_while(|old| old.is_file());
    old.for_each(|old| batch.remove(&old));
    batch.add_main(path, |to| to.write_all(text.as_bytes()))
}
