//! Points whose convex hull, enlarged by a margin, holds a piece of a curve or surface: Bezier poles of splines, else samples.
use super::curve::Curve;
use super::pieces::Jets;
use super::surface::{Jet, Surface};
use crate::geometry::CurveFrame;
use crate::mesh::vector::{Vec3, norm};

/// Samples in each direction, ends included.
const SAMPLES: usize = 5;
/// Between the samples the second derivative may exceed their largest one by this factor.
const EXCESS: f64 = 1.5;

/// A curve as a surface without extent in v.
pub fn as_jet(frame: CurveFrame) -> Jet {
    let zero = [0.0; 3];
    Jet { point: frame.point, du: frame.d1, dv: zero, duu: frame.d2, duv: zero, dvv: zero }
}

/// Points about a surface over a rectangle, and their margin. A spline's rectangle lies in one of its spans.
pub fn of_surface(form: &Surface, jet: &mut Jets, rectangle: [[f64; 2]; 2], out: &mut Vec<Vec3>) -> f64 {
    match form {
        Surface::Spline(spline) => {
            spline.hull(rectangle, out);
            0.0
        }
        _ => sampled(jet, rectangle, out),
    }
}

/// Points about a curve between two parameters, and their margin. A spline's lie in one of its spans.
pub fn of_curve(form: &Curve, jet: &mut Jets, range: [f64; 2], out: &mut Vec<Vec3>) -> f64 {
    match form {
        Curve::Spline(spline) => {
            spline.hull(range, out);
            0.0
        }
        _ => sampled(jet, [range, [0.0; 2]], out),
    }
}

/// Samples, and the greatest distance of a smooth piece from the hull of neighbouring samples: h²/8 times the second derivative.
fn sampled(jet: &mut Jets, rectangle: [[f64; 2]; 2], out: &mut Vec<Vec3>) -> f64 {
    let [u, v] = rectangle;
    let at = |[low, high]: [f64; 2], i: usize| {
        let s = i as f64 / (SAMPLES - 1) as f64;
        low * (1.0 - s) + high * s
    };
    let columns = if v[0] == v[1] { 1 } else { SAMPLES };
    let mut bends = [0.0f64; 3];
    for i in 0..SAMPLES {
        for j in 0..columns {
            let here = jet([at(u, i), at(v, j)]);
            out.push(here.point);
            for (bend, second) in bends.iter_mut().zip([here.duu, here.duv, here.dvv]) {
                *bend = bend.max(norm(second));
            }
        }
    }
    let [h, k] = [u, v].map(|[low, high]| (high - low) / (SAMPLES - 1) as f64);
    EXCESS * 0.125 * (h * h * bends[0] + 2.0 * h * k * bends[1] + k * k * bends[2])
}
