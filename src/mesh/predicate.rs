//! The exact orientation predicate, in the sign convention of this project.
use super::vector::{Vec3, sub, volume6};
use robust::Coord3D;

/// Has the exact sign of [`super::vector::volume6`]: positive when d lies on the side that the right-hand normal of (a, b, c)
/// points to, zero only when the four points are coplanar (adaptive arithmetic of Shewchuk 1997).
#[inline]
pub fn orientation(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    let point = |p: Vec3| Coord3D { x: p[0], y: p[1], z: p[2] };
    // Shewchuk's orient3d is positive when d lies below.
    -robust::orient3d(point(a), point(b), point(c), point(d))
}

/// Whether the tetrahedron is positive: exact.
#[inline]
pub fn is_positive(p: [Vec3; 4]) -> bool {
    let volume = volume6(p[0], p[1], p[2], p[3]);
    let size = |k: usize| sub(p[k], p[0]).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    // Thrice the forward error bound of the 3×3 determinant of rounded differences.
    if volume.abs() > 4e-14 * size(1) * size(2) * size(3) {
        return volume > 0.0;
    }
    orientation(p[0], p[1], p[2], p[3]) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_of_the_volume() {
        let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for z in [1.0, -1.0] {
            assert_eq!(orientation(a, b, c, [0.1, 0.2, z]).signum(), volume6(a, b, c, [0.1, 0.2, z]).signum());
        }
        assert_eq!(orientation(a, b, c, [0.3, 0.7, 0.0]), 0.0);
    }

    #[test]
    fn exact_where_the_volume_is_rounded() {
        // d is off the plane x + y + z = 1.5 by one unit in the last place.
        let [a, b, c] = [[0.5, 0.5, 0.5], [12.0, -10.5, 0.0], [24.0, -12.5, -10.0]];
        let d = [18.0, -11.5, -5.0 + 5.0 * f64::EPSILON];
        assert_ne!(orientation(a, b, c, d), 0.0);
        assert_eq!(orientation(a, b, c, [18.0, -11.5, -5.0]), 0.0);
    }
}
