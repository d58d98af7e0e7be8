//! What a run begins with: a mesh with a metric that is read a slice of tetrahedra at a time, and its skin, which is known as a whole.
mod files;
mod shell;
mod skin;

pub use files::{Files, MetricOf};
pub use shell::Shell;
pub use skin::Skin;

use super::Error;
use super::sizes::Sizes;
use crate::mesh::vector::Vec3;
use crate::mesh::{Elements, TetMesh};
use crate::metric::{Source, Sym3};
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// Tetrahedra of a slice for each vertex of a part.
const TETS_A_VERTEX: f64 = 6.0;

/// A mesh with ln M at its vertices, of which ranges are read, by many threads at once.
pub trait Input: Sync {
    /// Vertices and tetrahedra.
    fn size(&self) -> [usize; 2];

    /// These tetrahedra, with the numbers of the whole mesh.
    ///
    /// # Errors
    /// When they cannot be read.
    fn tets(&self, range: Range<usize>) -> Result<Elements<4>, Error>;

    /// These vertices, by their numbers, ascending, shape (n,).
    ///
    /// # Errors
    /// When they cannot be read.
    fn vertices(&self, numbers: &[u32]) -> Result<Vertices, Error>;
}

/// Some vertices.
pub struct Vertices {
    /// Coordinates, shape (n, 3).
    pub points: Vec<Vec3>,
    /// References, shape (n,).
    pub refs: Vec<i32>,
    /// ln M, shape (n,).
    pub logs: Vec<Sym3>,
}

/// The tetrahedra of each slice.
pub fn slices(tets: usize, sizes: &Sizes) -> Vec<Range<usize>> {
    let size = ((TETS_A_VERTEX * sizes.part) as usize).max(1);
    let count = tets.div_ceil(size).max(1);
    (0..count).map(|slice| slice * size..tets.min((slice + 1) * size)).collect()
}

/// A mesh in memory.
pub struct InMemory<'a> {
    /// The mesh.
    pub mesh: &'a TetMesh,
    /// ln M at its vertices, shape (n,).
    pub logs: &'a [Sym3],
}

/// ln M at the vertices of a mesh, shape (n,).
pub fn logs_on(team: Team<'_>, mesh: &TetMesh, source: &Source) -> Vec<Sym3> {
    match source.logs_on(mesh) {
        Some(logs) => logs.to_vec(),
        None => team.map(GRAIN, mesh.vertices.len(), |v| source.log_at(mesh.vertices[v], &mut 0)),
    }
}

impl Input for InMemory<'_> {
    fn size(&self) -> [usize; 2] {
        [self.mesh.vertices.len(), self.mesh.tets.len()]
    }

    fn tets(&self, range: Range<usize>) -> Result<Elements<4>, Error> {
        let Elements { nodes, refs } = &self.mesh.tets;
        Ok(Elements { nodes: nodes[range.clone()].to_vec(), refs: refs[range].to_vec() })
    }

    fn vertices(&self, numbers: &[u32]) -> Result<Vertices, Error> {
        fn those<T: Copy>(list: &[T], numbers: &[u32]) -> Vec<T> {
            numbers.iter().map(|&v| list[v as usize]).collect()
        }
        let Self { mesh, logs } = self;
        Ok(Vertices {
            points: those(&mesh.vertices, numbers),
            refs: those(&mesh.vertex_refs, numbers),
            logs: those(logs, numbers),
        })
    }
}
