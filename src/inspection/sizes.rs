//! How much is done at once.
use super::Error;
use crate::mesh::io::MeshCounts;
use crate::mesh::ranges::{BLOCK, OF_BLOCK, PROGRAM};

/// A triangle while the boundary is checked, at most: its nodes thrice, the tree of boxes for crossings, its share of the points.
const OF_TRIANGLE: usize = 300;

/// A tagged edge.
const OF_EDGE: usize = 24;

/// A tetrahedron of a slice whose nodes are its own alone, with coordinates and metrics: the worst case.
const OF_SLICED: usize = 700;

/// Most tetrahedra of a slice.
const SLICE: usize = 1 << 16;

/// Least memory that a range of vertices is given.
const LEAST: usize = 40_000_000;

/// How much is done at once. Results do not depend on it, but for the rounding of sums.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Tetrahedra of a slice: a multiple of `block`.
    pub slice: usize,
    /// Tetrahedra of a block of the index.
    pub block: usize,
    /// Bytes for a range of vertices with all at them.
    pub range: usize,
    /// Bytes in all; none where that is not limited.
    pub memory: Option<usize>,
}

impl Sizes {
    /// Those for so many bytes and threads.
    ///
    /// # Errors
    /// [`Error::Memory`] when the boundary does not fit.
    pub fn of(memory: u64, threads: usize, counts: &MeshCounts) -> Result<Self, Error> {
        let memory = usize::try_from(memory).unwrap_or(usize::MAX);
        // Keys and nodes; the faces of the boundary come beside them while the vertices are gone through.
        let index = counts.tets / BLOCK * OF_BLOCK;
        let held = PROGRAM + 44 * counts.triangles + OF_EDGE * counts.edges + index;
        let range = memory.saturating_sub(held);
        let sizes = Self { slice: 0, block: BLOCK, range, memory: Some(memory) };
        if range < LEAST {
            return Err(sizes.too_large(counts.triangles, held + LEAST));
        }
        sizes.boundary_fits(counts.triangles)?;
        let slice = (range / threads / OF_SLICED).clamp(BLOCK, SLICE) / BLOCK * BLOCK;
        Ok(Self { slice, ..sizes })
    }

    /// Refuses a boundary of so many faces that does not fit.
    pub(super) fn boundary_fits(&self, triangles: usize) -> Result<(), Error> {
        let needed = PROGRAM + OF_TRIANGLE * triangles;
        match self.memory {
            Some(memory) if needed > memory => Err(self.too_large(triangles, needed)),
            _ => Ok(()),
        }
    }

    fn too_large(&self, triangles: usize, needed: usize) -> Error {
        Error::Memory { triangles, memory: self.memory.unwrap_or(usize::MAX), needed }
    }
}
