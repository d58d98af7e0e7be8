//! Edge length, mean ratio and volume in a metric (METHOD.md §1.3, 1.4). The hottest code of the program: no allocation, no
//! eigenvectors.
use super::Sym3;
use crate::mesh::vector::{Vec3, sub, volume6};

/// 36/3^(1/3) · (1/6)^(2/3): the mean ratio's factor when six times the volume is used.
const FACTOR: f64 = 7.559_526_299_369_24;

/// Length of the edge vector v between vertices of metrics ma and mb: the log law of METHOD.md §1.3.
#[inline]
pub fn edge_length(v: Vec3, ma: &Sym3, mb: &Sym3) -> f64 {
    let la = ma.quadratic(v).sqrt();
    let lb = mb.quadratic(v).sqrt();
    mean_length(la, lb)
}

/// The length of an edge from its lengths in the metrics of its two ends: their logarithmic mean (la − lb)/ln(la/lb). Where they differ by less
/// than a fifth, ln(la/lb) = 2 atanh δ with δ = (la − lb)/(la + lb) is summed to 1e-13 of it.
#[inline(always)]
pub fn mean_length(la: f64, lb: f64) -> f64 {
    let (difference, sum) = (la - lb, la + lb);
    let square = difference * difference / (sum * sum);
    if square < 0.01 {
        let even = 1.0 + square * square * (1.0 / 5.0 + square * square * (1.0 / 9.0));
        let odd = square * (1.0 / 3.0 + square * square * (1.0 / 7.0 + square * square * (1.0 / 11.0)));
        0.5 * sum / (even + odd)
    } else if sum > 0.0 {
        difference / (la / lb).ln()
    } else {
        0.5 * sum
    }
}

/// (Σ ln M_i)/4: the logarithm of the log-Euclidean mean of a tetrahedron's metrics.
#[inline(always)]
pub fn mean_log(logs: [&Sym3; 4]) -> Sym3 {
    Sym3(std::array::from_fn(|i| 0.25 * ((logs[0].0[i] + logs[1].0[i]) + (logs[2].0[i] + logs[3].0[i]))))
}

/// The six edge vectors of a tetrahedron.
#[inline(always)]
pub fn edge_vectors(p: &[Vec3; 4]) -> [Vec3; 6] {
    [sub(p[1], p[0]), sub(p[2], p[0]), sub(p[3], p[0]), sub(p[2], p[1]), sub(p[3], p[1]), sub(p[3], p[2])]
}

/// Σ vvᵀ over the six edges.
#[inline(always)]
fn edge_dyads(edges: &[Vec3; 6]) -> Sym3 {
    let mut g = [0.0; 6];
    for v in edges {
        g[0] += v[0] * v[0];
        g[1] += v[0] * v[1];
        g[2] += v[1] * v[1];
        g[3] += v[0] * v[2];
        g[4] += v[1] * v[2];
        g[5] += v[2] * v[2];
    }
    Sym3(g)
}

/// Mean ratio Q of a tetrahedron in the log-Euclidean mean of its vertices' metrics, given as ln M: in (0, 1], 1 best.
/// Inverted or flat: six times its volume, which is ≤ 0.
///
/// With ln M̄ = (t/3) I + S, t its trace, (|k| √det M̄)^(2/3) = |k|^(2/3) e^(t/3) and vᵀM̄v = e^(t/3) vᵀ exp(S) v: the
/// size of the metric cancels, and no determinant is needed.
#[inline]
pub fn mean_ratio(points: [Vec3; 4], logs: [&Sym3; 4]) -> f64 {
    mean_ratio_log(points, &mean_log(logs))
}

/// Cube root of a positive normal number to 1e-15, at a third of the time of the library's correctly rounded one: a
/// guess from the exponent, then Halley's iteration, which triples the digits.
#[inline(always)]
fn cube_root(x: f64) -> f64 {
    let mut y = f64::from_bits(x.to_bits() / 3 + 0x2A9F_7893_0000_0000);
    for _ in 0..3 {
        let cube = y * y * y;
        y *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    y
}

/// [`mean_ratio`] with the logarithm of the mean metric given.
#[inline]
pub fn mean_ratio_log(points: [Vec3; 4], mean: &Sym3) -> f64 {
    let volume = volume6(points[0], points[1], points[2], points[3]);
    if volume <= 0.0 {
        return volume;
    }
    let edges = edge_vectors(&points);
    let root = cube_root(volume);
    FACTOR * root * root / mean.deviatoric_form(&edge_dyads(&edges), || edges)
}

/// Mean ratio in a given metric M̄ with √det M̄; inverted or flat: six times the volume, ≤ 0.
#[inline]
pub fn mean_ratio_in(points: [Vec3; 4], mean: &Sym3, sqrt_det: f64) -> f64 {
    let volume = volume6(points[0], points[1], points[2], points[3]);
    if volume <= 0.0 {
        return volume;
    }
    let root = (volume * sqrt_det).cbrt();
    FACTOR * root * root / edge_dyads(&edge_vectors(&points)).contract(mean)
}

/// Signed volume √det(M̄)·|k| in the log-Euclidean mean of the vertices' metrics (a regular unit tetrahedron has √2/12).
#[inline]
pub fn metric_volume(points: [Vec3; 4], logs: [&Sym3; 4]) -> f64 {
    let trace = 0.25 * logs.iter().map(|l| l.trace()).sum::<f64>();
    volume6(points[0], points[1], points[2], points[3]) / 6.0 * (0.5 * trace).exp()
}

#[cfg(test)]
mod tests {
    use super::super::random::{rotated, spd};
    use super::*;
    use crate::mesh::vector::{dot, scale};
    use proptest::prelude::*;

    /// Edge 1.
    fn regular() -> [Vec3; 4] {
        let h = 3f64.sqrt();
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, h / 2.0, 0.0], [0.5, h / 6.0, (2.0f64 / 3.0).sqrt()]]
    }

    #[test]
    fn cube_roots_of_all_magnitudes() {
        for exponent in -280..280 {
            let x = 1.234567 * 10f64.powi(exponent);
            assert!((cube_root(x) / x.cbrt() - 1.0).abs() < 2e-15, "{x:e}");
        }
    }

    #[test]
    fn a_regular_tetrahedron_is_perfect_at_any_size() {
        for log_size in [0.0, -7.0, 5.0] {
            let log = Sym3::ZERO.plus_identity(log_size);
            let q = mean_ratio(regular(), [&log; 4]);
            assert!((q - 1.0).abs() < 1e-14, "{q}");
        }
    }

    #[test]
    fn inverted_and_flat_are_not_positive() {
        let [a, b, c, d] = regular();
        assert!(mean_ratio([b, a, c, d], [&Sym3::ZERO; 4]) < 0.0);
        assert_eq!(mean_ratio([a, b, c, [0.3, 0.2, 0.0]], [&Sym3::ZERO; 4]), 0.0);
        assert!(mean_ratio_in([b, a, c, d], &Sym3::IDENTITY, 1.0) < 0.0);
    }

    #[test]
    fn the_log_law_of_lengths() {
        let v = [0.0, 0.0, 2.0];
        let (a, b) = (Sym3::diagonal(1.0, 1.0, 1.0), Sym3::diagonal(1.0, 1.0, 4.0));
        // L_a = 2, L_b = 4: (4 − 2)/ln 2.
        assert!((edge_length(v, &a, &b) - 2.0 / 2f64.ln()).abs() < 1e-14);
        assert_eq!(edge_length(v, &a, &b), edge_length(scale(v, -1.0), &b, &a));
        // Where the series takes over from the logarithm, and nearer.
        for ratio in [1.5, 1.23, 1.222, 1.22, 1.1, 1.01, 1.0 + 1e-5] {
            let expected = (ratio - 1.0) / f64::ln_1p(ratio - 1.0);
            assert!((mean_length(ratio, 1.0) / expected - 1.0).abs() < 1e-11, "{ratio}");
            assert!((mean_length(1.0, ratio) / expected - 1.0).abs() < 1e-11, "{ratio}");
        }
        assert_eq!((mean_length(0.7, 0.7), mean_length(0.0, 0.0)), (0.7, 0.0));
    }

    #[test]
    fn volume_of_a_unit_tetrahedron() {
        let log = Sym3::diagonal(2.0, -3.0, 1.0).times(2.0);
        let p = regular().map(|x| [x[0] * (-2f64).exp(), x[1] * 3f64.exp(), x[2] * (-1f64).exp()]);
        assert!((metric_volume(p, [&log; 4]) - 2f64.sqrt() / 12.0).abs() < 1e-14);
    }

    proptest! {
        /// The mean ratio of a tetrahedron that is regular in the metric is 1, at any anisotropy.
        #[test]
        fn perfect_in_its_metric(frame in rotated(), a in -13.8..0.0f64, b in -13.8..0.0f64) {
            // Sizes 1, e^a, e^b along the frame's directions.
            let eigen = crate::metric::Eigen { values: [0.0, -2.0 * a, -2.0 * b], vectors: frame };
            let p = regular().map(|x| {
                let y = [x[0], x[1] * a.exp(), x[2] * b.exp()];
                std::array::from_fn(|i| (0..3).map(|k| frame[k][i] * y[k]).sum())
            });
            let sign = dot(crate::mesh::vector::cross(frame[0], frame[1]), frame[2]);
            let p = if sign > 0.0 { p } else { [p[1], p[0], p[2], p[3]] };
            let log = Sym3::from_eigen(&eigen);
            let q = mean_ratio(p, [&log; 4]);
            // The metric's rounding is seen in the square of the anisotropy, some ulp (2e-16) of it, up to 1e3 (above, the sum
            // goes along the eigenvectors); the volume's, a sum of products of long edges, in units of the volume.
            let anisotropy = (-a.min(b)).exp().max((a - b).abs().exp());
            let rounding = 1e-12 + 1e-15 * anisotropy.min(1e3).powi(2) + 1e-13 * anisotropy + 4e-16 * (-a - b).exp();
            prop_assert!((q - 1.0).abs() < rounding, "{q}");
        }

        /// The two ways of the mean ratio agree.
        #[test]
        fn mean_ratio_by_both_ways(m in [spd(7.0), spd(7.0), spd(7.0), spd(7.0)], x in prop::array::uniform12(-1.0..1.0f64)) {
            let p = [[x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]], [x[9], x[10], x[11]]];
            let logs = m.map(|m| m.ln());
            let q = mean_ratio(p, logs.each_ref());
            let mean = mean_log(logs.each_ref());
            let direct = mean_ratio_in(p, &mean.exp(), (0.5 * mean.trace()).exp());
            prop_assert!(q <= 1.0 + 1e-12);
            prop_assert!((q - direct).abs() <= 1e-8 * q.abs(), "{q} {direct}");
        }
    }
}
