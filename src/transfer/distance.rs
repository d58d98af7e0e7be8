//! How far two fields are from each other.
use super::mass::{sums, volume};
use crate::mesh::TetMesh;
use crate::mesh::quadrature::WALKINGTON;
use crate::tasks::{GRAIN, Team};

/// The error of a component of a field.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Distance {
    /// L^p norm of the difference, the p-th root of its integral; for p = ∞ the same as `greatest`.
    pub norm: f64,
    /// L^p norm of the field that it is measured against.
    pub of_truth: f64,
    /// Greatest difference at a vertex, which is that everywhere.
    pub greatest: f64,
}

/// L^p norms of the difference of two fields on one mesh, both linear in each tetrahedron, in rows of `width` values a vertex.
///
/// With a rule of degree 5, which is exact for p = 2 and for the even p = 4. Inverted tetrahedra count for nothing.
///
/// # Panics
/// When a field has not `width` values a vertex.
pub fn distance(
    team: Team<'_>,
    mesh: &TetMesh,
    width: usize,
    values: &[f64],
    truth: &[f64],
    power: f64,
) -> Vec<Distance> {
    for field in [values, truth] {
        assert_eq!(field.len(), width * mesh.vertices.len(), "{width} values a vertex");
    }
    let parts = team.chunks(GRAIN, mesh.vertices.len(), |range| {
        let mut greatest = vec![[0.0f64; 2]; width];
        for at in range.start * width..range.end * width {
            let [off, of] = &mut greatest[at % width];
            (*off, *of) = (off.max((values[at] - truth[at]).abs()), of.max(truth[at].abs()));
        }
        greatest
    });
    let greatest = |c: usize| parts.iter().fold([0.0f64; 2], |[a, b], part| [a.max(part[c][0]), b.max(part[c][1])]);
    if power.is_infinite() {
        let of = |[off, of]: [f64; 2]| Distance { norm: off, of_truth: of, greatest: off };
        return (0..width).map(|c| of(greatest(c))).collect();
    }
    let integrals = sums(team, mesh.tets.len(), 2 * width, |tet, row| {
        let volume = volume(mesh, tet);
        let nodes = mesh.tets.nodes[tet].map(|v| v as usize * width);
        for (c, terms) in row.chunks_exact_mut(2).enumerate() {
            let of = nodes.map(|node| truth[node + c]);
            let off = nodes.map(|node| values[node + c] - truth[node + c]);
            terms.copy_from_slice(&[off, of].map(|corners| volume * mean_power(corners, power)));
        }
    });
    let root = |integral: f64| integral.powf(1.0 / power);
    let component = |(c, pair): (usize, &[f64])| Distance {
        norm: root(pair[0]),
        of_truth: root(pair[1]),
        greatest: greatest(c)[0],
    };
    integrals.chunks_exact(2).enumerate().map(component).collect()
}

/// Mean of |u|^p over a tetrahedron, u linear with these values at the corners.
fn mean_power(corners: [f64; 4], power: f64) -> f64 {
    let at = |place: &[f64; 4]| (0..4).map(|i| place[i] * corners[i]).sum::<f64>().abs();
    if power == 2.0 {
        return WALKINGTON.iter().map(|(place, weight)| weight * at(place) * at(place)).sum();
    }
    WALKINGTON.iter().map(|(place, weight)| weight * at(place).powf(power)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn norms_that_are_known() {
        // On the unit cube: u = x and 1 against 0 and 3.
        let mesh = cube(4);
        let values: Vec<f64> = mesh.vertices.iter().flat_map(|p| [p[0], 1.0]).collect();
        let truth: Vec<f64> = mesh.vertices.iter().flat_map(|_| [0.0, 3.0]).collect();
        for (power, norm) in [(1.0, 0.5), (2.0, (1.0f64 / 3.0).sqrt()), (4.0, 0.2f64.powf(0.25)), (f64::INFINITY, 1.0)]
        {
            let found = distance(Team::alone(), &mesh, 2, &values, &truth, power);
            assert!((found[0].norm - norm).abs() < 1e-14, "p = {power}: {found:?} for {norm}");
            assert!((found[1].norm - 2.0).abs() < 1e-14 && (found[1].of_truth - 3.0).abs() < 1e-14, "{found:?}");
            assert_eq!([found[0].of_truth, found[0].greatest, found[1].greatest], [0.0, 1.0, 2.0]);
        }
    }
}
