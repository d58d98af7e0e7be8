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
pub(super) const ALIKE: f64 = 4.0;

/// Most bisections of a tetrahedron on the way to such points.
pub(super) const DEEPEST: u32 = 96;

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
                            let corners = nodes.map(|v| Linear::of(sizes[v as usize]));
                            volume6(a, b, c, d) / 6.0 * mean_density(corners, &Linear::between, DEEPEST)
                        })
                        .sum()
                })
            }
        }
    }
}

/// A corner of a tetrahedron that is bisected.
pub(super) trait Corner: Copy {
    /// M^(−1/2).
    fn size(&self) -> Sym3;
    /// √det M.
    fn density(&self) -> f64;
}

/// What is known between two corners.
pub(super) enum Between<C> {
    /// Their middle.
    Middle(C),
    /// The mean of √det M over the whole tetrahedron.
    Mean(f64),
}

/// The mean of √det M over a tetrahedron. It is bisected between the corners that differ most, as `between` tells, until they are alike; then by
/// a quadrature of second degree for linear sizes.
pub(super) fn mean_density<C: Corner>(
    corners: [C; 4],
    between: &impl Fn(&[C; 4], [usize; 2]) -> Between<C>,
    depth: u32,
) -> f64 {
    let ratio = |[i, j]: [usize; 2]| {
        let [a, b] = [corners[i].density(), corners[j].density()];
        a.max(b) / a.min(b)
    };
    let most = EDGES.into_iter().max_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
    let [i, j] = most.unwrap_or([0, 1]);
    let is_steep = ratio([i, j]) > ALIKE;
    if depth == 0 || !is_steep {
        let centre = corners.iter().fold(Sym3::ZERO, |sum, corner| sum.plus(corner.size())).times(0.25);
        return 0.8 * density(&centre) + 0.05 * corners.iter().map(C::density).sum::<f64>();
    }
    match between(&corners, [i, j]) {
        Between::Mean(mean) => mean,
        Between::Middle(middle) => {
            let with = |k: usize| {
                let mut half = corners;
                half[k] = middle;
                mean_density(half, between, depth - 1)
            };
            0.5 * (with(i) + with(j))
        }
    }
}

/// √det M of M^(−1/2).
fn density(size: &Sym3) -> f64 {
    1.0 / size.sqrt_det().powi(2)
}

/// A corner of a tetrahedron in which M^(−1/2) is linear.
#[derive(Clone, Copy)]
struct Linear {
    size: Sym3,
    density: f64,
}

impl Corner for Linear {
    fn size(&self) -> Sym3 {
        self.size
    }

    fn density(&self) -> f64 {
        self.density
    }
}

impl Linear {
    fn of(size: Sym3) -> Self {
        Self { size, density: density(&size) }
    }

    /// The geometric mean of the three sizes.
    fn mean_size(&self) -> f64 {
        self.density.cbrt().recip()
    }

    /// Where (det M)^(−1/6), the mean size, is nearly linear too, as it is for equal sizes in all directions, there is a formula.
    fn between(corners: &[Self; 4], [i, j]: [usize; 2]) -> Between<Self> {
        let middle = Self::of(corners[i].size.plus(corners[j].size).times(0.5));
        let linear = 0.5 * (corners[i].mean_size() + corners[j].mean_size());
        if (middle.mean_size() / linear - 1.0).abs() < STRAIGHT {
            Between::Mean(mean_of_powers(corners.map(|corner| corner.mean_size())))
        } else {
            Between::Middle(middle)
        }
    }
}

/// How far the mean size in the middle of an edge may be from the mean of its ends.
const STRAIGHT: f64 = 0.02;

/// Sizes are taken to differ by this share at least, which the formula needs and which changes its value by no more.
const APART: f64 = 1e-3;

/// The mean of h⁻³ over a tetrahedron in which h is linear, with these values at its corners: 3 ∫ dt / Π(t + h_i) over t > 0 (Carlson's
/// Dirichlet average R₋₃), by partial fractions.
fn mean_of_powers(mut sizes: [f64; 4]) -> f64 {
    sizes.sort_by(f64::total_cmp);
    for i in 1..4 {
        sizes[i] = sizes[i].max(sizes[i - 1] * (1.0 + APART));
    }
    let term = |i: usize| {
        let product: f64 = (0..4).filter(|&j| j != i).map(|j| sizes[j] / sizes[0] - sizes[i] / sizes[0]).product();
        (sizes[i] / sizes[0]).ln() / product
    };
    let mean = -3.0 * (1..4).map(term).sum::<f64>();
    mean.clamp((sizes[3] / sizes[0]).powi(-3), 1.0) / sizes[0].powi(3)
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
    fn a_tetrahedron_has_the_mean_of_what_is_in_it() {
        // Against the sum over many parts: steep, alike in two corners, and in three.
        for sizes in [[1e-4, 1e-2, 0.3, 2.0], [1e-3, 1e-3, 1.0, 1.0], [0.1, 5.0, 5.0, 5.0], [1.0, 1.0, 1.0, 9.0]] {
            let parts = 64;
            let mut sum = 0.0;
            for (i, j, k) in (0..parts).flat_map(|i| (0..parts).flat_map(move |j| (0..parts).map(move |k| (i, j, k)))) {
                // A cube's points to a tetrahedron's, finer about the first corner and the edge to the second.
                let [a, b, c] = [i, j, k].map(|i| (f64::from(i) + 0.5) / f64::from(parts));
                let (u, weight) = (1.0 - a.powi(8), 8.0 * a.powi(7));
                let (v, w) = ((1.0 - u) * b.powi(4), c);
                let at = [u, 1.0 - u - v, v * w, v * (1.0 - w)];
                let size: f64 = at.iter().zip(sizes).map(|(at, size)| at * size).sum();
                // 6 v du dv dw of the volume.
                let weight = 24.0 * (1.0 - u).powi(2) * b.powi(7) * weight;
                sum += weight * size.powi(-3) / f64::from(parts).powi(3);
            }
            let found = mean_of_powers(sizes);
            assert!((found / sum - 1.0).abs() < 0.02, "{sizes:?}: {found} {sum}");
        }
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
