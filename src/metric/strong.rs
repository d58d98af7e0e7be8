//! Σ vᵀ exp(S) v along the eigenvectors of S, eight tensors at once: for layers so thin that a matrix of six terms would lose the figures of
//! its small eigenvalues.
//!
//! The closed form of eigen.rs without its branches: the isolated eigenvalue and its vector first, then one rotation in the plane normal to it.
use super::lanes::{LaneSym3, LaneVec3, Lanes, apply, cross, dot};

/// Σ vᵀ exp(S) v over six vectors, S traceless and `root` its isolated eigenvalue. S must not be near 0.
#[inline(always)]
pub fn form(s: &LaneSym3, root: Lanes, vectors: &[LaneVec3; 6]) -> Lanes {
    let axis = null_vector(s, root);
    let (u, w) = plane_basis(&axis);
    let (su, sw) = (apply(s, &u), apply(s, &w));
    let (a, b, c) = (dot(&u, &su), dot(&u, &sw), dot(&w, &sw));
    // The rotation that makes the term between u and w vanish: t its tangent, at most 1.
    let apart = c - a;
    let twice = b * 2.0;
    let hypotenuse = (apart * apart + twice * twice).sqrt();
    let t = twice.copysign(twice * Lanes::all(1.0).copysign(apart))
        / (apart.abs() + hypotenuse).max(Lanes::all(f64::MIN_POSITIVE));
    let cosine = Lanes::all(1.0) / (t * t + 1.0).sqrt();
    let (sine, shift) = (t * cosine, t * b);
    // A loop: closures are not compiled for the features of the kernel.
    let (mut first, mut second) = (u, u);
    for i in 0..3 {
        first[i] = cosine * u[i] - sine * w[i];
        second[i] = sine * u[i] + cosine * w[i];
    }
    let of_axis = dot(&axis, &apply(s, &axis));
    let (mut along_first, mut along_second, mut along_axis) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
    for v in vectors {
        let (x, y, z) = (dot(&first, v), dot(&second, v), dot(&axis, v));
        along_first = along_first + x * x;
        along_second = along_second + y * y;
        along_axis = along_axis + z * z;
    }
    (a - shift).exp() * along_first + (c + shift).exp() * along_second + of_axis.exp() * along_axis
}

/// Unit vector of the null space of S − root: the largest cross product of two of its rows.
#[inline(always)]
fn null_vector(s: &LaneSym3, root: Lanes) -> LaneVec3 {
    let m = [s[0] - root, s[1], s[2] - root, s[3], s[4], s[5] - root];
    let rows = [[m[0], m[1], m[3]], [m[1], m[2], m[4]], [m[3], m[4], m[5]]];
    let mut best = cross(&rows[0], &rows[1]);
    let mut greatest = dot(&best, &best);
    for candidate in [cross(&rows[1], &rows[2]), cross(&rows[2], &rows[0])] {
        let square = dot(&candidate, &candidate);
        let more = square - greatest;
        for i in 0..3 {
            best[i] = more.above(0.0, candidate[i], best[i]);
        }
        greatest = more.above(0.0, square, greatest);
    }
    let over = Lanes::all(1.0) / greatest.sqrt();
    [best[0] * over, best[1] * over, best[2] * over]
}

/// Two unit vectors that make an orthonormal frame with the unit vector n.
#[inline(always)]
fn plane_basis(n: &LaneVec3) -> (LaneVec3, LaneVec3) {
    let more = n[0].abs() - n[1].abs();
    let larger = more.above(0.0, n[0], n[1]);
    let over = Lanes::all(1.0) / (larger * larger + n[2] * n[2]).sqrt();
    let (across, along) = (n[2] * over, larger * over);
    let u =
        [more.above(0.0, -across, Lanes::ZERO), more.above(0.0, Lanes::ZERO, across), more.above(0.0, along, -along)];
    let w = cross(n, &u);
    (u, w)
}

#[cfg(test)]
mod tests {
    use super::super::batch::Batch;
    use super::super::lanes::LANES;
    use super::super::quality::mean_ratio;
    use super::super::random::rotated;
    use super::super::{Eigen, Sym3};
    use crate::mesh::vector::Vec3;
    use proptest::prelude::*;

    proptest! {
        /// Cells of a layer up to 1 : 3e6, of any orientation, with two sizes alike or none, have the mean ratio that they have one by one.
        #[test]
        fn thin_cells_as_one_by_one(
            vectors in rotated(),
            middle in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0f64, 0.0..1e-6f64],
            spread in 14.0..29.8f64,
            x in prop::array::uniform5(prop::array::uniform3(-0.5..0.5f64)),
        ) {
            let values = [0.0, middle * spread, spread];
            let log = Sym3::from_eigen(&Eigen { values, vectors });
            let points = x.map(|x| -> Vec3 {
                std::array::from_fn(|k| (0..3).map(|i| x[i] * (-0.5 * values[i]).exp() * vectors[i][k]).sum())
            });
            let mut batch = Batch::default();
            for lane in 0..LANES {
                batch.set(lane, [0, 1, 2].map(|i| points[(lane + i) % 4]), [&log; 3]);
            }
            batch.prepare();
            for (lane, found) in batch.shapes(points[4], &log).mean_ratios().into_iter().enumerate() {
                let corner = |i: usize| points[(lane + i) % 4];
                let wanted = mean_ratio([corner(0), corner(1), corner(2), points[4]], [&log; 4]).max(0.0);
                // 0: so flat and tilted that the sign of the volume is not sure.
                let is_unsure = found == 0.0 && (spread > 25.0 || wanted < 0.1);
                let is_same = is_unsure || (found - wanted).abs() <= 1e-8 * wanted;
                prop_assert!(is_same || wanted < 1e-2, "lane {lane}: {found} {wanted} {spread}");
            }
        }
    }
}
