//! Vectors of three coordinates, as arrays.

/// A point or vector in model units.
pub type Vec3 = [f64; 3];

/// a − b.
#[inline(always)]
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + b.
#[inline(always)]
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// s·a.
#[inline(always)]
pub fn scale(a: Vec3, s: f64) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// a + s·(b − a).
#[inline(always)]
pub fn lerp(a: Vec3, b: Vec3, s: f64) -> Vec3 {
    [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])]
}

/// a·b.
#[inline(always)]
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|.
#[inline(always)]
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// |a − b|.
#[inline(always)]
pub fn distance(a: Vec3, b: Vec3) -> f64 {
    norm(sub(a, b))
}

/// a/|a|, or zero when a is zero.
#[inline(always)]
pub fn unit(a: Vec3) -> Vec3 {
    let n = norm(a);
    if n > 0.0 { scale(a, 1.0 / n) } else { [0.0; 3] }
}

/// Twice the area vector of the triangle: (b − a) × (c − a).
#[inline(always)]
pub fn area2(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    cross(sub(b, a), sub(c, a))
}

/// Six times the signed volume of the tetrahedron: positive when d lies on the side that the
/// normal of (a, b, c), by the right-hand rule, points to. This is libMeshb's positive tetrahedron.
#[inline(always)]
pub fn volume6(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
    dot(area2(a, b, c), sub(d, a))
}
