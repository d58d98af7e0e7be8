//! What a metric is between the vertices of a mesh.
use super::Sym3;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::EDGES;
use crate::mesh::vector::volume6;
use crate::tasks::{GRAIN, Team};

/// What is linear between vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// ln M (log-Euclidean: Arsigny et al. 2006): sizes are a geometric series along an edge. The rule for metrics of files and fields.
    #[default]
    Logarithms,
    /// M^(−1/2): sizes grow in proportion to the distance, as gradation lets them. So a graded metric is right between the vertices of a
    /// mesh that is much coarser than its sizes.
    Sizes,
}

/// Between points whose √det M differ by less than this factor, a quadrature of second degree will do: where sizes are linear along an edge it
/// is 0.5 % off at most.
const ALIKE: f64 = 4.0;

/// Most bisections of a tetrahedron on the way to such points.
const DEEPEST: u32 = 96;

impl Interpolation {
    /// What is interpolated of ln M.
    #[inline]
    pub fn of_log(self, log: &Sym3) -> Sym3 {
        match self {
            Self::Logarithms => *log,
            Self::Sizes => log.times(-0.5).exp(),
        }
    }

    /// ln M of what was interpolated.
    #[inline]
    pub fn log(self, value: &Sym3) -> Sym3 {
        match self {
            Self::Logarithms => *value,
            Self::Sizes => value.map_spd(|size| -2.0 * size.ln()),
        }
    }

    /// Complexity ∫ √det M of ln M at the vertices, shape (n,), with what is between them: what an adapted mesh will have.
    pub fn complexity(self, team: Team<'_>, mesh: &TetMesh, logs: &[Sym3]) -> f64 {
        match self {
            Self::Logarithms => super::field::complexity_between(team, mesh, logs),
            Self::Sizes => {
                let sizes = team.map(GRAIN, logs.len(), |v| self.of_log(&logs[v]));
                team.sum(GRAIN >> 4, mesh.tets.len(), |range| {
                    mesh.tets.nodes[range]
                        .iter()
                        .map(|nodes| {
                            let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
                            volume6(a, b, c, d) / 6.0 * mean_of_sizes(nodes.map(|v| sizes[v as usize]))
                        })
                        .sum()
                })
            }
        }
    }
}

/// The mean of √det M over a tetrahedron in which M^(−1/2) is linear, with these values at its corners.
pub(super) fn mean_of_sizes(sizes: [Sym3; 4]) -> f64 {
    mean_density(sizes.map(Corner::of), DEEPEST)
}

/// M^(−1/2) at a corner of a tetrahedron, and √det M.
#[derive(Clone, Copy)]
struct Corner {
    size: Sym3,
    density: f64,
}

impl Corner {
    fn of(size: Sym3) -> Self {
        Self { size, density: 1.0 / size.sqrt_det().powi(2) }
    }
}

/// The mean of √det M over a tetrahedron in which M^(−1/2) is linear. It is bisected between the corners that differ most, until they are
/// alike.
fn mean_density(corners: [Corner; 4], depth: u32) -> f64 {
    let ratio = |[i, j]: [usize; 2]| {
        let [a, b] = [corners[i].density, corners[j].density];
        a.max(b) / a.min(b)
    };
    let most = EDGES.into_iter().max_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
    let [i, j] = most.unwrap_or([0, 1]);
    let is_steep = ratio([i, j]) > ALIKE;
    if depth == 0 || !is_steep {
        let sum = corners.iter().fold(Sym3::ZERO, |sum, corner| sum.plus(corner.size));
        let centre = Corner::of(sum.times(0.25));
        return 0.8 * centre.density + 0.05 * corners.iter().map(|corner| corner.density).sum::<f64>();
    }
    let middle = Corner::of(corners[i].size.plus(corners[j].size).times(0.5));
    let with = |k: usize| {
        let mut half = corners;
        half[k] = middle;
        mean_density(half, depth - 1)
    };
    0.5 * (with(i) + with(j))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn sizes_that_grow_with_the_distance_are_met_on_a_coarse_mesh() {
        // h = 1e-3 + x in a unit cube: ∫ h⁻³ = (1e6 − 1.001⁻²)/2.
        let mesh = cube(1);
        let log = |h: f64| Sym3::ZERO.plus_identity(-2.0 * h.ln());
        let logs: Vec<Sym3> = mesh.vertices.iter().map(|p| log(1e-3 + p[0])).collect();
        let exact = 0.5 * (1e6 - 1.001f64.powi(-2));
        let found = Interpolation::Sizes.complexity(Team::alone(), &mesh, &logs);
        assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
        assert!(Interpolation::Logarithms.complexity(Team::alone(), &mesh, &logs) > 50.0 * exact);
        // A layer, turned.
        let directions = [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]];
        let layer = |h: f64| Sym3::from_sizes(directions, [0.5, 0.25, h]).ln();
        let logs: Vec<Sym3> = mesh.vertices.iter().map(|p| layer(1e-4 + p[2])).collect();
        let exact = 8.0 * (1.0001f64 / 1e-4).ln();
        let found = Interpolation::Sizes.complexity(Team::alone(), &mesh, &logs);
        assert!((found / exact - 1.0).abs() < 0.02, "{found} {exact}");
    }

    #[test]
    fn what_is_interpolated_is_undone() {
        let log = Sym3([1.0, 0.3, -4.0, 0.2, -0.1, 7.0]);
        for way in [Interpolation::Logarithms, Interpolation::Sizes] {
            let back = way.log(&way.of_log(&log));
            assert!((0..6).all(|i| (back.0[i] - log.0[i]).abs() < 1e-12), "{way:?} {back:?}");
        }
    }
}
