//! How much is done at once.
use super::Error;
use crate::mesh::io::MeshCounts;
use crate::mesh::ranges::{BLOCK, OF_BLOCK, PROGRAM};
use crate::metric::gradation::front;

/// √det M of a vertex, while a sum is taken, or the number that percentiles are taken of.
const OF_VERTEX: usize = 8;

/// Least memory for a range of vertices with all tetrahedra at them.
const LEAST: usize = 20_000_000;

/// Memory of a task: less makes halos large.
const OF_TASK: usize = 12_000_000;

/// How much is done at once. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Tetrahedra of a slice: a multiple of `block`.
    pub slice: usize,
    /// Tetrahedra of a block of the index.
    pub block: usize,
    /// Bytes for a range of vertices with all tetrahedra at them.
    pub range: usize,
    /// Most vertices of a task that has others around them.
    pub vertices: usize,
    /// Bytes for these vertices and those around them.
    pub task: usize,
}

impl Sizes {
    /// Those for so many bytes and threads.
    ///
    /// # Errors
    /// [`Error::Memory`] when that is too little, [`Error::Tetrahedra`] for more tetrahedra than 32 bits count.
    pub fn of(memory: u64, threads: usize, is_graded: bool, counts: &MeshCounts) -> Result<Self, Error> {
        let (vertices, tets) = (counts.vertices, counts.tets);
        if tets >= u32::MAX as usize {
            return Err(Error::Tetrahedra { tets });
        }
        let memory = usize::try_from(memory).unwrap_or(usize::MAX);
        let index = tets / BLOCK * OF_BLOCK;
        let held = vertices * if is_graded { front::OF_VERTEX } else { OF_VERTEX };
        let needed = PROGRAM + (index + LEAST).max(held + threads * OF_TASK);
        if memory < needed {
            return Err(Error::Memory { vertices, threads, memory, needed });
        }
        let range = memory - PROGRAM - index;
        Ok(Self { slice: 32 * BLOCK, block: BLOCK, range, vertices: 1 << 14, task: (memory - PROGRAM) / threads })
    }
}
