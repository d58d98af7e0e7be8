//! A metric by its eigenvectors: there great anisotropy costs no figures.
//!
//! The six terms of a tensor are rounded by 1e-16 of the greatest: at an anisotropy of 1e6 (eigenvalues 1e12 apart) the least
//! eigenvalue has four figures left, and products of such tensors fewer. Here M = Σ roots_i² v_i v_iᵀ, and what is done with two
//! metrics is done on R_q⁻¹ V_qᵀ V_p R_p, whose terms are rounded by 1e-16 of the anisotropy: 1e-10.
use super::{Eigen, Sym3};
use crate::mesh::vector::{Vec3, dot};

/// A metric M = Σ roots_i² v_i v_iᵀ.
#[derive(Clone, Copy)]
pub struct Frame {
    /// √λ = 1/h, ascending, 1/length.
    pub roots: [f64; 3],
    /// Orthonormal; `vectors[i]` belongs to `roots[i]`.
    pub vectors: [Vec3; 3],
}

impl Frame {
    /// Of ln M.
    pub fn of_log(log: &Sym3) -> Self {
        let eigen = log.eigen();
        Self { roots: eigen.values.map(|x| (0.5 * x).exp()), vectors: eigen.vectors }
    }

    /// ln M.
    pub fn log(&self) -> Sym3 {
        Sym3::from_eigen(&Eigen { values: self.roots.map(|root| 2.0 * root.ln()), vectors: self.vectors })
    }

    /// Of a positive-definite M.
    pub fn of_metric(m: &Sym3) -> Self {
        let eigen = m.eigen_spd();
        Self { roots: eigen.values.map(f64::sqrt), vectors: eigen.vectors }
    }

    /// M.
    pub fn metric(&self) -> Sym3 {
        Sym3::from_eigen(&Eigen { values: self.roots.map(|root| root * root), vectors: self.vectors })
    }

    /// M_q^(-1/2) G M_q^(-1/2) in the frame of self, which is M_q; G has the eigenvectors of `p` and these roots.
    #[inline]
    pub fn relative(&self, p: &Self, roots: [f64; 3]) -> Sym3 {
        let over = self.roots.map(|root| 1.0 / root);
        let mut sum = Sym3::ZERO;
        for (root, v) in roots.into_iter().zip(p.vectors) {
            sum = sum.plus(Sym3::outer([0, 1, 2].map(|j| root * dot(v, self.vectors[j]) * over[j]), 1.0));
        }
        sum
    }

    /// M_q ∩ G with N = `relative` of G to self, which is M_q, and the least size that changes; none when no eigenvalue of N is above
    /// `bound`.
    pub fn intersection(&self, relative: &Sym3, bound: f64) -> Option<(Self, f64)> {
        let eigen = relative.eigen_spd();
        if eigen.values[2] <= bound {
            return None;
        }
        let (mut raised, mut least) = (Sym3::IDENTITY, f64::INFINITY);
        for (value, u) in eigen.values.into_iter().zip(eigen.vectors).filter(|(value, _)| *value > 1.0) {
            raised = raised.plus(Sym3::outer(u, value - 1.0));
            least = least.min(self.size_along(value, u));
        }
        // Graded, not only ill-conditioned: Jacobi's rotations keep the figures of its small eigenvalues.
        let [a, b, c] = self.roots;
        let m = raised.0;
        let both =
            Sym3([m[0] * a * a, m[1] * a * b, m[2] * b * b, m[3] * a * c, m[4] * b * c, m[5] * c * c]).eigen_spd();
        let [u, v, w] = self.vectors;
        let in_space = |x: Vec3| -> Vec3 { std::array::from_fn(|i| x[0] * u[i] + x[1] * v[i] + x[2] * w[i]) };
        Some((Self { roots: both.values.map(f64::sqrt), vectors: both.vectors.map(in_space) }, least))
    }

    /// The least size that G has where it is finer than self; N = `relative` of G to self.
    pub fn least_excess(&self, relative: &Sym3) -> f64 {
        let eigen = relative.eigen_spd();
        let excess = eigen.values.into_iter().zip(eigen.vectors).filter(|(value, _)| *value > 1.0);
        excess.map(|(value, u)| self.size_along(value, u)).fold(f64::INFINITY, f64::min)
    }

    /// The size of G along an eigenvector of N: V R⁻¹ u has length 1 in self and √value in G.
    #[inline]
    fn size_along(&self, value: f64, u: Vec3) -> f64 {
        let x: Vec3 = std::array::from_fn(|i| u[i] / self.roots[i]);
        (dot(x, x) / value).sqrt()
    }
}

/// What two metrics are to each other.
pub enum Both {
    /// The first has nowhere a greater size than the second: it is their intersection.
    First,
    /// The second has nowhere a greater size than the first.
    Second,
    /// Another metric.
    New(Frame),
}

/// M1 ∩ M2: the metric whose unit ball fits into both unit balls (METHOD.md §1): where the unit ball of M1 is made a sphere, the
/// eigenvalues of M2 are raised to at least 1. One that fits into the other is told as it is, to a share `rounding` of λ.
pub fn intersect(a: &Frame, b: &Frame, rounding: f64) -> Both {
    let relative = a.relative(b, b.roots);
    let values = relative.eigen_spd().values;
    if values[2] <= 1.0 + rounding {
        return Both::First;
    }
    if values[0] >= 1.0 - rounding {
        return Both::Second;
    }
    a.intersection(&relative, 1.0).map_or(Both::First, |(both, _)| Both::New(both))
}

/// Whether all eigenvalues are below the bound.
#[inline]
pub fn is_below(relative: &Sym3, bound: f64) -> bool {
    relative.times(-1.0).plus_identity(bound).pivots().into_iter().all(|pivot| pivot > 0.0)
}
