//! Linear interpolation.
use super::Places;
use crate::mesh::locate::Locator;
use crate::tasks::{GRAIN, Team};

/// Values at places, linear in each tetrahedron of the mesh, from those at its vertices: rows of `width` a vertex, rows of `width` a place.
/// No value is beyond those of its tetrahedron, not even by rounding.
///
/// # Panics
/// When the number of values is not `width` a vertex, or the places are of another mesh.
pub fn interpolate(team: Team<'_>, locator: &Locator, places: &Places, width: usize, values: &[f64]) -> Vec<f64> {
    assert_eq!(values.len(), width * locator.vertices().len(), "{width} values a vertex");
    interpolate_in(team, locator.tets(), places, width, values)
}

/// As [`interpolate`], given the nodes of the tetrahedra alone.
pub fn interpolate_in(team: Team<'_>, tets: &[[u32; 4]], places: &Places, width: usize, values: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; width * places.len()];
    if width == 0 {
        return all;
    }
    team.fill(width * GRAIN, &mut all, |start, rows| {
        for (row, at) in rows.chunks_exact_mut(width).zip(start / width..) {
            let nodes = tets[places.tets[at] as usize].map(|v| v as usize * width);
            for (c, value) in row.iter_mut().enumerate() {
                *value = weighted(nodes.map(|node| values[node + c]), places.weights[at]);
            }
        }
    });
    all
}

/// Σ wᵢuᵢ with weights of sum 1, within the bounds of the values.
#[inline]
fn weighted(u: [f64; 4], w: [f64; 4]) -> f64 {
    let sum = (w[0] * u[0] + w[1] * u[1]) + (w[2] * u[2] + w[3] * u[3]);
    sum.max(u.into_iter().fold(f64::INFINITY, f64::min)).min(u.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;
    use crate::mesh::vector::Vec3;

    #[test]
    fn linear_fields_are_met_and_none_is_beyond_its_bounds() {
        let mesh = cube(4);
        let locator = Locator::new(mesh.vertices.clone(), mesh.tets.nodes);
        let at = |p: Vec3| [1e5 + p[0] - 2.0 * p[1], p[2], 0.1];
        let values: Vec<f64> = mesh.vertices.iter().flat_map(|&p| at(p)).collect();
        let points = [[0.1, 0.2, 0.3], [0.77, 0.01, 0.5], [1.0; 3], [0.3, 0.4, 1.5]];
        let places = Places::of(Team::alone(), &locator, &points);
        assert_eq!((places.len(), places.outside), (4, 1));
        assert!((places.farthest - 0.5).abs() < 1e-14);
        let found = interpolate(Team::alone(), &locator, &places, 3, &values);
        for (row, p) in found.chunks(3).zip(points) {
            let expected = at([p[0], p[1], p[2].min(1.0)]);
            assert!((row[0] - expected[0]).abs() < 1e-10 && (row[1] - expected[1]).abs() < 1e-14, "{row:?}");
            assert_eq!(row[2], 0.1);
        }
        assert!(interpolate(Team::alone(), &locator, &places, 0, &[]).is_empty());
    }
}
