//! The metric that makes the L^p norm of the interpolation error least for its complexity (Loseille & Alauzet 2011, Continuous mesh
//! framework I and II), where no size may exceed that of the domain.
use super::norm::Norm;
use crate::metric::{Eigen, Sym3};

/// |H| at a vertex: logarithms of its eigenvalues, ascending, and their directions.
#[derive(Clone, Copy)]
pub struct Spectrum(Eigen);

impl Spectrum {
    /// Of a Hessian. Eigenvalues below 1e-12 of the greatest (ratios of sizes beyond a million) and below `floor` are raised to that.
    pub fn of(hessian: &Sym3, floor: f64) -> Self {
        let Eigen { values, vectors } = hessian.eigen();
        let mut order = [0, 1, 2].map(|i| (values[i].abs(), vectors[i]));
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = floor.max(1e-12 * order[2].0);
        Self(Eigen { values: order.map(|x| x.0.max(least).ln()), vectors: order.map(|x| x.1) })
    }

    /// ln M of M = c det(|H|)^(-1/(2p+3)) |H|, ln c given.
    ///
    /// That is |H|/e with an error e that is the same in all directions. A size that would exceed `hmax` is `hmax` whatever the eigenvalue,
    /// and the others solve the problem in fewer dimensions: e^(2p+3) = c^-(2p+3) Π e/h² over the bounded directions, times Π λ over the
    /// others (METHOD.md §1.9). Otherwise an eigenvalue near zero would make the other sizes small without a bound.
    pub fn log_metric(&self, norm: Norm, log_scale: f64, hmax: f64) -> Sym3 {
        Sym3::from_eigen(&Eigen { values: self.exponents(norm, log_scale, hmax), vectors: self.0.vectors })
    }

    fn exponents(&self, norm: Norm, log_scale: f64, hmax: f64) -> [f64; 3] {
        let least = -2.0 * hmax.ln();
        let (values, divisor) = (self.0.values, norm.divisor());
        for bounded in 0..3 {
            let count = bounded as f64;
            // In terms of the divisor's inverse, which is 0 for p = ∞.
            let free: f64 = values[bounded..].iter().sum();
            let ln_e = ((free + count * least) / divisor - log_scale) / (1.0 - count / divisor);
            if values[bounded] - ln_e >= least {
                return std::array::from_fn(|i| if i < bounded { least } else { values[i] - ln_e });
            }
        }
        [least; 3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn metric(h: Sym3, p: f64, log_scale: f64, hmax: f64) -> Sym3 {
        Spectrum::of(&h, 0.0).log_metric(Norm::of(p).unwrap(), log_scale, hmax).exp()
    }

    #[test]
    fn without_a_bound_it_is_the_formula() {
        // Of signs only the absolute values count.
        let frame = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]];
        let of = |values| Sym3::from_eigen(&Eigen { values, vectors: frame });
        for p in [1.0, 2.0, 4.0, f64::INFINITY] {
            let found = metric(of([-2.0, 5.0, -0.1]), p, 0.5, 1e9);
            let factor = 0.5f64.exp() * 1f64.powf(-1.0 / (2.0 * p + 3.0));
            let expected = of([2.0, 5.0, 0.1].map(|x| x * factor));
            for i in 0..6 {
                assert!((found.0[i] - expected.0[i]).abs() < 1e-13, "{p} {found:?} {expected:?}");
            }
        }
        // det |H| = 8: the exponent tells the norms apart, 8^(-1/5), 8^(-1/7), 8^(-1/11), 1.
        for (p, factor) in
            [(1.0, 8f64.powf(-0.2)), (2.0, 8f64.powf(-1.0 / 7.0)), (4.0, 8f64.powf(-1.0 / 11.0)), (f64::INFINITY, 1.0)]
        {
            let found = metric(Sym3::IDENTITY.times(2.0), p, 0.0, 1e9);
            assert!((found.0[0] / (2.0 * factor) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn with_bounded_sizes_it_is_that_of_fewer_dimensions() {
        // L² in a plane: (λ1 λ2)^(-1/6), on a line λ^(-1/5): ratios between two vertices, whatever the scale.
        let of = |a, b, c| metric(Sym3::from_eigen(&Eigen { values: [a, b, c], vectors: AXES }), 2.0, 3.0, 1.0);
        let (one, other) = (of(0.0, 10.0, 20.0), of(0.0, 30.0, 40.0));
        assert!((one.0[0] - 1.0).abs() < 1e-12 && (other.0[0] - 1.0).abs() < 1e-12);
        let expected = 40.0 / 20.0 * (1200.0f64 / 200.0).powf(-1.0 / 6.0);
        assert!((other.0[5] / one.0[5] / expected - 1.0).abs() < 1e-12);
        let (one, other) = (of(0.0, 0.0, 20.0), of(0.0, 1e-9, 50.0));
        assert!((one.0[2] - 1.0).abs() < 1e-12 && (other.0[2] - 1.0).abs() < 1e-12);
        assert!((other.0[5] / one.0[5] / 2.5f64.powf(0.8) - 1.0).abs() < 1e-12);
        // It goes over from one to the other without a jump, and no size is above the bound.
        let (mut last, bound) = (of(1e-9, 0.5, 20.0), 1.0 - 1e-12);
        for step in 1..400 {
            let found = of(1e-9 * 1.06f64.powi(step), 0.5, 20.0);
            assert!((0..3).all(|i| found.at(i, i) >= bound && (found.at(i, i) / last.at(i, i)).ln().abs() < 0.1));
            last = found;
        }
        assert!(last.0[0] > 2.0);
        assert_eq!(metric(Sym3::ZERO.plus_identity(1e-30), 2.0, -9.0, 2.0).0[0], 0.25);
    }
}
