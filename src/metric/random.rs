//! Random frames and metrics for property tests.
use super::Sym3;
use crate::mesh::vector::{Vec3, cross, dot, scale, sub, unit};
use proptest::prelude::*;

/// Orthonormal frames, near ones to the axes included.
pub fn rotated() -> impl Strategy<Value = [Vec3; 3]> {
    let direction = prop::array::uniform3(-1.0..1.0f64);
    let tilt = prop_oneof![Just(1.0), Just(1e-3), Just(1e-9), Just(0.0)];
    (direction.clone(), direction, tilt).prop_filter_map("independent", |(a, b, tilt)| {
        let a = unit([1.0 + tilt * a[0], tilt * a[1], tilt * a[2]]);
        let b = [tilt * b[0], 1.0 + tilt * b[1], tilt * b[2]];
        let b = sub(b, scale(a, dot(a, b)));
        let b = unit(sub(b, scale(a, dot(a, b))));
        (dot(b, b) > 0.5 && dot(a, b).abs() < 1e-15).then(|| [a, b, cross(a, b)])
    })
}

/// Metrics with sizes between 1 and e^spread, about a random overall size; equal sizes are common.
pub fn spd(spread: f64) -> impl Strategy<Value = Sym3> {
    let size = prop_oneof![Just(0.0), Just(spread), 0.0..spread, (0.0..1e-6f64)];
    (rotated(), [size.clone(), size.clone(), size], -8.0..8.0f64)
        .prop_map(|(frame, logs, overall)| Sym3::from_sizes(frame, logs.map(|x| (x + overall).exp())))
}
