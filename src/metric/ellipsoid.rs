//! The smallest ellipsoid about a centre that holds given points.
use super::Sym3;
use crate::mesh::vector::Vec3;
use nalgebra::{Matrix3, Vector3};

/// The volume is at most (1 + this)^(3/2) times the least.
const TOLERANCE: f64 = 1e-4;

/// Steps at most; some tens are enough.
const STEPS: usize = 10_000;

/// The metric whose unit ball is the smallest ellipsoid with its centre at the origin that holds the points, which must span space.
///
/// Khachiyan's algorithm (1996) with the away steps of Todd & Yildirim (2007), on X = Σ u_i x_i x_iᵀ with weights u of sum 1. At the
/// optimum x_iᵀ X⁻¹ x_i = 3 for all points with a weight, and M = X⁻¹/3. The result is scaled so that all points are within.
/// `weights` is scratch.
pub fn smallest_about_origin(points: &[Vec3], weights: &mut Vec<f64>) -> Option<Sym3> {
    const D: f64 = 3.0;
    weights.clear();
    weights.resize(points.len(), 1.0 / points.len() as f64);
    let dyad = |x: Vec3| Vector3::from(x) * Vector3::from(x).transpose();
    let mut sum: Matrix3<f64> = points.iter().map(|&x| dyad(x)).sum::<Matrix3<f64>>() / points.len() as f64;
    let mut greatest = 0.0;
    for _ in 0..STEPS {
        let lower = sum.cholesky()?.unpack();
        let form = |x: Vec3| lower.solve_lower_triangular_unchecked(&Vector3::from(x)).norm_squared();
        let (mut farthest, mut nearest) = ((0, f64::NEG_INFINITY), (0, f64::INFINITY));
        for (i, &x) in points.iter().enumerate() {
            let value = form(x);
            if value > farthest.1 {
                farthest = (i, value);
            }
            if value < nearest.1 && weights[i] > 0.0 {
                nearest = (i, value);
            }
        }
        greatest = farthest.1;
        if !greatest.is_finite() || greatest <= D * (1.0 + TOLERANCE) {
            break;
        }
        // Weight to the farthest, or away from the nearest, whichever is farther from 3.
        let (at, step) = if farthest.1 - D >= D - nearest.1 {
            (farthest.0, (farthest.1 - D) / (D * (farthest.1 - 1.0)))
        } else {
            let all = -weights[nearest.0] / (1.0 - weights[nearest.0]);
            let best = if nearest.1 > 1.0 { (nearest.1 - D) / (D * (nearest.1 - 1.0)) } else { f64::NEG_INFINITY };
            (nearest.0, best.max(all))
        };
        weights.iter_mut().for_each(|weight| *weight *= 1.0 - step);
        weights[at] = (weights[at] + step).max(0.0);
        if weights[at] < 1e-15 {
            weights[at] = 0.0;
        }
        sum = sum * (1.0 - step) + dyad(points[at]) * step;
    }
    let m = Sym3::from(sum).inverse().times(1.0 / greatest);
    m.is_spd().then_some(m)
}

#[cfg(test)]
mod tests {
    use super::super::random::rotated;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_half_axes_of_an_ellipsoid_are_found(frame in rotated(), logs in prop::array::uniform3(0.0..4.0f64), inner in prop::collection::vec(prop::array::uniform3(-0.57..0.57f64), 20)) {
            let h = logs.map(f64::exp);
            let place = |x: Vec3| -> Vec3 { std::array::from_fn(|i| (0..3).map(|k| h[k] * x[k] * frame[k][i]).sum()) };
            let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
            let points: Vec<Vec3> = inner.into_iter().chain(axes).map(place).collect();
            let m = smallest_about_origin(&points, &mut Vec::new()).unwrap();
            let exact = Sym3::from_sizes(frame, h);
            for v in frame {
                prop_assert!((m.quadratic(v) / exact.quadratic(v) - 1.0).abs() < 1e-2, "{m:?} {exact:?}");
            }
            prop_assert!(points.iter().all(|&x| m.quadratic(x) < 1.0 + 1e-9));
            prop_assert!((m.sqrt_det() / exact.sqrt_det() - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn points_in_a_plane_have_none() {
        let flat = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(smallest_about_origin(&flat, &mut Vec::new()), None);
    }
}
