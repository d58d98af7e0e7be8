//! A metric from one mesh to another.
use super::between::log_between;
use super::{Field, Sym3};
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::io::slices::SolutionReader;
use crate::mesh::locate::Locator;
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};
use crate::transfer::{Places, out_of_core};
use std::ops::Range;
use std::sync::Arc;

/// A metric that came from another mesh.
pub struct Transferred {
    /// ln M at the points, shape (n,).
    pub logs: Vec<Sym3>,
    /// Points outside the other mesh: they have the metric of its nearest point.
    pub outside: usize,
    /// Greatest distance of a point from the other mesh, length.
    pub farthest: f64,
}

/// ln M at points, as it is between the vertices of the tetrahedron of `mesh` that each lies in (METHOD.md §1.2), from ln M at these. Nearer to
/// the mesh than 1e-9 of its size is not outside.
///
/// # Panics
/// When there are not as many metrics as vertices, or no tetrahedron.
pub fn transfer(team: Team<'_>, mesh: Arc<TetMesh>, logs: &[Sym3], points: &[Vec3]) -> Transferred {
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    let locator = Locator::on(team, mesh, faces);
    let places = Places::of(team, &locator, points);
    assert_eq!(locator.vertices().len(), logs.len(), "one ln M a vertex");
    let logs = at(team, locator.tets(), &places, logs);
    Transferred { logs, outside: places.outside, farthest: places.farthest }
}

/// ln M at places in tetrahedra of these nodes, shape (m, 4), from ln M at all nodes.
///
/// # Panics
/// When a place or a node is not there.
pub fn at(team: Team<'_>, tets: &[[u32; 4]], places: &Places, logs: &[Sym3]) -> Vec<Sym3> {
    team.map(GRAIN, places.len(), |i| {
        log_between(tets[places.tets[i] as usize].map(|node| &logs[node as usize]), places.weights[i])
    })
}

/// M, shape (n, 6), at places in a mesh, from that at its vertices, which is positive definite.
///
/// # Panics
/// When there are not as many metrics as vertices, or the places are of another mesh.
pub fn tensors_at(team: Team<'_>, locator: &Locator, places: &Places, tensors: &[[f64; 6]]) -> Vec<[f64; 6]> {
    assert_eq!(locator.vertices().len(), tensors.len(), "one metric a vertex");
    let logs = team.map(GRAIN, tensors.len(), |v| Sym3(tensors[v]).ln());
    let logs = at(team, locator.tets(), places, &logs);
    team.map(GRAIN, logs.len(), |v| logs[v].exp().0)
}

/// The metric of a file, or the isotropic one of its sizes, to be brought to another mesh by slices as [`tensors_at`] does it in memory.
pub struct OfFile<'f>(pub &'f SolutionReader);

impl out_of_core::Field for OfFile<'_> {
    fn width(&self) -> usize {
        6
    }

    fn rows(&self, range: Range<usize>) -> Result<Vec<f64>, out_of_core::Wrong> {
        Ok(Field::tensors_in(Team::alone(), self.0, range)?.into_flattened())
    }

    fn interpolated(&self, rows: &[f64]) -> Option<Vec<f64>> {
        Some(rows.as_chunks().0.iter().flat_map(|&tensor| Sym3(tensor).ln().0).collect())
    }

    fn interpolate(&self, tets: &[[u32; 4]], places: &Places, rows: &[f64]) -> Vec<f64> {
        let logs: Vec<Sym3> = rows.as_chunks().0.iter().map(|&log| Sym3(log)).collect();
        at(Team::alone(), tets, places, &logs).iter().flat_map(|log| log.exp().0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_linear_logarithm_is_met_and_what_is_outside_told() {
        let mesh = cube(3);
        let log = |p: Vec3| Sym3([p[0], 2.0 * p[1], 1.0 - p[2], p[0] - p[1], 0.5, p[2]]);
        let logs: Vec<Sym3> = mesh.vertices.iter().map(|&p| log(p)).collect();
        let points = [[0.1, 0.2, 0.3], [0.9, 0.05, 0.61], [0.5, 0.5, 1.25], [1.0, 1.0, 1.0], [0.25, -1e-12, 0.5]];
        let found = transfer(Team::alone(), Arc::new(mesh), &logs, &points);
        assert_eq!(found.outside, 1);
        assert!((found.farthest - 0.25).abs() < 1e-14);
        for (i, nearest) in [points[0], points[1], [0.5, 0.5, 1.0], points[3], points[4]].into_iter().enumerate() {
            let expected = log(nearest);
            assert!((0..6).all(|k| (found.logs[i].0[k] - expected.0[k]).abs() < 1e-11), "{i} {:?}", found.logs[i]);
        }
    }
}
