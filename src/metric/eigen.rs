//! Eigenvalues and eigenvectors of symmetric 3×3 tensors.
use super::Sym3;
use crate::mesh::vector::{Vec3, cross, dot, norm, scale};

/// Eigenvalues (ascending) and unit eigenvectors (rows, right-handed or not) of a [`Sym3`].
#[derive(Clone, Copy, Debug)]
pub struct Eigen {
    /// Eigenvalues, ascending.
    pub values: [f64; 3],
    /// `vectors[i]` belongs to `values[i]`.
    pub vectors: [Vec3; 3],
}

/// Beyond this ratio of the eigenvalues of a metric (anisotropy 100) the small ones need Jacobi's relative accuracy.
const WELL_CONDITIONED: f64 = 1e-4;

/// A deviation from the mean by no more than this share of it is rounding.
const ISOTROPIC: f64 = 4e-16;

/// The two invariants of a traceless tensor S: p = tr S²/6, r = det S/2, so that S³ = 3p S + 2r I.
#[inline(always)]
pub(super) fn invariants(s: &Sym3) -> (f64, f64) {
    (s.contract(s) / 6.0, 0.5 * s.det())
}

/// Interpolant of cos(acos(t)/3) at Chebyshev's points of [0, 1], off by 1.3e-8 at most.
pub(super) const COSINE: [f64; 8] = [
    0.866_025_416_391,
    0.166_665_043_063,
    -0.048_077_350_345,
    0.024_392_383_832,
    -0.014_289_564_826,
    0.007_664_301_756,
    -0.002_922_830_503,
    0.000_542_607_713,
];

/// cos(acos(t)/3) for t in [0, 1]: the root of 4c³ − 3c = t in [√3/2, 1]. The slope there is at least 6, so one Newton step from the
/// value of the polynomial is right to rounding.
#[inline(always)]
fn cosine_of_third(t: f64) -> f64 {
    let (t2, k) = (t * t, &COSINE);
    // Estrin's scheme: a shorter chain than Horner's.
    let low = (k[0] + k[1] * t) + (k[2] + k[3] * t) * t2;
    let high = (k[4] + k[5] * t) + (k[6] + k[7] * t) * t2;
    let c = low + high * (t2 * t2);
    let c2 = c * c;
    c - (c * (4.0 * c2 - 3.0) - t) / (12.0 * c2 - 3.0)
}

/// The root of x³ = 3p x + 2r farthest from the other two (p > 0). It is well conditioned: its distance to the
/// others is at least √(3p), while the other two may coincide.
#[inline(always)]
pub(super) fn isolated_root(p: f64, r: f64) -> f64 {
    let root = p.sqrt();
    let c = cosine_of_third((r.abs() / (p * root)).min(1.0));
    (2.0 * root * c).copysign(r)
}

/// The roots of x³ = 3p x + 2r: the isolated one, then the other two, ascending. If these two are close, they are right only to
/// the square root of the rounding.
#[inline(always)]
pub(super) fn roots(p: f64, r: f64) -> [f64; 3] {
    let x = isolated_root(p, r);
    let half = (3.0 * p - 0.75 * x * x).max(0.0).sqrt();
    [x, -0.5 * x - half, -0.5 * x + half]
}

impl Sym3 {
    /// Spectral decomposition in closed form: the isolated eigenvalue and its vector first, then the plane normal to it.
    /// Values are right to the rounding of the largest one, vectors orthonormal to the rounding.
    pub fn eigen(&self) -> Eigen {
        let mean = self.trace() / 3.0;
        let deviator = self.plus_identity(-mean);
        let size = deviator.0.iter().fold(0.0f64, |a, x| a.max(x.abs()));
        if size <= ISOTROPIC * mean.abs() || size <= f64::MIN_POSITIVE || !size.is_finite() {
            return Eigen { values: [mean; 3], vectors: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
        }
        // With terms scaled to about 1 nothing under- or overflows. Then the rounding of the mean may matter, and is taken off.
        let s = Sym3(deviator.0.map(|x| x / size));
        let rest = s.trace() / 3.0;
        let (s, mean) = (s.plus_identity(-rest), mean + size * rest);
        let (p, r) = invariants(&s);
        let root = isolated_root(p, r);
        let axis = null_vector(&s.plus_identity(-root));
        let (u, w) = plane_basis(axis);
        let (su, sw) = (s.apply(u), s.apply(w));
        let (a, b, c) = (dot(u, su), dot(u, sw), dot(w, sw));
        let (low, high) = rotate(a, b, c, u, w);
        let isolated = (dot(axis, s.apply(axis)), axis);
        let order = if root > 0.0 { [low, high, isolated] } else { [isolated, low, high] };
        Eigen { values: order.map(|x| mean + size * x.0), vectors: order.map(|x| x.1) }
    }

    /// Spectral decomposition of a positive-definite tensor: in closed form, by Jacobi rotations when its eigenvalues
    /// differ so much that the small ones would lose figures (Demmel & Veselić 1992: Jacobi keeps them).
    #[inline]
    pub fn eigen_spd(&self) -> Eigen {
        let eigen = self.eigen();
        if eigen.values[0] > WELL_CONDITIONED * eigen.values[2] { eigen } else { self.eigen_jacobi() }
    }

    /// Spectral decomposition by cyclic Jacobi rotations: the slowest way, and the most accurate.
    pub fn eigen_jacobi(&self) -> Eigen {
        let mut a = [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.at(i, j)));
        let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for _ in 0..50 {
            let mut rotated = false;
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                let negligible = 1e-17 * (a[p][p].abs() * a[q][q].abs()).sqrt();
                if a[p][q].abs() <= negligible || !a[p][q].is_normal() {
                    continue;
                }
                rotated = true;
                jacobi_rotation(&mut a, &mut v, p, q);
            }
            if !rotated {
                break;
            }
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
        Eigen { values: order.map(|i| a[i][i]), vectors: order.map(|i| [v[0][i], v[1][i], v[2][i]]) }
    }
}

/// A ← Jᵀ A J with the rotation J that makes a_pq vanish, V ← V J.
#[inline]
fn jacobi_rotation(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = 1.0f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let shift = t * a[p][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    let k = 3 - p - q;
    let (x, y) = (a[k][p], a[k][q]);
    a[k][p] = c * x - s * y;
    a[k][q] = s * x + c * y;
    a[p][k] = a[k][p];
    a[q][k] = a[k][q];
    for row in v {
        let (x, y) = (row[p], row[q]);
        row[p] = c * x - s * y;
        row[q] = s * x + c * y;
    }
}

/// Unit vector of the null space of a tensor of rank 2: the largest cross product of two of its rows.
#[inline]
fn null_vector(s: &Sym3) -> Vec3 {
    let m = &s.0;
    let rows = [[m[0], m[1], m[3]], [m[1], m[2], m[4]], [m[3], m[4], m[5]]];
    let mut best = cross(rows[0], rows[1]);
    let mut greatest = dot(best, best);
    for candidate in [cross(rows[1], rows[2]), cross(rows[2], rows[0])] {
        let square = dot(candidate, candidate);
        if square > greatest {
            (best, greatest) = (candidate, square);
        }
    }
    scale(best, 1.0 / norm(best))
}

/// Two unit vectors that make an orthonormal frame with the unit vector n.
#[inline]
pub fn plane_basis(n: Vec3) -> (Vec3, Vec3) {
    let u = if n[0].abs() > n[1].abs() {
        let s = 1.0 / (n[0] * n[0] + n[2] * n[2]).sqrt();
        [-n[2] * s, 0.0, n[0] * s]
    } else {
        let s = 1.0 / (n[1] * n[1] + n[2] * n[2]).sqrt();
        [0.0, n[2] * s, -n[1] * s]
    };
    (u, cross(n, u))
}

/// Eigenpairs of ((a, b), (b, c)) in the frame (u, w), the lesser first.
#[inline]
fn rotate(a: f64, b: f64, c: f64, u: Vec3, w: Vec3) -> ((f64, Vec3), (f64, Vec3)) {
    let (mut cosine, mut sine, mut shift) = (1.0, 0.0, 0.0);
    if b != 0.0 {
        let theta = (c - a) / (2.0 * b);
        let t = 1.0f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
        cosine = 1.0 / (t * t + 1.0).sqrt();
        sine = t * cosine;
        shift = t * b;
    }
    let first: Vec3 = std::array::from_fn(|i| cosine * u[i] - sine * w[i]);
    let second: Vec3 = std::array::from_fn(|i| sine * u[i] + cosine * w[i]);
    let (x, y) = ((a - shift, first), (c + shift, second));
    if x.0 <= y.0 { (x, y) } else { (y, x) }
}
