//! Exact orientation and sphere tests with a fast filter in front, and the perturbation that leaves no cospherical ties.
use super::twofold;
use crate::mesh::predicate::orientation;
use crate::mesh::vector::{Vec3, sub, volume6};
use robust::Coord3D;

/// Has the exact sign of six times the volume of (a, b, c, d): positive when d lies where the right-hand normal of
/// (a, b, c) points to, zero only for coplanar points.
#[inline]
pub fn orient(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let det = volume6(a, b, c, d);
    let size = |p: Vec3| {
        let v = sub(p, a);
        v[0].abs().max(v[1].abs()).max(v[2].abs())
    };
    // Six products of three rounded differences, each with a relative error of at most eight roundings: 48 · 2⁻⁵³.
    if det.abs() > 8e-15 * size(b) * size(c) * size(d) { det } else { orientation(a, b, c, d) }
}

/// Positive when e lies inside the sphere through the positive tetrahedron (a, b, c, d), negative when outside, zero when on
/// it: exact in its sign.
#[inline]
pub fn in_sphere(a: Vec3, b: Vec3, c: Vec3, d: Vec3, e: Vec3) -> f64 {
    let (p, q, r, s) = (sub(a, e), sub(b, e), sub(c, e), sub(d, e));
    let minor = |u: Vec3, v: Vec3| u[0] * v[1] - v[0] * u[1];
    let (pq, qr, rs, sp, pr, qs) = (minor(p, q), minor(q, r), minor(r, s), minor(s, p), minor(p, r), minor(q, s));
    let pqr = p[2] * qr - q[2] * pr + r[2] * pq;
    let qrs = q[2] * rs - r[2] * qs + s[2] * qr;
    let rsp = r[2] * sp + s[2] * pr + p[2] * rs;
    let spq = s[2] * pq + p[2] * qs + q[2] * sp;
    let square = |v: Vec3| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let det = (square(r) * spq - square(s) * pqr) + (square(p) * qrs - square(q) * rsp);
    let most = |k: usize| p[k].abs().max(q[k].abs()).max(r[k].abs().max(s[k].abs()));
    let (x, y, z) = (most(0), most(1), most(2));
    // 24 products with a relative error of at most 17 roundings: 24 · 17 · 2⁻⁵³ of the largest product.
    let scale = (x * y * z) * (x * x + y * y + z * z);
    if det.abs() > 5e-14 * scale {
        return det;
    }
    near_sphere(a, b, c, d, e, scale)
}

#[cold]
fn near_sphere(a: Vec3, b: Vec3, c: Vec3, d: Vec3, e: Vec3, scale: f64) -> f64 {
    if let Some(det) = twofold::in_sphere_on_grid(a, b, c, d, e) {
        return det;
    }
    if let Some(det) = twofold::in_sphere(a, b, c, d, e, scale) {
        return det;
    }
    let point = |p: Vec3| Coord3D { x: p[0], y: p[1], z: p[2] };
    -robust::insphere(point(a), point(b), point(c), point(d), point(e))
}

/// Whether point `e` lies inside the sphere of the positive tetrahedron `t`, both given by index: never undecided. A tie is
/// decided as if each point were raised on the paraboloid by an infinitesimal amount, that of a higher index far larger than
/// that of a lower one (Edelsbrunner and Mücke 1990), so that the triangulation is unique and needs no order of insertion.
#[inline]
pub fn in_sphere_perturbed(points: &[Vec3], t: [u32; 4], e: u32) -> bool {
    let at = |v: u32| points[v as usize];
    let sign = in_sphere(at(t[0]), at(t[1]), at(t[2]), at(t[3]), at(e));
    if sign != 0.0 { sign > 0.0 } else { tie(points, t, e) }
}

/// The highest index whose raising matters decides: raising `e` puts it outside; raising a corner lifts the sphere's
/// hyperplane over `e` where the barycentric coordinate of `e` for that corner is positive.
#[cold]
fn tie(points: &[Vec3], t: [u32; 4], e: u32) -> bool {
    let at = |v: u32| points[v as usize];
    let mut order = [(t[0], 0), (t[1], 1), (t[2], 2), (t[3], 3), (e, 4)];
    order.sort_unstable_by(|a, b| b.cmp(a));
    for (_, k) in order {
        if k == 4 {
            return false;
        }
        let mut corner = t;
        corner[k] = e;
        let sign = orient(at(corner[0]), at(corner[1]), at(corner[2]), at(corner[3]));
        if sign != 0.0 {
            return sign > 0.0;
        }
    }
    false
}

/// Whether the three points lie on one line: exact (their projections along the axes do).
pub fn collinear(a: Vec3, b: Vec3, c: Vec3) -> bool {
    [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| {
        let point = |p: Vec3| robust::Coord { x: p[i], y: p[j] };
        robust::orient2d(point(a), point(b), point(c)) == 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::unit;

    const CORNERS: [Vec3; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn sphere_test_is_positive_inside() {
        let [a, b, c, d] = CORNERS;
        assert!(orient(a, b, c, d) > 0.0);
        assert!(in_sphere(a, b, c, d, [0.4, 0.4, 0.4]) > 0.0);
        assert!(in_sphere(a, b, c, d, [-0.1, -0.1, -0.1]) < 0.0);
        assert_eq!(in_sphere(a, b, c, d, [1.0, 1.0, 1.0]), 0.0);
        assert!(in_sphere(a, b, c, d, [1.0, 1.0, 1.0 - f64::EPSILON]) > 0.0);
    }

    #[test]
    fn filters_agree_with_exact_arithmetic() {
        let mut state = 7_u64;
        let mut next = |grid: f64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (((state >> 33) as f64 / 2f64.powi(31)) * grid).floor() / grid
        };
        let point = |p: Vec3| Coord3D { x: p[0], y: p[1], z: p[2] };
        let mut zeros = 0;
        for k in 0..20_000 {
            let grid = if k % 2 == 0 { 4.0 } else { 1e12 };
            let p: [Vec3; 5] = std::array::from_fn(|_| std::array::from_fn(|_| 1e3 + next(grid)));
            let o = -robust::orient3d(point(p[0]), point(p[1]), point(p[2]), point(p[3]));
            assert_eq!(orient(p[0], p[1], p[2], p[3]).partial_cmp(&0.0), o.partial_cmp(&0.0));
            let s = -robust::insphere(point(p[0]), point(p[1]), point(p[2]), point(p[3]), point(p[4]));
            assert_eq!(in_sphere(p[0], p[1], p[2], p[3], p[4]).partial_cmp(&0.0), s.partial_cmp(&0.0));
            zeros += usize::from(s == 0.0);
            // Five points on a sphere but for rounding.
            let p = p.map(|x| unit(sub(x, [1e3 + 0.5; 3])));
            let s = -robust::insphere(point(p[0]), point(p[1]), point(p[2]), point(p[3]), point(p[4]));
            assert_eq!(in_sphere(p[0], p[1], p[2], p[3], p[4]).partial_cmp(&0.0), s.partial_cmp(&0.0));
        }
        assert!(zeros > 100);
    }

    #[test]
    fn grids_are_exact() {
        // On the sphere of radius 13 · 2¹⁸, and one step off it.
        let k = f64::from(1 << 18);
        let [a, b, c, d] =
            [[3.0, 4.0, 12.0], [12.0, -3.0, 4.0], [-4.0, 12.0, 3.0], [-12.0, -4.0, -3.0]].map(|p| p.map(|x| k * x));
        assert!(orient(a, b, c, d) < 0.0);
        for (step, sign) in [(-1.0, 1.0), (0.0, 0.0), (1.0, -1.0)] {
            let e = [4.0 * k + step, 3.0 * k, 12.0 * k];
            let scale = (26.0 * k).powi(5);
            let exact = twofold::in_sphere_on_grid(b, a, c, d, e).unwrap();
            assert_eq!(exact.partial_cmp(&0.0), sign.partial_cmp(&0.0));
            assert_eq!(in_sphere(b, a, c, d, e).partial_cmp(&0.0), sign.partial_cmp(&0.0));
            if step != 0.0 {
                assert_eq!(twofold::in_sphere(b, a, c, d, e, scale).unwrap().signum(), exact.signum());
            }
        }
        assert_eq!(twofold::in_sphere_on_grid(b, a, c, d, [0.1, 0.3, k]), None);
    }

    #[test]
    fn ties_are_antisymmetric() {
        // Two positive tetrahedra on one sphere that share a face: each sees the other's apex alike.
        let points = [CORNERS[1], CORNERS[2], CORNERS[3], [0.0; 3], [1.0; 3]];
        for swap in [false, true] {
            let mut p = points;
            if swap {
                p.swap(3, 4);
            }
            let (a, b) = if swap { (4, 3) } else { (3, 4) };
            assert_eq!(in_sphere_perturbed(&p, [0, 2, 1, a], b), in_sphere_perturbed(&p, [0, 1, 2, b], a));
        }
    }

    #[test]
    fn lines() {
        assert!(collinear([0.0; 3], [1.0, 2.0, 3.0], [-2.0, -4.0, -6.0]));
        assert!(!collinear([0.0; 3], [1.0, 2.0, 3.0], [2.0, 4.0, 6.0 + 1e-15]));
    }
}
