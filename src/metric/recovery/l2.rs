//! Recovery by L2 projection: the gradients of the linear elements are averaged to the vertices, then those of that field once more
//! (lumped mass matrix: each tetrahedron weighs by its volume; Clément 1975, Alauzet & Loseille 2016, section 2.3).
use super::rings::Rings;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, add, area2, dot, scale, sub};
use crate::metric::Sym3;
use crate::tasks::{GRAIN, Team};

/// Items a task: a vertex has some twenty tetrahedra.
const VERTICES: usize = GRAIN / 8;

/// The Hessian of a field at the vertices, (n,) from values (n,). On the boundary the averages are one-sided, so that the second ones
/// are wrong even for a quadratic function. Vertices there take the mean of |H| of their neighbours inside, if there are any.
pub fn hessians(team: Team<'_>, mesh: &TetMesh, rings: &Rings, values: &[f64]) -> Vec<Sym3> {
    let gradients =
        team.map(VERTICES, values.len(), |v| gradient(mesh, rings, v as u32, |node| [values[node as usize]])[0]);
    let found = team.map(VERTICES, values.len(), |v| {
        let [x, y, z] = gradient(mesh, rings, v as u32, |node| gradients[node as usize]);
        let half = |a: f64, b: f64| 0.5 * (a + b);
        Sym3([x[0], half(x[1], y[0]), y[1], half(x[2], z[0]), half(y[2], z[1]), z[2]])
    });
    let known = team.map(VERTICES, found.len(), |v| rings.is_inside(v as u32).then(|| found[v].magnitude()));
    let filled = super::extrapolate::fill(team, rings, known);
    team.map(VERTICES, found.len(), |v| match filled[v] {
        Some(mean) if !rings.is_inside(v as u32) => mean,
        _ => found[v],
    })
}

/// The gradients of N fields at `count` vertices, with a value of each at a vertex.
pub fn gradients_of<const N: usize>(
    team: Team<'_>,
    mesh: &TetMesh,
    rings: &Rings,
    count: usize,
    value: impl Fn(u32) -> [f64; N] + Sync,
) -> Vec<[Vec3; N]> {
    team.map(VERTICES, count, |v| gradient(mesh, rings, v as u32, &value))
}

/// Mean gradient of N fields over the tetrahedra at a vertex, weighted by volume; zero where they have none.
#[inline(always)]
fn gradient<const N: usize>(mesh: &TetMesh, rings: &Rings, vertex: u32, value: impl Fn(u32) -> [f64; N]) -> [Vec3; N] {
    let (mut sums, mut volume) = ([[0.0; 3]; N], 0.0);
    // Only differences from the vertex enter: large constants do no harm.
    let own = value(vertex);
    for tet in rings.tets(vertex) {
        let nodes = mesh.tets.nodes[tet];
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        // Six times the volume times the gradients of the barycentric coordinates: their sum vanishes.
        let normals = [area2(a, c, d), area2(a, d, b), area2(a, b, c)];
        let first = scale(add(add(normals[0], normals[1]), normals[2]), -1.0);
        volume += dot(normals[0], sub(b, a));
        for (node, normal) in nodes.into_iter().zip([first, normals[0], normals[1], normals[2]]) {
            let there = value(node);
            for i in 0..N {
                sums[i] = add(sums[i], scale(normal, there[i] - own[i]));
            }
        }
    }
    if volume == 0.0 { [[0.0; 3]; N] } else { sums.map(|sum| scale(sum, 1.0 / volume)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn quadratics_are_met_two_layers_inside() {
        let mesh = cube(6);
        let rings = Rings::of(Team::alone(), &mesh);
        let exact = Sym3([2.0, -1.0, 3.0, 0.5, 4.0, -6.0]);
        let values: Vec<f64> = mesh.vertices.iter().map(|&p| 7.0 + p[0] - p[1] + 0.5 * exact.quadratic(p)).collect();
        let found = hessians(Team::alone(), &mesh, &rings, &values);
        for (p, h) in mesh.vertices.iter().zip(&found) {
            let is_deep = p.iter().all(|x| (0.3..0.7).contains(x));
            for i in 0..6 {
                assert!(h.0[i].is_finite());
                assert!(!is_deep || (h.0[i] - exact.0[i]).abs() < 1e-10, "{p:?} {h:?}");
            }
        }
    }

    #[test]
    fn the_boundary_takes_what_is_inside_whatever_its_sign() {
        let mesh = cube(8);
        let rings = Rings::of(Team::alone(), &mesh);
        // Bends one way up to y = 9/16 and the other way from there on, between two layers of vertices.
        let values: Vec<f64> = mesh.vertices.iter().map(|p| 4.0 * (p[1] - 0.5625).powi(3)).collect();
        let found = hessians(Team::alone(), &mesh, &rings, &values);
        let middle = mesh.vertices.iter().position(|&p| p == [0.0, 0.5, 0.5]).unwrap();
        let inside: Vec<&u32> = rings.neighbours(middle as u32).iter().filter(|&&v| rings.is_inside(v)).collect();
        let bends = inside.iter().map(|&&v| found[v as usize].0[2]);
        let (least, greatest) = bends.fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
        assert!(least < -1.0 && greatest > 1.0, "both ways: {least} {greatest}");
        let sum = inside.iter().fold(Sym3::ZERO, |sum, &&v| sum.plus(found[v as usize].magnitude()));
        let mean = sum.times(1.0 / inside.len() as f64);
        assert!((0..6).all(|i| (found[middle].0[i] - mean.0[i]).abs() < 1e-12), "{:?} for {mean:?}", found[middle]);
        assert!(mean.0[2] > 1.0, "{mean:?}");
    }
}
