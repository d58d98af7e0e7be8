//! Conics in their own axes, and surfaces that a curve sweeps out.
use super::bridge::ffi;
use super::curve::Curve;
use super::surface::Jet;
use crate::geometry::CurveFrame;
use crate::mesh::vector::{Vec3, add, cross, dot, scale, sub};

/// How a conic's two axes go with its parameter.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Line,
    Ellipse,
    Hyperbola,
    Parabola,
}

/// O + f(t) X + g(t) Y, the axes with their lengths.
#[derive(Clone, Copy, Debug)]
pub struct Conic {
    shape: Shape,
    origin: Vec3,
    x: Vec3,
    y: Vec3,
}

impl Conic {
    /// The copy that the bridge gave; none of another kind.
    pub fn new(record: &ffi::Spline) -> Option<Self> {
        let shape = match record.kind {
            2 => Shape::Line,
            3 => Shape::Ellipse,
            4 => Shape::Hyperbola,
            5 => Shape::Parabola,
            _ => return None,
        };
        Some(Self { shape, origin: record.origin, x: record.x, y: record.y })
    }

    /// C, C′ and C″.
    pub fn frame(&self, t: f64) -> CurveFrame {
        let (f, g) = match self.shape {
            Shape::Line => ([t, 1.0, 0.0], [0.0; 3]),
            Shape::Ellipse => {
                let (sin, cos) = t.sin_cos();
                ([cos, -sin, -cos], [sin, cos, -sin])
            }
            Shape::Hyperbola => {
                let (sinh, cosh) = (t.sinh(), t.cosh());
                ([cosh, sinh, cosh], [sinh, cosh, sinh])
            }
            Shape::Parabola => ([t * t, 2.0 * t, 2.0], [t, 1.0, 0.0]),
        };
        let at = |k: usize| add(scale(self.x, f[k]), scale(self.y, g[k]));
        CurveFrame { point: add(self.origin, at(0)), d1: at(1), d2: at(2) }
    }
}

/// A surface of revolution, O + R(u) (C(v) − O), or of extrusion, C(u) + v X.
#[derive(Clone, Debug)]
pub struct Swept {
    turned: bool,
    origin: Vec3,
    axis: Vec3,
    curve: Curve,
}

impl Swept {
    /// From the copies of the surface and its curve; none of another kind, or where the curve has no copy.
    pub fn new(record: &ffi::Spline, generatrix: &ffi::Spline) -> Option<Self> {
        let turned = match record.kind {
            6 => true,
            7 => false,
            _ => return None,
        };
        let curve = Curve::copied(generatrix)?;
        Some(Self { turned, origin: record.origin, axis: record.x, curve })
    }

    /// S and its derivatives to the second.
    pub fn jet(&self, [u, v]: [f64; 2]) -> Option<Jet> {
        let curve = self.curve.frame(if self.turned { v } else { u })?;
        if !self.turned {
            let point = add(curve.point, scale(self.axis, v));
            let zero = [0.0; 3];
            return Some(Jet { point, du: curve.d1, dv: self.axis, duu: curve.d2, duv: zero, dvv: zero });
        }
        let (sin, cos) = u.sin_cos();
        // An arm is turned; so are its derivatives in v. (along the axis + turned, d/du, d²/du²)
        let turn = |arm: Vec3| {
            let along = scale(self.axis, dot(arm, self.axis));
            let (out, side) = (sub(arm, along), cross(self.axis, arm));
            let turned = add(scale(out, cos), scale(side, sin));
            [add(along, turned), sub(scale(side, cos), scale(out, sin)), scale(turned, -1.0)]
        };
        let [s, du, duu] = turn(sub(curve.point, self.origin));
        let [dv, duv, _] = turn(curve.d1);
        let [dvv, ..] = turn(curve.d2);
        Some(Jet { point: add(self.origin, s), du, dv, duu, duv, dvv })
    }

    /// Ends of the curve's spans, which u (extrusion) or v (revolution) should be cut at; k tells whose.
    pub fn breaks(&self, k: usize) -> &[f64] {
        match &self.curve {
            Curve::Spline(spline) if (k == 1) == self.turned => spline.breaks(),
            _ => &[],
        }
    }

    /// Degree of the curve, in the direction that it runs in.
    pub fn degree(&self, k: usize) -> usize {
        if (k == 1) == self.turned { self.curve.degree() } else { 1 }
    }
}
