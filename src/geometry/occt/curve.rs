//! Curves that were copied from OCCT, and the descent to the closest point where there is no closed form.
use super::bridge::ffi;
use super::spline::SplineCurve;
use super::swept::Conic;
use crate::geometry::CurveFrame;
use crate::mesh::vector::{Vec3, add, distance, dot, scale, sub};

/// A curve copied from OCCT once.
#[derive(Clone, Debug)]
pub enum Curve {
    /// C(t) = O + t·X.
    Line { origin: Vec3, x: Vec3 },
    /// C(t) = O + R (cos t X + sin t Y).
    Circle { origin: Vec3, x: Vec3, y: Vec3, radius: f64 },
    /// An ellipse, hyperbola or parabola; of p-curves and generatrices also lines and circles.
    Conic(Conic),
    /// B-spline or Bezier.
    Spline(Box<SplineCurve>),
    /// Evaluated by OCCT.
    General,
}

impl Curve {
    /// The copy that the bridge gave; none where it gave none.
    pub fn copied(record: &ffi::Spline) -> Option<Self> {
        match record.kind {
            1 => SplineCurve::new(record).map(|spline| Self::Spline(Box::new(spline))),
            _ => Conic::new(record).map(Self::Conic),
        }
    }

    /// The closed form of a record's kind (GeomAbs_CurveType).
    pub fn new(kind: u32, form: &ffi::Form) -> Self {
        match kind {
            0 => Self::Line { origin: form.origin, x: form.x },
            1 => Self::Circle { origin: form.origin, x: form.x, y: form.y, radius: form.sizes[0] },
            _ => Self::General,
        }
    }

    /// C, C′ and C″; none without a copy.
    #[inline]
    pub fn frame(&self, t: f64) -> Option<CurveFrame> {
        match *self {
            Self::Spline(ref spline) => Some(spline.frame(t)),
            Self::Conic(ref conic) => Some(conic.frame(t)),
            Self::Line { origin, x } => Some(CurveFrame { point: add(origin, scale(x, t)), d1: x, d2: [0.0; 3] }),
            Self::Circle { origin, x, y, radius } => {
                let (sin, cos) = t.sin_cos();
                let arm = add(scale(x, radius * cos), scale(y, radius * sin));
                let d1 = add(scale(x, -radius * sin), scale(y, radius * cos));
                Some(CurveFrame { point: add(origin, arm), d1, d2: scale(arm, -1.0) })
            }
            Self::General => None,
        }
    }

    /// Parameter of the closest point on the whole line or circle; none without a closed form.
    pub fn foot(&self, point: Vec3) -> Option<f64> {
        match *self {
            Self::Line { origin, x } => Some(dot(sub(point, origin), x)),
            Self::Circle { origin, x, y, .. } => {
                let arm = sub(point, origin);
                Some(dot(arm, y).atan2(dot(arm, x)))
            }
            Self::Conic(_) | Self::Spline(_) | Self::General => None,
        }
    }

    /// Whether [`Self::foot`] has a closed form.
    pub fn has_foot(&self) -> bool {
        matches!(self, Self::Line { .. } | Self::Circle { .. })
    }

    /// The ends of the smooth spans, where they are known.
    pub fn breaks(&self) -> &[f64] {
        if let Self::Spline(spline) = self { spline.breaks() } else { &[] }
    }

    /// Degree between the breaks.
    pub fn degree(&self) -> usize {
        if let Self::Spline(spline) = self { spline.degree() } else { 1 }
    }
}

/// A point reached on a curve.
#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    /// Parameter.
    pub t: f64,
    /// C(t).
    pub point: Vec3,
    /// Distance from the point asked for.
    pub distance: f64,
}

/// Goes down from `start` to a closest point within `range`: Newton's method on |C(t) − p|², with C′·C′ in the place
/// of the second derivative where that is not convex, and steps halved until they do not climb.
///
/// `size` is the size of the model, for what counts as rounding. NaN in gives NaN out.
pub fn descend(
    mut frame: impl FnMut(f64) -> CurveFrame,
    point: Vec3,
    start: f64,
    range: [f64; 2],
    size: f64,
) -> CurvePoint {
    let mut t = start.clamp(range[0], range[1]);
    let mut here = frame(t);
    let mut length = distance(here.point, point);
    for _ in 0..ITERATIONS {
        let arm = sub(here.point, point);
        let (slope, speed2) = (dot(arm, here.d1), dot(here.d1, here.d1));
        let bend = speed2 + dot(arm, here.d2);
        let mut step = -slope / if bend > CONVEX * speed2 { bend } else { speed2 };
        if !step.is_finite() {
            break;
        }
        let mut moved = false;
        for _ in 0..HALVINGS {
            let next = (t + step).clamp(range[0], range[1]);
            let there = frame(next);
            let new_length = distance(there.point, point);
            if new_length <= length + NOISE * size {
                step = next - t;
                (t, here, length, moved) = (next, there, new_length, true);
                break;
            }
            step *= 0.5;
        }
        if !moved || step.abs() * speed2.sqrt() <= CONVERGED * size {
            break;
        }
    }
    CurvePoint { t, point: here.point, distance: length }
}

/// Most steps of a descent; four to six are common.
pub const ITERATIONS: usize = 40;
/// Most halvings of a step.
pub const HALVINGS: usize = 12;
/// Below this share of the metric term the second derivative is not trusted.
pub const CONVEX: f64 = 0.05;
/// Rounding of a distance, relative to the model's size: a strict decrease would stall on it.
pub const NOISE: f64 = 2e-16;
/// A step of this length, relative to the model's size, is the last: after it, quadratic convergence is at rounding.
pub const CONVERGED: f64 = 1e-10;
