//! Volumes and integrals by slices.
use super::Error;
use super::stored::Stored;
use crate::mesh::ranges::Table;
use crate::tasks::{GRAIN, Team};
use crate::transfer::mass::{Component, bounds_of, components, joined, masses_of, part_of_sums, volume_of};

/// The volume of a mesh, and each component of the rows of values at its vertices, to the bit as [`crate::transfer::measure`].
pub(super) fn measure(team: Team<'_>, mesh: &Stored<'_>, rows: &Table) -> Result<(f64, Vec<Component>), Error> {
    let (width, counts) = (rows.width(), mesh.counts());
    let parts = team.chunks(GRAIN, counts.tets, |range| -> Result<_, Error> {
        let slice = mesh.slice(mesh.tets(range)?)?;
        let values = rows.at(&slice.numbers)?;
        let masses = |tet: usize, row: &mut [f64]| masses_of(slice.nodes[tet], &slice.points, &values, row);
        Ok(part_of_sums(0..slice.nodes.len(), width + 1, masses))
    });
    let masses = joined(width + 1, parts.into_iter().collect::<Result<Vec<_>, _>>()?);
    let bounds = team.chunks(GRAIN, counts.vertices, |range| Ok(bounds_of(width, &rows.read(range)?)));
    Ok(components(masses, bounds.into_iter().collect::<Result<Vec<_>, Error>>()?))
}

/// The volume of a mesh.
pub(super) fn volume(team: Team<'_>, mesh: &Stored<'_>) -> Result<f64, Error> {
    let parts = team.chunks(GRAIN, mesh.counts().tets, |range| -> Result<_, Error> {
        let slice = mesh.slice(mesh.tets(range)?)?;
        Ok(part_of_sums(0..slice.nodes.len(), 1, |tet, row| row[0] = volume_of(slice.corners(tet))))
    });
    Ok(joined(1, parts.into_iter().collect::<Result<Vec<_>, _>>()?)[0])
}
