//! A mesh larger than memory, by ranges of its vertices, each with all tetrahedra at them.
//!
//! Slices of the tetrahedra in the order of the file tell which classes of vertices each block of them has ([`Blocks`]). So a range of vertices
//! reads the blocks alone that may have some of its tetrahedra ([`each_range`]). What is known of single vertices is read for each slice and range
//! anew ([`gathered`]), or lies in a scratch folder ([`Column`], [`Table`], [`Neighbours`]; [`Bins`] has what belongs together by its place in space).
//!
//! Where tetrahedra that are near each other have near numbers, and so have their vertices, each is read a few times in all; where they have
//! not, every range reads all of the file (docs/decisions/inspection.md).
mod bins;
mod blocks;
mod column;
mod gathered;
mod neighbours;
mod numbering;
mod ranged;
mod table;

pub use bins::Bins;
pub use blocks::{Bits, Blocks, Classes};
pub use column::{Column, Scratch};
pub use gathered::{gathered, runs};
pub use neighbours::{Around, Neighbours};
pub use numbering::{Numbering, renumbered};
pub use ranged::{Ranged, each_range};
pub use table::Table;

use super::io::Error;
use super::io::slices::MeshReader;
use crate::tasks::{GRAIN, Team};

/// Bytes of a block of the index.
pub use blocks::BYTES as OF_BLOCK;

/// Tetrahedra of a block of the index, where nothing speaks for another number.
pub const BLOCK: usize = 1 << 10;

/// Bytes that the program takes before it has read anything, with its threads: 12 MB of code and libraries, and room that the allocator keeps.
pub const PROGRAM: usize = 40_000_000;

/// Reads the lists of a file that nothing is checked of but their numbers.
///
/// # Errors
/// When one is wrong.
pub fn check_lists(mesh: &MeshReader) -> Result<(), Error> {
    let lists = [
        MeshReader::corners,
        MeshReader::ridges,
        MeshReader::required_vertices,
        MeshReader::required_edges,
        MeshReader::required_triangles,
    ];
    lists.into_iter().try_for_each(|list| list(mesh).map(drop))?;
    mesh.association().map(drop)
}

/// Reads what [`check_lists`] does, and the triangles and edges, by slices.
///
/// # Errors
/// When one is wrong.
pub fn check_all_but_tets(team: Team<'_>, mesh: &MeshReader) -> Result<(), Error> {
    check_lists(mesh)?;
    let counts = mesh.counts();
    let triangles = team.chunks(4 * GRAIN, counts.triangles, |range| mesh.triangles(Team::alone(), range).map(drop));
    triangles.into_iter().collect::<Result<(), _>>()?;
    let edges = team.chunks(4 * GRAIN, counts.edges, |range| mesh.edges(Team::alone(), range).map(drop));
    edges.into_iter().collect()
}
