//! The metric of a mesh itself: the one in which it is nearest to a unit mesh.
use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, cross, dot, scale, sub, volume6};
use crate::tasks::{GRAIN, Rows, Team};

/// The metric in which all six edges of a tetrahedron have length one; none for a flat or inverted one.
///
/// The six equations e_kᵀ M e_k = 1 have the solution M = ½ Σ_i ∇λ_i ∇λ_iᵀ, λ_i the barycentric coordinates: along an edge from
/// node i to node j only λ_i and λ_j change, by −1 and 1. Since it is a sum of squares, rounding cannot make it indefinite, as an
/// elimination could.
pub fn unit_metric([a, b, c, d]: [Vec3; 4]) -> Option<Sym3> {
    let six = volume6(a, b, c, d);
    let [u, v, w] = [b, c, d].map(|p| sub(p, a));
    // The sign of a flat tetrahedron is rounding.
    let rounding = 1e-15 * dot(u, u).max(dot(v, v)).max(dot(w, w)).powf(1.5);
    if !(six > rounding && six.is_finite()) {
        return None;
    }
    let [gb, gc, gd] = [cross(v, w), cross(w, u), cross(u, v)].map(|normal| scale(normal, 1.0 / six));
    let ga: Vec3 = std::array::from_fn(|i| -(gb[i] + gc[i] + gd[i]));
    let sum = [ga, gb, gc, gd].into_iter().fold(Sym3::ZERO, |sum, g| sum.plus(Sym3::outer(g, 0.5)));
    sum.is_spd().then_some(sum)
}

/// The metric of a mesh.
pub struct Implied {
    /// ln M at the vertices, shape (n,).
    pub logs: Vec<Sym3>,
    /// Flat or inverted tetrahedra, which were left out.
    pub flat: usize,
    /// Vertices with no good tetrahedron, which have the mean of the whole mesh.
    pub bare: usize,
}

/// At each vertex the log-Euclidean mean, by volume, of the unit metrics of its tetrahedra. Its complexity is about √2/12 for each
/// tetrahedron, 0.6 to 0.7 of the number of vertices. None when all tetrahedra are flat or inverted.
pub fn implied(team: Team<'_>, mesh: &TetMesh) -> Option<Implied> {
    let tets = &mesh.tets.nodes;
    let corners = |t: usize| tets[t].map(|v| mesh.vertices[v as usize]);
    let logs = team.map(GRAIN / 4, tets.len(), |t| unit_metric(corners(t)).map_or(Sym3::ZERO, |m| m.ln()));
    // A volume of 0 marks the tetrahedra that were left out.
    let volumes = team.map(GRAIN, tets.len(), |t| {
        let [a, b, c, d] = corners(t);
        if unit_metric([a, b, c, d]).is_some() { volume6(a, b, c, d) } else { 0.0 }
    });
    let flat: usize =
        team.chunks(GRAIN, tets.len(), |range| range.filter(|&t| volumes[t] == 0.0).count()).into_iter().sum();
    let rows = Rows::by_key(team, mesh.vertices.len(), tets.len(), |t| tets[t]);
    let mean = |tets: &mut dyn Iterator<Item = usize>| {
        let weighted =
            |(sum, volume): (Sym3, f64), t: usize| (sum.plus(logs[t].times(volumes[t])), volume + volumes[t]);
        let (sum, volume) = tets.fold((Sym3::ZERO, 0.0), weighted);
        (volume > 0.0).then(|| sum.times(1.0 / volume))
    };
    let parts = team.chunks(GRAIN, tets.len(), |range| {
        let volume: f64 = volumes[range.clone()].iter().sum();
        (mean(&mut range.clone()).unwrap_or(Sym3::ZERO).times(volume), volume)
    });
    let (sum, volume) =
        parts.into_iter().fold((Sym3::ZERO, 0.0), |(sum, all), (part, volume)| (sum.plus(part), all + volume));
    if volume <= 0.0 {
        return None;
    }
    let whole = sum.times(1.0 / volume);
    let means = team.map(GRAIN, rows.len(), |v| mean(&mut rows.row(v).iter().map(|&entry| entry as usize / 4)));
    let bare = means.iter().filter(|mean| mean.is_none()).count();
    Some(Implied { logs: team.map(GRAIN, means.len(), |v| means[v].unwrap_or(whole)), flat, bare })
}

#[cfg(test)]
mod tests {
    use super::super::field::complexity_of_logs;
    use super::super::random::rotated;
    use super::*;
    use crate::mesh::adjacency::EDGES;
    use crate::mesh::samples::cube;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_six_edges_have_length_one(
            frame in rotated(),
            logs in prop::array::uniform3(0.0..6.9f64),
            shape in prop::array::uniform4(prop::array::uniform3(0.0..1.0f64)),
        ) {
            let h = logs.map(f64::exp);
            prop_assume!(volume6(shape[0], shape[1], shape[2], shape[3]).abs() > 1e-2);
            let point = |x: Vec3| -> Vec3 { std::array::from_fn(|i| (0..3).map(|k| h[k] * x[k] * frame[k][i]).sum()) };
            let mut tet = shape.map(point);
            if volume6(tet[0], tet[1], tet[2], tet[3]) < 0.0 {
                tet.swap(0, 1);
            }
            let m = unit_metric(tet).unwrap();
            for [i, j] in EDGES {
                prop_assert!((m.quadratic(sub(tet[j], tet[i])) - 1.0).abs() < 1e-6, "{}", m.quadratic(sub(tet[j], tet[i])));
            }
            tet.swap(0, 1);
            prop_assert!(unit_metric(tet).is_none());
        }
    }

    #[test]
    fn the_metric_of_a_cube() {
        let mut mesh = cube(4);
        mesh.vertices.iter_mut().for_each(|p| p[2] *= 1e-3);
        mesh.vertices.push([9.0; 3]);
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]);
        assert!(unit_metric(square).is_none());
        let found = implied(Team::alone(), &mesh).unwrap();
        assert_eq!((found.flat, found.bare), (0, 1));
        // Each unit tetrahedron has the volume √2/12 in its metric; those of the cube are alike.
        let expected = 2f64.sqrt() / 12.0 * mesh.tets.len() as f64;
        let complexity = complexity_of_logs(Team::alone(), &mesh, &found.logs);
        assert!((complexity / expected - 1.0).abs() < 1e-9, "{complexity} {expected}");
        for log in &found.logs {
            let h = log.exp().sizes();
            assert!(h[0] < 0.5 && h[2] > 1e-4 && h[2] < 5e-4, "{h:?}");
        }
        mesh.tets.nodes.iter_mut().for_each(|tet| tet.swap(0, 1));
        assert!(implied(Team::alone(), &mesh).is_none());
    }
}
