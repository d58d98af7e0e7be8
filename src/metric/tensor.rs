//! Symmetric 3×3 tensors: the algebra, and the maps through eigenvalues (METHOD.md §1.1).
use super::eigen::Eigen;
use crate::mesh::vector::Vec3;

/// A symmetric 3×3 tensor; the six terms are in the order of .sol files: 11 12 22 13 23 33.
/// The order is part of the type. Conversions from other orders are named functions.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Sym3(pub [f64; 6]);

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

    /// Determinant, by expansion. Of a metric of great anisotropy prefer [`Sym3::sqrt_det`].
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

    /// tr(A B): of a sum of dyads Σ vvᵀ and a metric M this is Σ vᵀ M v.
    #[inline(always)]
    pub fn contract(&self, other: &Self) -> f64 {
        let (a, b) = (&self.0, &other.0);
        a[0] * b[0] + a[2] * b[2] + a[5] * b[5] + 2.0 * (a[1] * b[1] + a[3] * b[3] + a[4] * b[4])
    }

    /// s·I + self.
    #[inline(always)]
    pub fn plus_identity(self, s: f64) -> Self {
        let m = self.0;
        Self([m[0] + s, m[1], m[2] + s, m[3], m[4], m[5] + s])
    }

    /// A².
    #[inline(always)]
    pub fn squared(&self) -> Self {
        let [a, b, c, d, e, f] = self.0;
        Self([
            a * a + b * b + d * d,
            a * b + b * c + d * e,
            b * b + c * c + e * e,
            a * d + b * e + d * f,
            b * d + c * e + e * f,
            d * d + e * e + f * f,
        ])
    }

    /// R A R with a symmetric R (self is A).
    #[inline]
    pub fn congruent(&self, r: &Self) -> Self {
        let rows = [[r.0[0], r.0[1], r.0[3]], [r.0[1], r.0[2], r.0[4]], [r.0[3], r.0[4], r.0[5]]];
        let mut out = [0.0; 6];
        for (k, (i, j)) in [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].into_iter().enumerate() {
            out[k] = crate::mesh::vector::dot(rows[i], self.apply(rows[j]));
        }
        Self(out)
    }

    /// The pivots of M = L D Lᵀ, in the order of the rows; their product is the determinant, and all are
    /// positive just when M is positive definite. Not defined (NaN or infinite) when a pivot vanishes.
    #[inline]
    pub(super) fn pivots(&self) -> [f64; 3] {
        let [a, b, c, d, e, f] = self.0;
        let l1 = b / a;
        let p2 = c - l1 * b;
        let x = e - l1 * d;
        [a, p2, f - d / a * d - x / p2 * x]
    }

    /// M⁻¹ b of a positive-definite tensor, by M = L D Lᵀ.
    #[inline]
    pub fn solve(&self, b: Vec3) -> Vec3 {
        let m = &self.0;
        let (l1, l2) = (m[1] / m[0], m[3] / m[0]);
        let d1 = m[2] - l1 * m[1];
        let x = m[4] - l1 * m[3];
        let l3 = x / d1;
        let d2 = m[5] - l2 * m[3] - l3 * x;
        let y1 = b[1] - l1 * b[0];
        let y2 = b[2] - l2 * b[0] - l3 * y1;
        let z = y2 / d2;
        let y = y1 / d1 - l3 * z;
        [b[0] / m[0] - l1 * y - l2 * z, y, z]
    }

    /// √det M of a positive-definite tensor, by its pivots: no differences of products of three terms.
    #[inline]
    pub fn sqrt_det(&self) -> f64 {
        let [a, b, c] = self.pivots();
        a.sqrt() * b.sqrt() * c.sqrt()
    }

    /// Whether all terms are finite and all eigenvalues positive (in floating point).
    pub fn is_spd(&self) -> bool {
        self.0.iter().all(|x| x.is_finite()) && self.eigen_spd().values[0] > 0.0
    }

    /// The sizes h = λ^(-1/2), greatest first, of a positive-definite metric; `eigen_spd().vectors` are their directions.
    pub fn sizes(&self) -> [f64; 3] {
        self.eigen_spd().values.map(|x| 1.0 / x.sqrt())
    }

    /// The metric of sizes h_i > 0 along orthonormal directions.
    pub fn from_sizes(directions: [Vec3; 3], sizes: [f64; 3]) -> Self {
        Self::from_eigen(&Eigen { values: sizes.map(|h| 1.0 / (h * h)), vectors: directions })
    }

    /// Σ values_i v_i v_iᵀ.
    #[inline]
    pub fn from_eigen(eigen: &Eigen) -> Self {
        let [a, b, c] = eigen.vectors;
        Self::outer(a, eigen.values[0]).plus(Self::outer(b, eigen.values[1])).plus(Self::outer(c, eigen.values[2]))
    }

    /// |M|: the same eigenvectors, the absolute values of the eigenvalues.
    pub fn magnitude(&self) -> Self {
        let eigen = self.eigen();
        Self::from_eigen(&Eigen { values: eigen.values.map(f64::abs), ..eigen })
    }

    /// P f(D) Pᵀ of a positive-definite tensor.
    #[inline]
    pub fn map_spd(&self, f: impl Fn(f64) -> f64) -> Self {
        let mut eigen = self.eigen_spd();
        eigen.values = eigen.values.map(f);
        Self::from_eigen(&eigen)
    }

    /// ln M of a positive-definite tensor.
    #[inline]
    pub fn ln(&self) -> Self {
        self.map_spd(f64::ln)
    }

    /// M^(1/2) of a positive-definite tensor.
    #[inline]
    pub fn sqrt(&self) -> Self {
        self.map_spd(f64::sqrt)
    }

    /// M^(-1/2) of a positive-definite tensor.
    #[inline]
    pub fn inverse_sqrt(&self) -> Self {
        self.map_spd(|x| 1.0 / x.sqrt())
    }

    /// M^(-1) of a positive-definite tensor.
    #[inline]
    pub fn inverse(&self) -> Self {
        self.map_spd(|x| 1.0 / x)
    }
}
