//! How a metric grows along an edge, and whether another is within what has grown.
use super::super::Sym3;
use crate::mesh::vector::{Vec3, dot};

/// A metric by its eigenvectors: M = Σ roots_i² v_i v_iᵀ. Relative to these, great anisotropy costs no figures.
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
        let [a, b, c] = self.roots.map(|root| 2.0 * root.ln());
        let [u, v, w] = self.vectors;
        Sym3::outer(u, a).plus(Sym3::outer(v, b)).plus(Sym3::outer(w, c))
    }

    /// The roots of this metric grown along e at a pace of ln r (mixed space, t = 1/8):
    /// λ_i · [(1 + √λ_i |e| ln r)^t (1 + L(e) ln r)^(1−t)]^(−2).
    #[inline]
    pub fn grown(&self, e: Vec3, pace: f64) -> [f64; 3] {
        let along = [0, 1, 2].map(|i| self.roots[i] * dot(self.vectors[i], e));
        let uniform = 1.0 + pace * dot(along, along).sqrt();
        let own = pace * dot(e, e).sqrt();
        let common = eighth_root(uniform) / uniform;
        self.roots.map(|root| root * common / eighth_root(1.0 + root * own))
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

    /// M_q ∩ G with N = `relative` of G to self, which is M_q. None when no eigenvalue of N is above `bound`.
    pub fn intersection(&self, relative: &Sym3, bound: f64) -> Option<Self> {
        let eigen = relative.eigen_spd();
        if eigen.values[2] <= bound {
            return None;
        }
        let mut raised = Sym3::IDENTITY;
        for (value, u) in eigen.values.into_iter().zip(eigen.vectors).filter(|(value, _)| *value > 1.0) {
            raised = raised.plus(Sym3::outer(u, value - 1.0));
        }
        // Graded, not only ill-conditioned: Jacobi's rotations keep the figures of its small eigenvalues.
        let [a, b, c] = self.roots;
        let m = raised.0;
        let both =
            Sym3([m[0] * a * a, m[1] * a * b, m[2] * b * b, m[3] * a * c, m[4] * b * c, m[5] * c * c]).eigen_spd();
        let [u, v, w] = self.vectors;
        let in_space = |x: Vec3| -> Vec3 { std::array::from_fn(|i| x[0] * u[i] + x[1] * v[i] + x[2] * w[i]) };
        Some(Self { roots: both.values.map(f64::sqrt), vectors: both.vectors.map(in_space) })
    }
}

/// Whether all eigenvalues are below the bound.
#[inline]
pub fn is_below(relative: &Sym3, bound: f64) -> bool {
    relative.times(-1.0).plus_identity(bound).pivots().into_iter().all(|pivot| pivot > 0.0)
}

/// x^(1/8).
#[inline(always)]
fn eighth_root(x: f64) -> f64 {
    x.sqrt().sqrt().sqrt()
}
