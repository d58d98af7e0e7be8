//! The exponential of a log metric: the inner loop of everything.
//!
//! A symmetric tensor is L = (tr L/3) I + S. With S³ = 3p S + 2r I (Cayley–Hamilton), exp S = a0 I + a1 S + a2 S²,
//! where the polynomial interpolates e^x at the three eigenvalues of S (Newton's divided differences). Only the
//! eigenvalues are needed, no vectors. A close pair does no harm: if its two nodes are off by √ε, the interpolation is off
//! by the order of ε.
use super::Sym3;
use super::eigen::{Eigen, invariants, roots};

/// Below this √p the power series is as exact and has no small divisors.
pub(super) const SERIES: f64 = 0.05;

/// Beyond this difference of the eigenvalues of ln M (anisotropy 1e3) quadratic forms are summed along the
/// eigenvectors: the figures that a matrix of six terms would lose are kept.
pub(super) const STRONG: f64 = 13.8;

/// exp S of a traceless S, as coefficients of 1, S and S².
struct Coefficients {
    a: [f64; 3],
    /// Difference of the extreme eigenvalues of S.
    spread: f64,
}

#[inline(always)]
fn coefficients(s: &Sym3) -> Coefficients {
    let (p, r) = invariants(s);
    if p < SERIES * SERIES {
        return series(p, r);
    }
    // Newton's form at the isolated root x and the others y ≤ z: no difference but z − y can be small.
    let [x, y, z] = roots(p, r);
    let close = z - y;
    let (to_y, to_z, apart) = (1.0 / (y - x), 1.0 / (z - x), 1.0 / close);
    let (ex, ey, ez) = (x.exp(), y.exp(), z.exp());
    let fxy = (ey - ex) * to_y;
    let fyz = if close > 1e-5 { (ez - ey) * apart } else { ey * (1.0 + close * (0.5 + close / 6.0)) };
    let fxyz = (fyz - fxy) * to_z;
    // e^x + fxy (S − x) + fxyz (S − x)(S − y), and x + y = −z as S is traceless.
    Coefficients {
        a: [ex - fxy * x + fxyz * x * y, fxy + fxyz * z, fxyz],
        spread: close.max(1.5 * x.abs() + 0.5 * close),
    }
}

/// Σ Sⁿ/n! up to n = 9, in Horner's scheme in the ring of polynomials modulo x³ − 3p x − 2r.
#[cold]
fn series(p: f64, r: f64) -> Coefficients {
    let mut a = [1.0, 0.0, 0.0];
    for n in (1..=9).rev() {
        let over = 1.0 / f64::from(n);
        // a ← 1 + x·a/n
        a = [1.0 + 2.0 * r * a[2] * over, (a[0] + 3.0 * p * a[2]) * over, a[1] * over];
    }
    Coefficients { a, spread: 4.0 * p.sqrt() }
}

impl Sym3 {
    /// exp L, to the rounding of its largest eigenvalue.
    #[inline]
    pub fn exp(&self) -> Self {
        let mean = self.trace() / 3.0;
        let s = self.plus_identity(-mean);
        let c = coefficients(&s);
        if c.spread > STRONG {
            let Eigen { values, vectors } = self.eigen();
            return Self::from_eigen(&Eigen { values: values.map(f64::exp), vectors });
        }
        let factor = mean.exp();
        let [a0, a1, a2] = c.a.map(|x| x * factor);
        s.squared().times(a2).plus(s.times(a1)).plus_identity(a0)
    }

    /// tr(G exp S), S the traceless part of self and G = Σ vvᵀ: the sum of vᵀ exp(S) v over the vectors v. The volume part of
    /// the metric, exp(tr L/3), is left out: in the mean ratio it cancels. `vectors` are the v, for strong anisotropy.
    #[inline]
    pub(super) fn deviatoric_form(&self, g: &Self, vectors: impl Fn() -> [crate::mesh::vector::Vec3; 6]) -> f64 {
        let s = self.plus_identity(-self.trace() / 3.0);
        let c = coefficients(&s);
        if c.spread > STRONG {
            return strong_form(&s, vectors());
        }
        c.a[0] * g.trace() + c.a[1] * g.contract(&s) + c.a[2] * g.contract(&s.squared())
    }
}

/// Σ vᵀ exp(S) v, along the eigenvectors of S.
#[cold]
fn strong_form(s: &Sym3, vectors: [crate::mesh::vector::Vec3; 6]) -> f64 {
    let eigen = s.eigen();
    let mut sum = 0.0;
    for i in 0..3 {
        let squares: f64 = vectors.iter().map(|&v| crate::mesh::vector::dot(eigen.vectors[i], v).powi(2)).sum();
        sum += eigen.values[i].exp() * squares;
    }
    sum
}
