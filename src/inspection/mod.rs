//! A mesh that is larger than memory, checked and measured from its file: the same that [`crate::mesh::validity`] and
//! [`crate::metric::Statistics`] say of a mesh in memory.
//!
//! The file is gone through twice. First the tetrahedra by themselves, slice by slice in their order ([`tets`]): signs, mean ratios, volume, and
//! which vertices each block of them has. Then all that has to do with neighbours, range by range of the vertices ([`stars`]), as
//! [`crate::mesh::ranges`] reads them. Coordinates and metrics are read for each slice and range anew ([`points`]). The boundary alone is held as
//! a whole.
mod error;
mod points;
mod sizes;
mod stars;
#[cfg(test)]
mod tests;
mod tets;

pub use error::Error;
pub use points::Metrics;
pub use sizes::Sizes;

use crate::mesh::Elements;
use crate::mesh::io::slices::MeshReader;
use crate::mesh::ranges::check_lists;
use crate::mesh::validity::{Tagged, Validity, conclude};
use crate::mesh::vector::Vec3;
use crate::metric::Statistics;
use crate::metric::statistics::Part;
use crate::tasks::Team;
use points::Source;

/// What is found.
pub struct Inspected {
    /// Whether it is valid.
    pub validity: Validity,
    /// Its figures.
    pub statistics: Statistics,
    /// Nodes and points of the tetrahedron with the least mean ratio; [`Distribution::argmin`](crate::metric::Distribution::argmin) has its
    /// number.
    pub worst: Option<[Vec3; 4]>,
}

/// Checks a mesh and measures it in a metric, within so many bytes of memory.
///
/// # Errors
/// [`Error::Mesh`] and [`Error::Metric`] when a file cannot be read or is wrong, [`Error::Memory`] when the boundary is too large for that
/// memory, [`Error::Tetrahedra`] for more tetrahedra than 32 bits count.
pub fn inspect(team: Team<'_>, mesh: &MeshReader, metrics: Metrics<'_>, memory: u64) -> Result<Inspected, Error> {
    inspect_by(team, mesh, metrics, &Sizes::of(memory, team.threads(), mesh.counts())?)
}

/// As [`inspect`], by slices and ranges of these sizes.
fn inspect_by(team: Team<'_>, mesh: &MeshReader, metrics: Metrics<'_>, sizes: &Sizes) -> Result<Inspected, Error> {
    let counts = *mesh.counts();
    if counts.tets >= u32::MAX as usize {
        return Err(Error::Tetrahedra { tets: counts.tets });
    }
    check_lists(mesh)?;
    let source = Source { mesh, metrics };
    let (triangles, edges) = (mesh.triangles(team, 0..counts.triangles)?, mesh.edges(team, 0..counts.edges)?);
    let none = Part {
        vertices: &[],
        own_vertices: counts.vertices,
        tets: &Elements::default(),
        triangles: &triangles,
        edges: &edges,
    };
    let figures = source.figures(none, None);
    let tagged = Tagged::of(team, &triangles, &edges);
    let triangles = triangles.nodes;
    drop(edges);
    let (found, blocks, of_tets) = tets::check(team, &source, sizes)?;
    let (stars, lengths) = stars::check(team, &source, sizes, &blocks, &tagged)?;
    drop(blocks);
    sizes.boundary_fits(stars.boundary.len())?;
    let validity = conclude(team, found, &triangles, &tagged, stars, |nodes| source.points(team, nodes))?;
    let statistics = figures.and(of_tets).with(lengths).statistics();
    let worst = match statistics.mean_ratios.argmin {
        t if t < counts.tets => Some(corners(mesh, t)?),
        _ => None,
    };
    Ok(Inspected { validity, statistics, worst })
}

/// The points of a tetrahedron.
fn corners(mesh: &MeshReader, tet: usize) -> Result<[Vec3; 4], Error> {
    let nodes = mesh.tets(Team::alone(), tet..tet + 1)?.nodes[0];
    let mut corners = [[0.0; 3]; 4];
    for (corner, v) in corners.iter_mut().zip(nodes) {
        *corner = mesh.vertices(Team::alone(), v as usize..v as usize + 1)?.0[0];
    }
    Ok(corners)
}
