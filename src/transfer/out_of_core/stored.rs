//! A mesh of which the points lie in a scratch folder.
use super::Error;
use crate::mesh::io::MeshCounts;
use crate::mesh::io::slices::MeshReader;
use crate::mesh::locate::Size;
use crate::mesh::ranges::{Column, Numbering, Scratch, check_all_but_tets};
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};
use std::ops::Range;

/// Vertices of a slice.
const SLICE: usize = 4 * GRAIN;

/// Most points that stand for all of a mesh.
const SAMPLES: usize = 1 << 16;

/// A mesh, by its file.
pub(super) struct Stored<'m> {
    mesh: &'m MeshReader,
    /// Coordinates of the vertices.
    pub points: Column<Vec3>,
    /// The box of the vertices.
    pub bounds: [Vec3; 2],
    /// Every so many-th vertex, and how many that is.
    pub samples: (Vec<Vec3>, usize),
}

/// Some tetrahedra with their vertices.
pub(super) struct Slice {
    /// By places in `numbers`.
    pub nodes: Vec<[u32; 4]>,
    /// Vertices, ascending.
    pub numbers: Vec<u32>,
    /// Their coordinates.
    pub points: Vec<Vec3>,
}

impl<'m> Stored<'m> {
    /// Reads the vertices, and all else in the file but tetrahedra, so that what is wrong there is told.
    pub fn read(team: Team<'_>, mesh: &'m MeshReader, scratch: &Scratch) -> Result<Self, Error> {
        check_all_but_tets(team, mesh)?;
        let (points, vertices) = (scratch.column()?, mesh.counts().vertices);
        let step = vertices.div_ceil(SAMPLES).max(1);
        let slices = team.chunks(SLICE, vertices, |range| -> Result<_, Error> {
            let slice = mesh.vertices(Team::alone(), range.clone())?.0;
            points.write(range.start, &slice)?;
            let first = range.start.next_multiple_of(step) - range.start;
            let samples: Vec<Vec3> = slice.iter().skip(first).step_by(step).copied().collect();
            Ok((bounds_of(slice.iter().copied()), samples))
        });
        let (mut bounds, mut samples) = (NOTHING, Vec::new());
        for slice in slices {
            let (of_slice, more) = slice?;
            bounds = joined(bounds, of_slice);
            samples.extend(more);
        }
        Ok(Self { mesh, points, bounds, samples: (samples, step) })
    }

    /// The file.
    pub fn mesh(&self) -> &'m MeshReader {
        self.mesh
    }

    /// Its counts.
    pub fn counts(&self) -> &MeshCounts {
        self.mesh.counts()
    }

    /// Its size, as that of the mesh in memory.
    pub fn size(&self) -> Size {
        Size::of(self.bounds)
    }

    /// Nodes of some tetrahedra, shape (n, 4).
    pub fn tets(&self, range: Range<usize>) -> Result<Vec<[u32; 4]>, Error> {
        Ok(self.mesh.tets(Team::alone(), range)?.nodes)
    }

    /// Reads all tetrahedra, so that what is wrong is told.
    pub fn check_tets(&self, team: Team<'_>) -> Result<(), Error> {
        let slices = team.chunks(SLICE, self.counts().tets, |range| self.tets(range).map(drop));
        slices.into_iter().collect()
    }

    /// Some tetrahedra of these nodes with their vertices.
    pub fn slice(&self, mut nodes: Vec<[u32; 4]>) -> Result<Slice, Error> {
        let numbering = Numbering::of(nodes.as_flattened().iter().copied());
        nodes.as_flattened_mut().iter_mut().for_each(|v| *v = numbering.place(*v));
        let numbers = numbering.into_numbers();
        let points = self.points.at(&numbers)?;
        Ok(Slice { nodes, numbers, points })
    }
}

impl Slice {
    /// Corners of a tetrahedron.
    #[inline]
    pub fn corners(&self, tet: usize) -> [Vec3; 4] {
        self.nodes[tet].map(|v| self.points[v as usize])
    }
}

/// The box of nothing.
pub(super) const NOTHING: [Vec3; 2] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// The box of some points.
pub(super) fn bounds_of(points: impl IntoIterator<Item = Vec3>) -> [Vec3; 2] {
    points.into_iter().fold(NOTHING, |bounds, p| joined(bounds, [p; 2]))
}

/// The box of two.
#[inline]
pub(super) fn joined(a: [Vec3; 2], b: [Vec3; 2]) -> [Vec3; 2] {
    [std::array::from_fn(|k| a[0][k].min(b[0][k])), std::array::from_fn(|k| a[1][k].max(b[1][k]))]
}

/// Whether two touch.
#[inline]
pub(super) fn touch(a: &[Vec3; 2], b: &[Vec3; 2]) -> bool {
    (0..3).all(|k| a[0][k] <= b[1][k] && b[0][k] <= a[1][k])
}
