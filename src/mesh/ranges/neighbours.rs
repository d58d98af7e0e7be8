//! The vertices at the other ends of the edges of each vertex, in a scratch folder.
use super::blocks::Blocks;
use super::column::{Column, Scratch};
use super::gathered::runs;
use super::ranged::each_range;
use crate::mesh::io::Error;
use crate::mesh::io::slices::MeshReader;
use crate::mesh::vertex_neighbours::VertexNeighbours;
use crate::tasks::{Rows, Team};

/// For each vertex the vertices that it has an edge with, ascending, as [`VertexNeighbours`] has them in memory.
#[derive(Debug)]
pub struct Neighbours {
    /// Where each row begins, and the end of the last.
    starts: Column<u64>,
    entries: Column<u32>,
}

/// The rows of some vertices, one after the other.
#[derive(Debug, Default)]
pub struct Around {
    /// Where each row ends among the entries.
    ends: Vec<u32>,
    /// The neighbours.
    pub entries: Vec<u32>,
}

impl Neighbours {
    /// Of a mesh whose tetrahedra are in these blocks, within so many bytes of memory.
    ///
    /// # Errors
    /// When the mesh cannot be read, or the scratch folder not be written.
    pub fn of(
        team: Team<'_>,
        mesh: &MeshReader,
        blocks: &Blocks,
        bytes: usize,
        scratch: &Scratch,
    ) -> Result<Self, Error> {
        let found = Self { starts: scratch.column()?, entries: scratch.column()? };
        found.starts.write(0, &[0])?;
        let (mut vertices, mut before) = (0, 0u64);
        each_range(team, mesh, blocks, bytes, |ranged| -> Result<usize, Error> {
            let around = VertexNeighbours::of(team, &ranged.tets, ranged.numbers.len());
            let (mut starts, mut entries) = (Vec::with_capacity(ranged.own.len()), Vec::new());
            for v in ranged.own.clone() {
                entries.extend(around.of_vertex(v).iter().map(|&other| ranged.numbers[other as usize]));
                starts.push(before + entries.len() as u64);
            }
            found.starts.write(vertices + 1, &starts)?;
            found.entries.write(before as usize, &entries)?;
            (vertices, before) = (vertices + starts.len(), before + entries.len() as u64);
            Ok(0)
        })?;
        Ok(found)
    }

    /// The rows of these vertices, which ascend.
    ///
    /// # Errors
    /// When the scratch folder cannot be read.
    pub fn around(&self, vertices: &[u32]) -> Result<Around, Error> {
        let mut around = Around { ends: Vec::with_capacity(vertices.len()), entries: Vec::new() };
        let (mut starts, mut run) = (Vec::new(), Vec::new());
        for places in runs(vertices) {
            let (vertices, first) = (&vertices[places.clone()], vertices[places.start]);
            self.starts.read_to(first as usize..vertices[vertices.len() - 1] as usize + 2, &mut starts)?;
            let begin = starts[0];
            self.entries.read_to(begin as usize..starts[starts.len() - 1] as usize, &mut run)?;
            for &vertex in vertices {
                let at = (vertex - first) as usize;
                around
                    .entries
                    .extend_from_slice(&run[(starts[at] - begin) as usize..(starts[at + 1] - begin) as usize]);
                around.ends.push(around.entries.len() as u32);
            }
        }
        Ok(around)
    }
}

impl Around {
    /// The rows, one a vertex.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.ends.len()).map(|at| self.row(at))
    }

    /// The row of the vertex at this place among those that were asked for.
    #[inline]
    pub fn row(&self, at: usize) -> &[u32] {
        let start = if at == 0 { 0 } else { self.ends[at - 1] };
        &self.entries[start as usize..self.ends[at] as usize]
    }

    /// The rows by the places of `numbers`, which ascend: those that were asked for are some of them, the others have empty rows. All neighbours
    /// must be among them, where `place` says.
    pub fn within(&self, vertices: &[u32], numbers: &[u32], place: impl Fn(u32) -> u32) -> VertexNeighbours {
        let mut next = 0;
        let (mut ends, mut entries) = (Vec::with_capacity(numbers.len()), Vec::with_capacity(self.entries.len()));
        for number in numbers {
            if vertices.get(next) == Some(number) {
                entries.extend(self.row(next).iter().map(|&other| place(other)));
                next += 1;
            }
            ends.push(entries.len() as u32);
        }
        VertexNeighbours::of_rows(Rows::of_parts(Team::alone(), &[(ends, entries)]))
    }
}
