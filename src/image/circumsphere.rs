//! Circumscribed spheres and circles, and the exact test whether a point lies inside.
use crate::mesh::vector::{Vec3, add, cross, distance, dot, scale, sub};
use robust::Coord3D;

/// Centre of the circumsphere; of a tetrahedron too flat for one, the centroid.
#[inline]
pub fn centre([a, b, c, d]: [Vec3; 4]) -> Vec3 {
    let [u, v, w] = [sub(b, a), sub(c, a), sub(d, a)];
    let [vw, wu, uv] = [cross(v, w), cross(w, u), cross(u, v)];
    let sum = add(scale(vw, dot(u, u)), add(scale(wu, dot(v, v)), scale(uv, dot(w, w))));
    let centre = add(a, scale(sum, 0.5 / dot(u, vw)));
    if centre.iter().all(|x| x.is_finite()) { centre } else { scale(add(add(a, b), add(c, d)), 0.25) }
}

/// Centre of a triangle's circumscribed circle; of one too flat for it, the centroid.
pub fn circle_centre([a, b, c]: [Vec3; 3]) -> Vec3 {
    let [u, v] = [sub(b, a), sub(c, a)];
    let n = cross(u, v);
    let sum = add(scale(cross(v, n), dot(u, u)), scale(cross(n, u), dot(v, v)));
    let centre = add(a, scale(sum, 0.5 / dot(n, n)));
    if centre.iter().all(|x| x.is_finite()) { centre } else { scale(add(add(a, b), c), 1.0 / 3.0) }
}

/// Length of the shortest edge between the points.
#[inline]
pub fn shortest_edge(points: &[Vec3]) -> f64 {
    let pairs = (1..points.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| distance(points[i], points[j])).fold(f64::INFINITY, f64::min)
}

/// Whether p lies inside the circumsphere of a positive tetrahedron. It is exact; a point on the sphere is not inside.
#[inline]
pub fn contains([a, b, c, d]: [Vec3; 4], p: Vec3) -> bool {
    let point = |p: Vec3| Coord3D { x: p[0], y: p[1], z: p[2] };
    // Shewchuk's positive tetrahedron is our negative one.
    robust::insphere(point(a), point(b), point(c), point(d), point(p)) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::predicate::is_positive;

    const CORNER: [Vec3; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn inside_on_and_outside() {
        assert!(is_positive(CORNER));
        assert!(contains(CORNER, [0.9, 0.9, 0.9]));
        assert!(!contains(CORNER, [1.0, 1.0, 1.0]));
        assert!(!contains(CORNER, [1.0, 1.0, 1.0 + f64::EPSILON]));
        assert!(contains(CORNER, [1.0, 1.0, 1.0 - f64::EPSILON]));
    }

    #[test]
    fn centres_are_as_far_from_all() {
        assert_eq!(centre(CORNER), [0.5; 3]);
        let triangle = [[1.0, 0.0, 2.0], [0.0, 3.0, 1.0], [-1.0, 0.5, 0.0]];
        let at = circle_centre(triangle);
        let radii = triangle.map(|p| distance(p, at));
        assert!(radii.iter().all(|r| (r - radii[0]).abs() < 1e-12), "{radii:?}");
        assert_eq!(centre([[1.0, 1.0, 1.0]; 4]), [1.0; 3]);
    }
}
