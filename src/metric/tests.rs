//! Properties of the tensor algebra over random metrics, to an anisotropy of 1e6.
use super::frame::Frame;
use super::random::{rotated, spd};
use super::{Eigen, Sym3, field};
use crate::mesh::vector::dot;
use proptest::prelude::*;

/// ln 1e6.
const STRONGEST: f64 = 13.815_510_557_964_274;

/// Greatest absolute term.
fn size(m: &Sym3) -> f64 {
    m.0.iter().fold(0.0, |a: f64, x| a.max(x.abs()))
}

fn difference(a: &Sym3, b: &Sym3) -> f64 {
    size(&a.plus(b.times(-1.0)))
}

fn check_frame(eigen: &Eigen) -> Result<(), TestCaseError> {
    for i in 0..3 {
        for j in 0..3 {
            let expected = f64::from(u8::from(i == j));
            let found = dot(eigen.vectors[i], eigen.vectors[j]);
            prop_assert!((found - expected).abs() < 1e-12, "v{i}·v{j} = {found}");
        }
    }
    prop_assert!(eigen.values[0] <= eigen.values[1] && eigen.values[1] <= eigen.values[2]);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn eigen_gives_the_tensor_back(m in spd(STRONGEST), shift in -3.0..3.0f64) {
        for a in [m, m.ln(), m.ln().plus_identity(shift)] {
            for eigen in [a.eigen(), a.eigen_jacobi()] {
                check_frame(&eigen)?;
                prop_assert!(difference(&Sym3::from_eigen(&eigen), &a) <= 4e-15 * size(&a), "{a:?} {eigen:?}");
            }
        }
    }

    #[test]
    fn eigenvalues_are_the_sizes(frame in rotated(), logs in prop::array::uniform3(0.0..STRONGEST)) {
        let m = Sym3::from_sizes(frame, logs.map(|x| x.exp()));
        let mut expected = logs.map(|x| x.exp());
        expected.sort_by(|a, b| b.total_cmp(a));
        let ratio = (expected[0] / expected[2]).powi(2);
        for (h, e) in m.sizes().iter().zip(expected) {
            // The tensor's terms are rounded by 1e-16 of the greatest.
            prop_assert!((h / e - 1.0).abs() < 1e-13 + 4e-16 * ratio, "{h} {e}");
        }
    }

    #[test]
    fn exp_is_right_on_known_eigenvectors(frame in rotated(), logs in prop::array::uniform3(-STRONGEST..STRONGEST)) {
        let values = logs.map(|x| -2.0 * x);
        let exact = Sym3::from_eigen(&Eigen { values: values.map(f64::exp), vectors: frame });
        let e = Sym3::from_eigen(&Eigen { values, vectors: frame }).exp();
        prop_assert!(difference(&e, &exact) <= 1e-13 * size(&exact), "{e:?} {exact:?}");
    }

    #[test]
    fn exp_and_ln_are_inverse(m in spd(STRONGEST)) {
        let ln = m.ln();
        let back = ln.exp();
        prop_assert!(difference(&back, &m) <= 1e-12 * size(&m), "{m:?} {back:?}");
        // det exp L = e^(tr L).
        prop_assert!((ln.trace() - 2.0 * m.sqrt_det().ln()).abs() <= 1e-3);
    }

    #[test]
    fn exp_of_weakly_anisotropic(frame in rotated(), logs in prop::array::uniform3(-1.0..1.0f64), scale in -12.0..0.5f64) {
        let values = logs.map(|x| x * scale.exp());
        let exact = Sym3::from_eigen(&Eigen { values: values.map(f64::exp), vectors: frame });
        let e = Sym3::from_eigen(&Eigen { values, vectors: frame }).exp();
        prop_assert!(difference(&e, &exact) <= 4e-15 * size(&exact));
    }

    #[test]
    fn quadratic_forms_are_right_to_the_rounding_of_the_largest_eigenvalue(frame in rotated(), logs in prop::array::uniform3(0.0..6.9f64), v in prop::array::uniform3(-1.0..1.0f64)) {
        let values = logs.map(|x| -2.0 * x);
        let e = Sym3::from_eigen(&Eigen { values, vectors: frame }).exp();
        let greatest = values.into_iter().fold(f64::NEG_INFINITY, f64::max).exp();
        for v in [v, frame[0], frame[1], frame[2]] {
            let exact: f64 = (0..3).map(|i| values[i].exp() * dot(frame[i], v).powi(2)).sum();
            // Exponents up to 13.8 are rounded to 2e-15 each, and there are a few.
            prop_assert!((e.quadratic(v) - exact).abs() <= 2e-14 * greatest * dot(v, v), "{} {exact}", e.quadratic(v));
        }
    }

    #[test]
    fn roots_and_inverse(m in spd(0.5 * STRONGEST)) {
        let root = m.sqrt();
        prop_assert!(difference(&root.squared(), &m) <= 1e-13 * size(&m));
        let one = m.congruent(&m.inverse_sqrt());
        let ratio = { let h = m.sizes(); (h[0] / h[2]).powi(2) };
        prop_assert!(difference(&one, &Sym3::IDENTITY) <= 1e-13 + 1e-15 * ratio, "{one:?}");
        prop_assert!(difference(&m.inverse().inverse(), &m) <= (1e-13 + 1e-15 * ratio) * size(&m));
        prop_assert!((m.sqrt_det().powi(2) / m.det() - 1.0).abs() < 1e-10 + 1e-15 * ratio * ratio);
    }

    #[test]
    fn the_intersection_contains_both(a in spd(STRONGEST), b in spd(STRONGEST), vs in prop::array::uniform8(prop::array::uniform3(-1.0..1.0f64))) {
        let both = a.intersect(&b);
        prop_assert!(both.is_spd(), "{both:?}");
        prop_assert_eq!(both, b.intersect(&a));
        let rounding = 1e-14 * (size(&a) + size(&b));
        for v in vs {
            let greater = a.quadratic(v).max(b.quadratic(v));
            prop_assert!(both.quadratic(v) >= greater * (1.0 - 1e-8) - rounding * dot(v, v), "{} {greater}", both.quadratic(v));
        }
        prop_assert_eq!(a.intersect(&a), a);
    }

    #[test]
    fn intersected_logarithms_are_right_to_each_eigenvalue(a in spd(STRONGEST), b in spd(STRONGEST)) {
        let logs = [a.ln(), b.ln()];
        let both = logs[0].intersect_logs(&logs[1]);
        prop_assert!(both.0.iter().all(|x| x.is_finite()));
        prop_assert_eq!(both, logs[1].intersect_logs(&logs[0]));
        // In the Loewner order: no eigenvalue of M⁻¹ A, M the intersection, is above 1, and one of A, B reaches it in each direction.
        let [m, a, b] = [&both, &logs[0], &logs[1]].map(Frame::of_log);
        let [in_a, in_b] = [&a, &b].map(|one| m.relative(one, one.roots).eigen().values[2]);
        prop_assert!(in_a <= 1.0 + 1e-8 && in_b <= 1.0 + 1e-8, "{in_a} {in_b}");
        // det (A ∩ B) is the product of the relative eigenvalues, of those above 1, times det A.
        let raised: f64 = a.relative(&b, b.roots).eigen().values.iter().map(|x| x.max(1.0).ln()).sum();
        prop_assert!((both.trace() - logs[0].trace() - raised).abs() < 1e-7, "{} {}", both.trace() - logs[0].trace(), raised);
        // What is within one already stays to the last bit.
        let finer = logs[0].plus_identity(0.1);
        prop_assert_eq!(logs[0].intersect_logs(&finer), finer);
    }

    #[test]
    fn log_euclidean_means_commute(a in spd(STRONGEST), b in spd(STRONGEST), weight in 0.0..1.0f64) {
        let mean = |a: &Sym3, b: &Sym3, weight: f64| a.ln().times(1.0 - weight).plus(b.ln().times(weight));
        let one = mean(&a, &b, weight);
        prop_assert!(difference(&one, &mean(&b, &a, 1.0 - weight)) <= 1e-13 * (1.0 + size(&one)));
        // The volume is the geometric mean of both, and so is the metric for a common frame.
        let expected = (1.0 - weight) * a.ln().trace() + weight * b.ln().trace();
        prop_assert!((one.trace() - expected).abs() < 1e-12 * (1.0 + expected.abs()));
        let m = one.exp();
        prop_assert!(m.0.iter().all(|x| x.is_finite()) && m.0[0] > 0.0 && m.0[2] > 0.0 && m.0[5] > 0.0);
    }

    #[test]
    fn scaling_reaches_its_complexity(metrics in prop::collection::vec(spd(STRONGEST), 8), target in 1e-3..1e9f64) {
        let mesh = crate::mesh::samples::cube(1);
        let mut logs: Vec<Sym3> = metrics.iter().map(Sym3::ln).collect();
        let team = crate::tasks::Team::alone();
        let factor = field::complexity_factor(field::complexity_of_logs(team, &mesh, &logs), target);
        logs.iter_mut().for_each(|log| *log = log.plus_identity(factor.ln()));
        prop_assert!((field::complexity_of_logs(team, &mesh, &logs) / target - 1.0).abs() < 1e-10);
    }

    #[test]
    fn the_intersection_in_a_common_frame(frame in rotated(), x in prop::array::uniform3(-3.0..3.0f64), y in prop::array::uniform3(-3.0..3.0f64)) {
        let of = |logs: [f64; 3]| Sym3::from_sizes(frame, logs.map(f64::exp));
        let exact = of(std::array::from_fn(|i| x[i].min(y[i])));
        let both = of(x).intersect(&of(y));
        prop_assert!(difference(&both, &exact) <= 1e-10 * size(&exact), "{both:?} {exact:?}");
    }

    #[test]
    fn spd_is_told(m in spd(0.5 * STRONGEST), shift in 1.001..2.0f64) {
        prop_assert!(m.is_spd());
        let least = m.eigen_jacobi().values[0];
        prop_assert!(!m.plus_identity(-shift * least).is_spd());
    }
}

#[test]
fn degenerate_tensors() {
    for m in [Sym3::ZERO, Sym3::IDENTITY, Sym3::IDENTITY.times(1e-300), Sym3::outer([0.6, 0.8, 0.0], 5.0)] {
        check_frame(&m.eigen()).unwrap();
        assert!(difference(&Sym3::from_eigen(&m.eigen()), &m) <= 1e-15 * size(&m));
    }
    // r = 0: the middle eigenvalue is the mean.
    let m = Sym3([1.0, 2.0, 1.0, 0.0, 0.0, 1.0]);
    assert!(m.eigen().values.iter().zip([-1.0, 1.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-15) && !m.is_spd());
    assert_eq!(Sym3::ZERO.exp(), Sym3::IDENTITY);
    assert!(!Sym3([f64::NAN, 0.0, 1.0, 0.0, 0.0, 1.0]).is_spd());
    assert!(!Sym3::ZERO.is_spd());
}
