//! How much is done at once.
use super::Error;
use super::part::Tet;
use crate::mesh::io::MeshCounts;
use crate::mesh::ranges::{Bins, PROGRAM};
use crate::transfer::Which;

/// A tetrahedron of a part with its share of the vertices, while the part is made and searched, without the values.
const OF_TET: usize = 190;

/// Values of a tetrahedron of a part: about a quarter of a vertex is its own.
const VALUES_OF_TET: usize = 2;

/// A point with its place, without the values.
const OF_POINT: usize = 140;

/// A point that waits for its nearest tetrahedron.
const OF_FAR: usize = 160;

/// What is there besides parts: samples of both meshes, new vertices that wait to be written, slices of tetrahedra.
const BESIDE: usize = 18_000_000;

/// Least memory of a task.
const OF_TASK: usize = 6_000_000;

/// Most memory of a task: larger parts are no better.
const MOST: usize = 80_000_000;

/// Tetrahedra of a slice.
const SLICE: usize = 1 << 14;

/// How much is done at once. Results do not depend on it.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Bytes of a task: a part of the old mesh with the points in it.
    pub task: usize,
    /// Bytes of what waits in memory for a pass over the old mesh.
    pub waiting: usize,
    /// Tetrahedra of a slice.
    pub slice: usize,
}

impl Sizes {
    /// Those for so many bytes and threads, and rows of so many values.
    ///
    /// # Errors
    /// [`Error::Memory`] when that is too little, [`Error::Tetrahedra`] for more tetrahedra than 32 bits count.
    pub fn of(memory: u64, threads: usize, width: usize, [old, new]: [&MeshCounts; 2]) -> Result<Self, Error> {
        for (mesh, counts) in [(Which::Old, old), (Which::New, new)] {
            if counts.tets >= u32::MAX as usize {
                return Err(Error::Tetrahedra { mesh, tets: counts.tets });
            }
        }
        let memory = usize::try_from(memory).unwrap_or(usize::MAX);
        let slices = threads * 24 * width * SLICE / 4;
        let (held, least) = (PROGRAM + BESIDE + slices, OF_TASK + 40 * width * 1000);
        let share = |beside: usize| (memory.saturating_sub(held + beside) / threads).clamp(least, MOST.max(least));
        let sizes = Self { task: share(0), waiting: 0, slice: SLICE };
        // What deals out old tetrahedra, of which many are in two cells.
        let cells = 2 * sizes.of_part(old.tets, new.vertices, width) / sizes.task;
        let bins = Bins::<Tet>::held(cells, 2 * old.tets);
        let needed = held + bins + threads * least;
        if memory < needed {
            return Err(Error::Memory { width, threads, memory, needed });
        }
        let task = share(bins);
        Ok(Self { task, waiting: task * threads, ..sizes })
    }

    /// Bytes of a part with so many tetrahedra and points in it.
    pub fn of_part(&self, tets: usize, points: usize, width: usize) -> usize {
        (OF_TET + 8 * VALUES_OF_TET * width) * tets + (OF_POINT + 16 * width) * points
    }

    /// Points that may wait for their nearest tetrahedra at once.
    pub fn far(&self, width: usize) -> usize {
        (self.waiting / (OF_FAR + 40 * width)).max(1)
    }
}
