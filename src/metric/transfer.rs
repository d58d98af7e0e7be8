//! A metric from one mesh to another.
use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::locate::Locator;
use crate::mesh::vector::Vec3;
use crate::tasks::{GRAIN, Team};
use crate::transfer::Places;
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

/// ln M at points, log-Euclidean in the tetrahedron of `mesh` that each lies in, from ln M at its vertices (METHOD.md §1.2). Nearer to
/// the mesh than 1e-9 of its size is not outside.
///
/// # Panics
/// When there are not as many metrics as vertices, or no tetrahedron.
pub fn transfer(team: Team<'_>, mesh: Arc<TetMesh>, logs: &[Sym3], points: &[Vec3]) -> Transferred {
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    let locator = Locator::on(team, mesh, faces);
    let places = Places::of(team, &locator, points);
    Transferred { logs: at(team, &locator, &places, logs), outside: places.outside, farthest: places.farthest }
}

/// ln M at places in a mesh, from ln M at its vertices.
///
/// # Panics
/// When there are not as many metrics as vertices, or the places are of another mesh.
pub fn at(team: Team<'_>, locator: &Locator, places: &Places, logs: &[Sym3]) -> Vec<Sym3> {
    assert_eq!(locator.vertices().len(), logs.len(), "one ln M a vertex");
    team.map(GRAIN, places.len(), |i| {
        let nodes = locator.tets()[places.tets[i] as usize];
        let weighted = nodes.into_iter().zip(places.weights[i]).map(|(node, weight)| logs[node as usize].times(weight));
        weighted.fold(Sym3::ZERO, Sym3::plus)
    })
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
