//! Some vertices, with those around them.
use super::Error;
use super::mesh::Mesh;
use crate::mesh::ranges::{Around, Numbering};
use crate::mesh::vector::Vec3;
use crate::mesh::vertex_neighbours::VertexNeighbours;

/// Bytes of a vertex: its number, its place in a table while that grows, its point and value, its neighbours twice.
const OF_VERTEX: usize = 4 + 24 + 32 + 2 * 64;

/// Vertices with some rings around them.
pub(super) struct Local {
    /// The numbers of all of them.
    pub numbering: Numbering,
    /// Their points.
    pub points: Vec<Vec3>,
    /// The neighbours of all but those of the last ring, by places among the numbers.
    pub around: VertexNeighbours,
}

impl Local {
    /// These vertices, which ascend, with so many rings, one at least; none when several do not fit into so many bytes.
    pub fn read(mesh: &Mesh, own: &[u32], rings: usize, bytes: usize) -> Result<Option<Self>, Error> {
        let fits = |vertices: usize| own.len() <= 1 || vertices * OF_VERTEX <= bytes;
        let mut inner = own.to_vec();
        // All but the last ring: its vertices have neighbours that are not needed.
        for _ in 1..rings {
            let around = mesh.neighbours.around(&inner)?;
            let Some(grown) = Numbering::of_at_most(with(&inner, &around), fits) else { return Ok(None) };
            inner = grown.into_numbers();
        }
        let around = mesh.neighbours.around(&inner)?;
        let Some(numbering) = Numbering::of_at_most(with(&inner, &around), fits) else { return Ok(None) };
        let points = mesh.points.at(&numbering.numbers)?;
        let around = around.within(&inner, &numbering.numbers, |v| numbering.place(v));
        Ok(Some(Self { numbering, points, around }))
    }
}

/// Vertices, and all neighbours of theirs.
fn with<'v>(vertices: &'v [u32], around: &'v Around) -> impl Iterator<Item = u32> + 'v {
    vertices.iter().chain(&around.entries).copied()
}
