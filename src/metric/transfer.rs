//! A metric from one mesh to another.
use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::locate::Locator;
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::{GRAIN, Team};

/// A metric that came from another mesh.
pub struct Transferred {
    /// ln M at the points, shape (n,).
    pub logs: Vec<Sym3>,
    /// Points outside the other mesh: they have the metric of its nearest point.
    pub outside: usize,
    /// Greatest distance of a point from the other mesh, length.
    pub farthest: f64,
}

/// ln M at points, log-Euclidean in the tetrahedron of `mesh` that each lies in, from ln M at its vertices (METHOD.md §1). Nearer to
/// the mesh than 1e-9 of its size is not outside.
///
/// # Panics
/// When there are not as many metrics as vertices, or no tetrahedron.
pub fn transfer(team: Team<'_>, mesh: &TetMesh, logs: &[Sym3], points: &[Vec3]) -> Transferred {
    assert_eq!(mesh.vertices.len(), logs.len(), "one ln M a vertex");
    let locator = Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone());
    let corner = |f: fn(f64, f64) -> f64| {
        mesh.vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
    };
    let tolerance = 1e-9 * distance(corner(f64::min), corner(f64::max));
    let parts = team.chunks(GRAIN / 4, points.len(), |range| {
        // Points that follow one another are near each other; the hint starts anew with each chunk, so threads make no difference.
        let (mut hint, mut outside, mut farthest) = (0, 0, 0.0f64);
        let mut found = Vec::with_capacity(range.len());
        for &p in &points[range] {
            let place = locator.locate(p, &mut hint);
            let nodes = locator.tets()[place.tet as usize];
            let weighted = nodes.into_iter().zip(place.weights).map(|(node, weight)| logs[node as usize].times(weight));
            found.push(weighted.fold(Sym3::ZERO, Sym3::plus));
            outside += usize::from(place.distance > tolerance);
            farthest = farthest.max(place.distance);
        }
        (found, outside, farthest)
    });
    let outside = parts.iter().map(|part| part.1).sum();
    let farthest = parts.iter().map(|part| part.2).fold(0.0, f64::max);
    Transferred { logs: team.join(parts.into_iter().map(|part| part.0).collect()), outside, farthest }
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
        let found = transfer(Team::alone(), &mesh, &logs, &points);
        assert_eq!(found.outside, 1);
        assert!((found.farthest - 0.25).abs() < 1e-14);
        for (i, nearest) in [points[0], points[1], [0.5, 0.5, 1.0], points[3], points[4]].into_iter().enumerate() {
            let expected = log(nearest);
            assert!((0..6).all(|k| (found.logs[i].0[k] - expected.0[k]).abs() < 1e-11), "{i} {:?}", found.logs[i]);
        }
    }
}
