//! What is needed of the mesh, in a scratch folder.
use super::{Error, SLICE, Sizes, each_slice};
use crate::mesh::io::slices::MeshReader;
use crate::mesh::ranges::{Blocks, Classes, Column, Neighbours, Numbering, Scratch, check_all_but_tets};
use crate::mesh::vector::{Vec3, volume6};
use crate::metric::multiscale::Extent;
use crate::metric::{Sym3, field};
use crate::tasks::{GRAIN, Team};

/// A tetrahedron.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Tet {
    nodes: [u32; 4],
    /// Six times its volume.
    volume6: f64,
}

/// A mesh in a scratch folder.
pub(super) struct Mesh {
    /// Number of vertices.
    pub vertices: usize,
    /// Their coordinates.
    pub points: Column<Vec3>,
    /// Their neighbours.
    pub neighbours: Neighbours,
    /// The diagonal of the box of the vertices that tetrahedra have.
    pub diameter: f64,
    /// The tetrahedra in the order of the file.
    tets: Column<Tet>,
    count: usize,
}

impl Mesh {
    /// Reads it, and all else in its file, so that what is wrong there is told.
    pub fn read(team: Team<'_>, mesh: &MeshReader, sizes: &Sizes, scratch: &Scratch) -> Result<Self, Error> {
        let counts = *mesh.counts();
        check_all_but_tets(team, mesh)?;
        let points = scratch.column()?;
        each_slice(team, SLICE, counts.vertices, |range| {
            Ok(points.write(range.start, &mesh.vertices(Team::alone(), range)?.0)?)
        })?;
        let (tets, classes) = (scratch.column()?, Classes::of(counts.vertices));
        let found = each_slice(team, sizes.slice, counts.tets, |range| {
            let nodes = mesh.tets(Team::alone(), range.clone())?.nodes;
            let numbering = Numbering::of(nodes.iter().flatten().copied());
            let known = points.at(&numbering.numbers)?;
            let at = |v: u32| known[numbering.place(v) as usize];
            let of = |&nodes: &[u32; 4]| {
                let [a, b, c, d] = nodes.map(at);
                Tet { nodes, volume6: volume6(a, b, c, d) }
            };
            tets.write(range.start, &nodes.iter().map(of).collect::<Vec<Tet>>())?;
            let bits: Vec<_> = nodes.chunks(sizes.block).map(|block| classes.bits(block)).collect();
            Ok((Extent::of(known.iter().copied()), bits))
        })?;
        let diameter = found.iter().fold(Extent::NONE, |extent, &(other, _)| extent.and(other)).diagonal();
        let bits = found.into_iter().flat_map(|(_, bits)| bits).collect();
        let blocks = Blocks { classes, size: sizes.block, tets: counts.tets, bits };
        let neighbours = Neighbours::of(team, mesh, &blocks, sizes.range, scratch)?;
        Ok(Self { vertices: counts.vertices, points, neighbours, diameter, tets, count: counts.tets })
    }

    /// What `f` makes of ln M at each vertex, shape (n,).
    pub fn of_each(
        &self,
        team: Team<'_>,
        logs: &Column<Sym3>,
        f: impl Fn(&Sym3) -> f64 + Sync,
    ) -> Result<Vec<f64>, Error> {
        let mut all = vec![0.0; self.vertices];
        let mut slices: Vec<_> = all.chunks_mut(SLICE).map(|slice| (slice, Ok(()))).collect();
        team.fill(1, &mut slices, |index, slices| {
            for ((slice, result), index) in slices.iter_mut().zip(index..) {
                let start = index * SLICE;
                *result = logs.read(start..start + slice.len()).map(|logs| {
                    slice.iter_mut().zip(&logs).for_each(|(value, log)| *value = f(log));
                });
            }
        });
        slices.into_iter().try_for_each(|(_, result)| result)?;
        Ok(all)
    }

    /// Complexity Σ_v √det(M_v)·V_v of ln M at the vertices, to the bit as [`field::complexity_of_logs`].
    pub fn complexity(&self, team: Team<'_>, logs: &Column<Sym3>) -> Result<f64, Error> {
        let densities = self.of_each(team, logs, field::density)?;
        let of_tet = |tet: &Tet| field::share(tet.volume6, tet.nodes.map(|v| densities[v as usize]));
        Ok(self.sum(team, |tets| Ok(tets.iter().map(of_tet).sum()))? / field::SHARES)
    }

    /// Complexity ∫ √det M of what is between the vertices, to the bit as [`field::complexity_between`].
    pub fn complexity_between(&self, team: Team<'_>, logs: &Column<Sym3>) -> Result<f64, Error> {
        self.sum(team, |tets| {
            let numbering = Numbering::of(tets.iter().flat_map(|tet| tet.nodes));
            let logs = logs.at(&numbering.numbers)?;
            let log = |v: u32| &logs[numbering.place(v) as usize];
            Ok(tets.iter().map(|tet| field::share_between(tet.volume6, tet.nodes.map(log))).sum())
        })
    }

    /// The sum of what `f` makes of the tetrahedra: of the same parts, in the same order as [`Team::sum`] has it in memory.
    fn sum(&self, team: Team<'_>, f: impl Fn(&[Tet]) -> Result<f64, Error> + Sync) -> Result<f64, Error> {
        let parts = each_slice(team, GRAIN, self.count, |range| f(&self.tets.read(range)?))?;
        Ok(parts.into_iter().sum())
    }
}
