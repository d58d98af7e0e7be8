//! A metric by its eigenvectors, where great anisotropy costs no accuracy.
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

    /// G relative to self, which is M_q; G has the eigenvectors of `p` and these roots.
    #[inline]
    pub fn relative(&self, p: &Self, roots: [f64; 3]) -> Relative {
        let over = self.roots.map(|root| 1.0 / root);
        let row = |i: usize| [0, 1, 2].map(|j| roots[i] * dot(p.vectors[i], self.vectors[j]) * over[j]);
        Relative([row(0), row(1), row(2)])
    }

    /// M_q ∩ G with G relative to self, which is M_q, and the least size that changes; none when no eigenvalue of N is above `bound`.
    pub fn intersection(&self, relative: &Relative, bound: f64) -> Option<(Self, f64)> {
        let eigen = relative.eigen();
        if eigen.values[2] <= bound {
            return None;
        }
        // M = (K R)ᵀ K R in the frame of self, R its roots and K = I + Σ (√value − 1) u uᵀ over the values above 1.
        let (mut raised, mut least) = (Sym3::IDENTITY, f64::INFINITY);
        for (value, u) in eigen.values.into_iter().zip(eigen.vectors).filter(|(value, _)| *value > 1.0) {
            raised = raised.plus(Sym3::outer(u, value.sqrt() - 1.0));
            least = least.min(self.size_along(value, u));
        }
        let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|j| raised.at(i, j) * self.roots[j]));
        let both = gram_eigen(rows);
        let [u, v, w] = self.vectors;
        let in_space = |x: Vec3| -> Vec3 { std::array::from_fn(|i| x[0] * u[i] + x[1] * v[i] + x[2] * w[i]) };
        Some((Self { roots: both.values.map(f64::sqrt), vectors: both.vectors.map(in_space) }, least))
    }

    /// The least size of G in the directions in which it is finer than self.
    pub fn least_excess(&self, relative: &Relative) -> f64 {
        let eigen = relative.eigen();
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

/// A metric G relative to another, M_q: N = M_q^(-1/2) G M_q^(-1/2) = WᵀW in the frame of M_q, by the rows of W = R_p V_pᵀ V_q R_q⁻¹.
#[derive(Clone, Copy)]
pub struct Relative([Vec3; 3]);

/// Up to this trace the eigenvalues of N about 1 are right to 1e-11 when they are taken from N.
const MODERATE: f64 = 1e5;

impl Relative {
    /// N.
    #[inline]
    pub fn form(&self) -> Sym3 {
        let [a, b, c] = self.0;
        Sym3::outer(a, 1.0).plus(Sym3::outer(b, 1.0)).plus(Sym3::outer(c, 1.0))
    }

    /// Eigenvalues and eigenvectors of N. Eigenvalues about 1 are right to 1e-10 even beside others of 1e12.
    pub fn eigen(&self) -> Eigen {
        let form = self.form();
        if form.trace() < MODERATE { form.eigen_spd() } else { gram_eigen(self.0) }
    }

    /// Whether all eigenvalues of N are below the bound.
    #[inline]
    pub fn is_below(&self, bound: f64) -> bool {
        self.form().times(-1.0).plus_identity(bound).pivots().into_iter().all(|pivot| pivot > 0.0)
    }
}

/// Eigenvalues and eigenvectors of WᵀW from the rows of W. WᵀW itself would lose twice as many figures, so pairs of columns of W are
/// rotated until all are orthogonal (one-sided Jacobi: Hestenes 1958; its accuracy: Demmel & Veselić 1992).
fn gram_eigen(rows: [Vec3; 3]) -> Eigen {
    let mut columns = [0, 1, 2].map(|j| [rows[0][j], rows[1][j], rows[2][j]]);
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..50 {
        let mut is_turned = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b, c) = (dot(columns[p], columns[p]), dot(columns[q], columns[q]), dot(columns[p], columns[q]));
            if c.abs() <= 1e-16 * (a * b).sqrt() || !c.is_normal() {
                continue;
            }
            is_turned = true;
            let theta = (b - a) / (2.0 * c);
            let tangent = 1.0f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            for pair in [&mut columns, &mut vectors] {
                let (x, y) = (pair[p], pair[q]);
                pair[p] = std::array::from_fn(|i| cosine * x[i] - sine * y[i]);
                pair[q] = std::array::from_fn(|i| sine * x[i] + cosine * y[i]);
            }
        }
        if !is_turned {
            break;
        }
    }
    let values = columns.map(|column| dot(column, column));
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    Eigen { values: order.map(|i| values[i]), vectors: order.map(|i| vectors[i]) }
}

/// What two metrics are to each other.
pub enum Both {
    /// In no direction the first has a greater size than the second: it is the intersection.
    First,
    /// In no direction the second has a greater size than the first: it is the intersection.
    Second,
    /// Another metric.
    New(Frame),
}

/// M1 ∩ M2: the metric whose unit ball fits into both unit balls (METHOD.md §1.6). In the frame in which M1 is the identity, the
/// eigenvalues of M2 are raised to at least 1. A metric that fits into the other, to a share `rounding` of λ, is returned as it is.
pub fn intersect(a: &Frame, b: &Frame, rounding: f64) -> Both {
    let relative = a.relative(b, b.roots);
    let values = relative.eigen().values;
    if values[2] <= 1.0 + rounding {
        return Both::First;
    }
    if values[0] >= 1.0 - rounding {
        return Both::Second;
    }
    a.intersection(&relative, 1.0).map_or(Both::First, |(both, _)| Both::New(both))
}
