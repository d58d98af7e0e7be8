//! Symmetric 3×3 tensors and their spectral maps (METHOD.md §1).
use crate::mesh::vector::Vec3;

/// A symmetric 3×3 tensor; the six terms are in the order of .sol files: 11 12 22 13 23 33.
/// The order is part of the type: conversions from other customs are named functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sym3(pub [f64; 6]);

/// Eigenvalues (ascending) and unit eigenvectors (rows, right-handed or not) of a [`Sym3`].
#[derive(Clone, Copy, Debug)]
pub struct Eigen {
    /// Eigenvalues, ascending.
    pub values: [f64; 3],
    /// `vectors[i]` belongs to `values[i]`.
    pub vectors: [Vec3; 3],
}

impl Sym3 {
    /// The identity.
    pub const IDENTITY: Self = Self([1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    /// Zero.
    pub const ZERO: Self = Self([0.0; 6]);

    /// diag(a, b, c).
    #[inline(always)]
    pub const fn diagonal(a: f64, b: f64, c: f64) -> Self {
        Self([a, 0.0, b, 0.0, 0.0, c])
    }

    /// s·vvᵀ.
    #[inline(always)]
    pub fn outer(v: Vec3, s: f64) -> Self {
        Self([s * v[0] * v[0], s * v[0] * v[1], s * v[1] * v[1], s * v[0] * v[2], s * v[1] * v[2], s * v[2] * v[2]])
    }

    /// Term (i, j), i, j in 0..3.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        const INDEX: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
        self.0[INDEX[i][j]]
    }

    /// self + other.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }

    /// s·self.
    #[inline(always)]
    pub fn times(self, s: f64) -> Self {
        Self(self.0.map(|x| x * s))
    }

    /// M v.
    #[inline(always)]
    pub fn apply(&self, v: Vec3) -> Vec3 {
        let m = &self.0;
        [
            m[0] * v[0] + m[1] * v[1] + m[3] * v[2],
            m[1] * v[0] + m[2] * v[1] + m[4] * v[2],
            m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
        ]
    }

    /// vᵀ M v.
    #[inline(always)]
    pub fn quadratic(&self, v: Vec3) -> f64 {
        let m = &self.0;
        m[0] * v[0] * v[0]
            + m[2] * v[1] * v[1]
            + m[5] * v[2] * v[2]
            + 2.0 * (m[1] * v[0] * v[1] + m[3] * v[0] * v[2] + m[4] * v[1] * v[2])
    }

    /// Determinant.
    #[inline(always)]
    pub fn det(&self) -> f64 {
        let m = &self.0;
        m[0] * (m[2] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[3]) + m[3] * (m[1] * m[4] - m[2] * m[3])
    }

    /// Trace.
    #[inline(always)]
    pub fn trace(&self) -> f64 {
        self.0[0] + self.0[2] + self.0[5]
    }

    /// Spectral decomposition by cyclic Jacobi rotations.
    pub fn eigen(&self) -> Eigen {
        let mut a = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                a[i][j] = self.at(i, j);
            }
        }
        let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..50 {
            let off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
            let diagonal = a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2];
            if off <= 1e-40 * diagonal || off == 0.0 {
                break;
            }
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for k in 0..3 {
                    let (x, y) = (a[k][p], a[k][q]);
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for k in 0..3 {
                    let (x, y) = (a[p][k], a[q][k]);
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
                for row in &mut v {
                    let (x, y) = (row[p], row[q]);
                    row[p] = c * x - s * y;
                    row[q] = s * x + c * y;
                }
            }
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
        Eigen { values: order.map(|i| a[i][i]), vectors: order.map(|i| [v[0][i], v[1][i], v[2][i]]) }
    }

    /// Σ values_i v_i v_iᵀ.
    pub fn from_eigen(eigen: &Eigen) -> Self {
        (0..3).fold(Self::ZERO, |m, i| m.plus(Self::outer(eigen.vectors[i], eigen.values[i])))
    }

    /// P f(D) Pᵀ.
    #[inline]
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        let mut eigen = self.eigen();
        eigen.values = eigen.values.map(f);
        Self::from_eigen(&eigen)
    }

    /// ln M of a positive-definite tensor.
    #[inline]
    pub fn ln(&self) -> Self {
        self.map(f64::ln)
    }

    /// exp L.
    #[inline]
    pub fn exp(&self) -> Self {
        self.map(f64::exp)
    }
}
