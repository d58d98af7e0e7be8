//! What a metric is between the vertices of a tetrahedron (METHOD.md §1.2): directions by the mean of ln M; sizes, in their order, the geometric
//! mean of those at the vertices, but no less than the arithmetic mean over 1.06.
use super::Sym3;
use super::field::mean_exponential;
use crate::mesh::adjacency::EDGES;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// ln of the greatest arithmetic mean of sizes over their geometric mean, for all weights, where they differ by a factor of 2 at most: 2/(e ln 2)
/// (Specht 1960). So where a mesh resolves its metric as well as that, sizes are the geometric mean.
const RESOLVED: f64 = 0.059_660_101_141_609_72;

/// The difference of the eigenvalues of ln M where sizes differ by a factor of 2: 2 ln 2.
const STEEP: f64 = 1.386_294_361_119_890_6;

/// Where the eigenvalues of ln M differ by no more than this, all together, √det M differs by no more than a factor of 4: 2 ln 4.
const ALIKE: f64 = 2.0 * STEEP;

/// Of two eigenvalues that differ by no more than this the mean correction is taken.
const APART: f64 = 1e-9;

/// Parts that bring no more than this share of the mean are not bisected.
const LITTLE: f64 = 1e-3;

/// Most bisections of a tetrahedron: what is left is taken as it is. Of sizes that a user may mean hardly any needs as many.
const MOST: usize = 4_000;

/// The eigenvalues of ln M at the vertices of a tetrahedron, ascending: −2 ln of the sizes, the greatest first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ordered([[f64; 3]; 4]);

/// How the eigenvalues of the mean of ln M are corrected: the eigenvalues of the mean where nothing turns, and the correction of each.
struct Corrections {
    at: [f64; 3],
    by: [f64; 3],
}

impl Ordered {
    pub fn new(values: [[f64; 3]; 4]) -> Self {
        Self(values)
    }

    /// Whether sizes of one order differ by more than a factor of 2: else ln M is its mean.
    #[inline]
    pub fn is_steep(&self) -> bool {
        (0..3).any(|k| self.difference(k) > STEEP)
    }

    fn corrections(&self, weights: [f64; 4]) -> Corrections {
        let mean = |k: usize| self.0.iter().zip(weights).map(|(values, weight)| weight * values[k]).sum::<f64>();
        let at = [0, 1, 2].map(mean);
        let by = [0, 1, 2].map(|k| {
            let size = |(values, weight): (&[f64; 3], f64)| weight * (-0.5 * values[k]).exp();
            let arithmetic: f64 = self.0.iter().zip(weights).map(size).sum();
            (no_less(arithmetic) - at[k]).min(0.0)
        });
        Corrections { at, by }
    }

    /// ln M from the mean of ln M with these weights.
    pub fn log(&self, mean: &Sym3, weights: [f64; 4]) -> Sym3 {
        let corrections = self.corrections(weights);
        if corrections.by == [0.0; 3] {
            return *mean;
        }
        let mut eigen = mean.eigen();
        eigen.values = eigen.values.map(|value| value + corrections.of(value));
        Sym3::from_eigen(&eigen)
    }

    /// The mean of √det M, as if no direction turned. It has no jump where sizes begin to be steep.
    fn mean_density(&self) -> f64 {
        let is_steep = [0, 1, 2].map(|k| self.difference(k) > STEEP);
        Bisected { is_steep }.mean_density(self.0.map(Point::vertex))
    }

    /// The greatest difference of sizes of one order, as that of the eigenvalues.
    #[inline]
    fn difference(&self, k: usize) -> f64 {
        let [a, b, c, d] = self.0.map(|values| values[k]);
        a.max(b).max(c.max(d)) - a.min(b).min(c.min(d))
    }
}

/// −2 ln of the least size beside this arithmetic mean.
#[inline]
fn no_less(arithmetic: f64) -> f64 {
    -2.0 * (arithmetic.ln() - RESOLVED)
}

impl Corrections {
    /// That of an eigenvalue of the mean of ln M, which lies among `at` (Ky Fan): piecewise linear, so that equal eigenvalues have the same.
    fn of(&self, value: f64) -> f64 {
        let Self { at, by } = self;
        let i = usize::from(value > at[1]);
        let width = at[i + 1] - at[i];
        let share = if width > APART { ((value - at[i]) / width).clamp(0.0, 1.0) } else { 0.5 };
        by[i] + share * (by[i + 1] - by[i])
    }
}

/// A point of a tetrahedron in which no direction turns.
#[derive(Clone, Copy)]
struct Point {
    /// The means, of the eigenvalues of ln M and of the sizes: linear.
    logs: [f64; 3],
    sizes: [f64; 3],
    /// The eigenvalues of ln M.
    values: [f64; 3],
}

impl Point {
    fn vertex(values: [f64; 3]) -> Self {
        Self { logs: values, sizes: values.map(|value| (-0.5 * value).exp()), values }
    }

    /// ln √det M.
    fn log_density(&self) -> f64 {
        0.5 * (self.values[0] + self.values[1] + self.values[2])
    }

    /// By how much the eigenvalues of ln M differ, all together.
    #[inline]
    fn difference(&self, other: &Self) -> f64 {
        let of = |k: usize| (self.values[k] - other.values[k]).abs();
        of(0) + of(1) + of(2)
    }
}

/// A tetrahedron that is bisected, with the orders of sizes that are steep in it: those of other orders are never corrected.
struct Bisected {
    is_steep: [bool; 3],
}

/// A part of it.
struct Part {
    corners: [Point; 4],
    /// ln of its share of the volume.
    share: f64,
    /// ln of the most that it can bring to the mean of √det M.
    most: f64,
}

impl Part {
    /// That of each order of sizes lies below its greatest at the corners.
    fn new(corners: [Point; 4], share: f64) -> Self {
        let of = |k: usize| corners.iter().map(|corner| corner.values[k]).fold(f64::NEG_INFINITY, f64::max);
        Self { most: share + 0.5 * (of(0) + of(1) + of(2)), corners, share }
    }

    /// The edge whose ends differ most, and by how much.
    fn steepest(&self) -> ([usize; 2], f64) {
        let mut steepest = ([0, 1], 0.0);
        for [i, j] in EDGES {
            let difference = self.corners[i].difference(&self.corners[j]);
            if difference > steepest.1 {
                steepest = ([i, j], difference);
            }
        }
        steepest
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most.total_cmp(&other.most)
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl Bisected {
    fn middle<const N: usize>(&self, of: [&Point; N]) -> Point {
        let share = 1.0 / N as f64;
        let mut middle = Point { logs: [0.0; 3], sizes: [0.0; 3], values: [0.0; 3] };
        for k in 0..3 {
            middle.logs[k] = share * of.iter().map(|point| point.logs[k]).sum::<f64>();
            middle.values[k] = middle.logs[k];
            if self.is_steep[k] {
                middle.sizes[k] = share * of.iter().map(|point| point.sizes[k]).sum::<f64>();
                middle.values[k] = middle.logs[k].min(no_less(middle.sizes[k]));
            }
        }
        middle
    }

    /// The mean of √det M. What may bring most comes first: it is bisected between the corners that differ most, until no two differ by more than
    /// [`ALIKE`].
    fn mean_density(&self, corners: [Point; 4]) -> f64 {
        let (mut parts, mut mean, mut left) = (BinaryHeap::from([Part::new(corners, 0.0)]), 0.0, MOST);
        while let Some(part) = parts.pop() {
            let (ends, difference) = part.steepest();
            if difference <= ALIKE || left == 0 || part.most < (LITTLE * mean).ln() {
                mean += self.of_alike(&part);
                continue;
            }
            left -= 1;
            let middle = self.middle(ends.map(|i| &part.corners[i]));
            for end in ends {
                let mut corners = part.corners;
                corners[end] = middle;
                parts.push(Part::new(corners, part.share - std::f64::consts::LN_2));
            }
        }
        mean
    }

    /// What a part brings whose corners are alike: ln √det M is linear but for a bubble, of which the centre shows the height; that of second degree has
    /// 4/5 of it in the mean.
    fn of_alike(&self, part: &Part) -> f64 {
        let logs = part.corners.each_ref().map(Point::log_density);
        let centre = self.middle(part.corners.each_ref()).log_density();
        let bubble = centre - 0.25 * (logs[0] + logs[1] + logs[2] + logs[3]);
        mean_exponential(logs.map(|log| log + 0.8 * bubble + part.share))
    }
}

/// The eigenvalues of ln M at the vertices, where sizes are steep.
fn steep(logs: [&Sym3; 4]) -> Option<Ordered> {
    // No eigenvalue differs by more than the tensors do (Weyl), so that mostly none is asked for.
    let differs = |[i, j]: [usize; 2]| {
        let difference = logs[i].plus(logs[j].times(-1.0));
        difference.contract(&difference) > STEEP * STEEP
    };
    let ordered = || Ordered(logs.map(|log| log.eigen().values));
    EDGES.into_iter().any(differs).then(ordered).filter(Ordered::is_steep)
}

/// ln M at the point of a tetrahedron with these weights, from that at its vertices.
pub fn log_between(logs: [&Sym3; 4], weights: [f64; 4]) -> Sym3 {
    let mean = logs.into_iter().zip(weights).fold(Sym3::ZERO, |sum, (log, weight)| sum.plus(log.times(weight)));
    match steep(logs) {
        Some(ordered) => ordered.log(&mean, weights),
        None => mean,
    }
}

/// The mean of √det M over a tetrahedron, from ln M at its vertices; where sizes are steep and directions turn, as if they did not.
pub(super) fn density_between(logs: [&Sym3; 4]) -> f64 {
    match steep(logs) {
        Some(ordered) => ordered.mean_density(),
        None => mean_exponential(logs.map(|log| 0.5 * log.trace())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// −2 ln h.
    fn of(sizes: [f64; 3]) -> [f64; 3] {
        sizes.map(|h| -2.0 * h.ln())
    }

    fn diagonal(values: [f64; 3]) -> Sym3 {
        Sym3::diagonal(values[0], values[1], values[2])
    }

    /// ln M in a tetrahedron.
    fn log(corners: &[Sym3; 4], weights: [f64; 4]) -> Sym3 {
        log_between(corners.each_ref(), weights)
    }

    #[test]
    fn the_constants_are_specht_s() {
        let (ratio, e) = (2.0f64, std::f64::consts::E);
        assert!((RESOLVED - (ratio / (e * ratio.ln())).ln()).abs() < 1e-15);
        assert!((STEEP - 2.0 * ratio.ln()).abs() < 1e-15);
    }

    #[test]
    fn sizes_grow_with_the_distance_where_they_are_steep() {
        // Thin across z, from 1e-6 to 0.1.
        let corners = [1e-6, 1e-6, 1e-6, 0.1].map(|h| diagonal(of([0.2, 0.1, h])));
        for weight in [1e-4, 0.1, 0.5, 0.9] {
            let found = log(&corners, [1.0 - weight, 0.0, 0.0, weight]).exp().sizes();
            let linear = (1e-6 + weight * 0.1) / RESOLVED.exp();
            let found = found.into_iter().fold(f64::INFINITY, f64::min);
            assert!((found / linear - 1.0).abs() < 1e-4, "{weight}: {found} {linear}");
        }
        // At a vertex, what is there.
        assert!((log(&corners, [1.0, 0.0, 0.0, 0.0]).0[5] / corners[0].0[5] - 1.0).abs() < 1e-14);
    }

    /// However far sizes are apart.
    #[test]
    fn the_mean_of_any_sizes_is_found_and_finite() {
        let any = |k: usize| 1e200f64.powf((k as f64 * 0.618_033_988_749_895).fract()) * 1e-100;
        for first in 0..40 {
            let of = |i: usize| {
                let mut values = of([0, 1, 2].map(|k| any(12 * first + 3 * i + k)));
                values.sort_by(f64::total_cmp);
                values
            };
            let corners = [0, 1, 2, 3].map(of);
            let mean = Ordered::new(corners).mean_density();
            let ends = corners.map(|values| 0.5 * values.iter().sum::<f64>());
            let most = ends.into_iter().fold(f64::NEG_INFINITY, f64::max);
            assert!(mean > 0.0 && mean.ln() < most, "{corners:?}: {mean}");
        }
    }

    #[test]
    fn a_mean_is_that_of_many_points() {
        let layer = |h: f64| of([0.3, 0.2, h]);
        for (corners, slack) in [
            ([layer(1e-4), layer(0.05), layer(0.1), layer(0.15)], 0.02),
            ([layer(1e-4), layer(0.15), layer(0.15), layer(0.15)], 0.02),
            ([layer(0.02), layer(0.03), layer(0.05), layer(0.06)], 0.01),
            ([of([0.2, 0.02, 0.02]), of([1.0, 0.1, 0.1]), of([1.0, 1.0, 0.1]), of([3.0, 1.0, 1.0])], 0.02),
        ] {
            let ordered = Ordered::new(corners);
            let (mut sum, mut weights, parts) = (0.0, 0.0, 60);
            for (i, j, k) in (0..parts).flat_map(|i| (0..parts).flat_map(move |j| (0..parts).map(move |k| (i, j, k)))) {
                // A cube's points to a tetrahedron's, finer about the first corner.
                let [a, b, c] = [i, j, k].map(|i| (f64::from(i) + 0.5) / f64::from(parts));
                let (far, weight) = (a.powi(4), 3.0 * a.powi(8) * 4.0 * a.powi(3));
                let (u, weight) = (b.sqrt(), weight);
                let at = [1.0 - far, far * (1.0 - u), far * u * c, far * u * (1.0 - c)];
                let Corrections { at, by } = ordered.corrections(at);
                sum += weight * (0.5 * (0..3).map(|k| at[k] + by[k]).sum::<f64>()).exp();
                weights += weight;
            }
            let (found, mean) = (ordered.mean_density(), sum / weights);
            assert!((found / mean - 1.0).abs() < slack, "{corners:?}: {found} {mean}");
        }
    }

    proptest! {
        /// Where sizes begin to be steep, nothing jumps: neither ln M nor its complexity.
        #[test]
        fn nothing_jumps(sizes in prop::array::uniform4(0.0..1.0f64), weights in prop::array::uniform4(0.01..1.0f64)) {
            let sum: f64 = weights.iter().sum();
            let weights = weights.map(|weight| weight / sum);
            let least = sizes.iter().copied().fold(1.0, f64::min);
            let most = sizes.iter().copied().fold(0.0, f64::max);
            let of = |by: f64| sizes.map(|x| diagonal([0.1, 1.0, 2.0 + by * (x - least) / (most - least) * STEEP]));
            let (before, after) = (of(1.0 - 1e-9), of(1.0 + 1e-9));
            let [a, b] = [&before, &after].map(|corners| log(corners, weights));
            prop_assert!((0..6).all(|i| (a.0[i] - b.0[i]).abs() < 1e-7), "{a:?} {b:?}");
            let [a, b] = [&before, &after].map(|corners| density_between(corners.each_ref()));
            prop_assert!((a / b - 1.0).abs() < 1e-7, "{a} {b}");
        }

        /// Sizes lie between the least and the greatest of their vertices, whatever turns.
        #[test]
        fn sizes_are_held(corners in prop::array::uniform4((prop::array::uniform3(-9.0..9.0f64), prop::array::uniform3(-1.0..1.0f64))),
            weights in prop::array::uniform4(0.0..1.0f64)) {
            let sum: f64 = weights.iter().sum::<f64>().max(1e-9);
            let corners = corners.map(|(d, o)| Sym3([d[0], o[0], d[1], o[1], o[2], d[2]]));
            let values = log(&corners, weights.map(|weight| weight / sum)).eigen().values;
            let all = corners.map(|log| log.eigen().values);
            let least = all.iter().map(|values| values[0]).fold(f64::INFINITY, f64::min);
            let most = all.iter().map(|values| values[2]).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(values.iter().all(|value| (least - 1e-6..=most + 1e-6).contains(value)), "{values:?} {least} {most}");
        }
    }
}
