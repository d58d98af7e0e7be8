//! Surfaces that were copied from OCCT: evaluation, and feet of perpendiculars where there is a closed form.
use super::bridge::ffi;
use super::spline::SplineSurface;
use super::swept::Swept;
use crate::mesh::vector::{Vec3, add, dot, scale, sub};
use std::f64::consts::PI;

/// Point and derivatives of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// S(u, v).
    pub point: Vec3,
    /// S_u.
    pub du: Vec3,
    /// S_v.
    pub dv: Vec3,
    /// S_uu.
    pub duu: Vec3,
    /// S_uv.
    pub duv: Vec3,
    /// S_vv.
    pub dvv: Vec3,
}

/// Axes of an analytic surface. The third is kept apart, because a mirrored model has left-handed ones.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    origin: Vec3,
    x: Vec3,
    y: Vec3,
    z: Vec3,
}

/// A surface copied from OCCT once; parametrised as OCCT does.
#[derive(Clone, Debug)]
pub enum Surface {
    /// O + u X + v Y.
    Plane(Axes),
    /// O + R e(u) + v Z, where e(u) = cos u X + sin u Y.
    Cylinder(Axes, f64),
    /// O + (R + v sin a) e(u) + v cos a Z: radius and half angle.
    Cone(Axes, f64, f64),
    /// O + R cos v e(u) + R sin v Z.
    Sphere(Axes, f64),
    /// O + (R + r cos v) e(u) + r sin v Z.
    Torus(Axes, f64, f64),
    /// B-spline or Bezier.
    Spline(Box<SplineSurface>),
    /// Of revolution or extrusion of a curve.
    Swept(Box<Swept>),
    /// Evaluated by OCCT.
    General,
}

/// Up to four parameter pairs, the closest first.
#[derive(Clone, Copy, Debug)]
pub struct Feet {
    all: [[f64; 2]; 4],
    count: usize,
}

impl Feet {
    fn new(feet: &[[f64; 2]]) -> Self {
        let mut all = [[0.0; 2]; 4];
        all[..feet.len()].copy_from_slice(feet);
        Self { all, count: feet.len() }
    }

    /// The feet found.
    pub fn as_slice(&self) -> &[[f64; 2]] {
        &self.all[..self.count]
    }
}

/// A surface of revolution about Z: S = O + ρ(v) e(u) + h(v) Z, from (ρ, ρ′, ρ″) and (h, h′, h″).
fn revolve(axes: &Axes, u: f64, rho: [f64; 3], height: [f64; 3]) -> Jet {
    let (sin, cos) = u.sin_cos();
    let e = add(scale(axes.x, cos), scale(axes.y, sin));
    let e1 = sub(scale(axes.y, cos), scale(axes.x, sin));
    let rise = |k: usize| add(scale(e, rho[k]), scale(axes.z, height[k]));
    Jet {
        point: add(axes.origin, rise(0)),
        du: scale(e1, rho[0]),
        dv: rise(1),
        duu: scale(e, -rho[0]),
        duv: scale(e1, rho[1]),
        dvv: rise(2),
    }
}

impl Surface {
    /// The closed form of a record's kind (GeomAbs_SurfaceType).
    pub fn new(kind: u32, form: &ffi::Form) -> Self {
        let axes = Axes { origin: form.origin, x: form.x, y: form.y, z: form.z };
        let [a, b] = form.sizes;
        match kind {
            0 => Self::Plane(axes),
            1 => Self::Cylinder(axes, a),
            2 => Self::Cone(axes, a, b),
            3 => Self::Sphere(axes, a),
            4 => Self::Torus(axes, a, b),
            _ => Self::General,
        }
    }

    /// Point and derivatives; none without a copy.
    #[inline]
    pub fn jet(&self, [u, v]: [f64; 2]) -> Option<Jet> {
        let zero = [0.0; 3];
        Some(match self {
            Self::Plane(axes) => Jet {
                point: add(axes.origin, add(scale(axes.x, u), scale(axes.y, v))),
                du: axes.x,
                dv: axes.y,
                duu: zero,
                duv: zero,
                dvv: zero,
            },
            Self::Cylinder(axes, radius) => revolve(axes, u, [*radius, 0.0, 0.0], [v, 1.0, 0.0]),
            Self::Cone(axes, radius, angle) => {
                let (sin, cos) = angle.sin_cos();
                revolve(axes, u, [radius + v * sin, sin, 0.0], [v * cos, cos, 0.0])
            }
            Self::Sphere(axes, r) => {
                let (sin, cos) = v.sin_cos();
                revolve(axes, u, [r * cos, -r * sin, -r * cos], [r * sin, r * cos, -r * sin])
            }
            Self::Torus(axes, major, r) => {
                let (sin, cos) = v.sin_cos();
                revolve(axes, u, [major + r * cos, -r * sin, -r * cos], [r * sin, r * cos, -r * sin])
            }
            Self::Spline(spline) => spline.jet([u, v]),
            Self::Swept(swept) => return swept.jet([u, v]),
            Self::General => return None,
        })
    }

    /// The same without what takes longest: second derivatives may be left out, as zeros.
    #[inline]
    pub fn tangents(&self, uv: [f64; 2]) -> Option<Jet> {
        match self {
            Self::Spline(spline) => Some(spline.tangents(uv)),
            _ => self.jet(uv),
        }
    }

    /// Ends of the smooth spans of u (0) or v (1), where they are known.
    pub fn breaks(&self, k: usize) -> &[f64] {
        match self {
            Self::Spline(spline) => spline.breaks(k),
            Self::Swept(swept) => swept.breaks(k),
            _ => &[],
        }
    }

    /// Degree in u (0) or v (1) between the breaks.
    pub fn degree(&self, k: usize) -> usize {
        match self {
            Self::Spline(spline) => spline.degree(k),
            Self::Swept(swept) => swept.degree(k),
            _ => 1,
        }
    }

    /// Foot of the closest perpendicular on the whole surface; none without a closed form. For a point on the axis, to which all angles are
    /// equally close, u is that of `fallback`.
    pub fn foot(&self, point: Vec3, fallback: [f64; 2]) -> Option<[f64; 2]> {
        let local = self.local(point)?;
        let rho = local[0].hypot(local[1]);
        let u = if rho > 0.0 { local[1].atan2(local[0]) } else { fallback[0] };
        Some(match *self {
            Self::Plane(_) => [local[0], local[1]],
            Self::Cylinder(..) => [u, local[2]],
            Self::Sphere(..) => [u, if rho == 0.0 && local[2] == 0.0 { fallback[1] } else { local[2].atan2(rho) }],
            Self::Torus(_, major, _) => {
                let inner = rho - major;
                [u, if inner == 0.0 && local[2] == 0.0 { fallback[1] } else { local[2].atan2(inner) }]
            }
            Self::Cone(_, radius, angle) => {
                let (sin, cos) = angle.sin_cos();
                let near = (rho - radius) * sin + local[2] * cos;
                let far = (-rho - radius) * sin + local[2] * cos;
                // Distances from the two lines of the meridian plane, through the point's side and the other.
                let off = |r: f64, v: f64| (r - radius - v * sin).hypot(local[2] - v * cos);
                if off(-rho, far) < off(rho, near) { [u + PI, far] } else { [u, near] }
            }
            Self::Spline(_) | Self::Swept(_) | Self::General => return None,
        })
    }

    /// Feet of all perpendiculars on the whole surface, the closest first; none without a closed form.
    pub fn feet(&self, point: Vec3, fallback: [f64; 2]) -> Option<Feet> {
        let [u, v] = self.foot(point, fallback)?;
        Some(match self {
            Self::Plane(_) => Feet::new(&[[u, v]]),
            Self::Cylinder(..) => Feet::new(&[[u, v], [u + PI, v]]),
            Self::Sphere(..) => Feet::new(&[[u, v], [u + PI, -v]]),
            Self::Cone(_, radius, angle) => {
                // v = (±ρ − R) sin a + z cos a on the two lines of the meridian plane: their sum has no ρ.
                let (sin, cos) = angle.sin_cos();
                Feet::new(&[[u, v], [u + PI, 2.0 * (self.local(point)?[2] * cos - radius * sin) - v]])
            }
            Self::Torus(_, major, _) => {
                let local = self.local(point)?;
                let other = local[2].atan2(-local[0].hypot(local[1]) - major);
                Feet::new(&[[u, v], [u, v + PI], [u + PI, other], [u + PI, other + PI]])
            }
            Self::Spline(_) | Self::Swept(_) | Self::General => return None,
        })
    }

    /// Coordinates of a point in the surface's axes.
    fn local(&self, point: Vec3) -> Option<Vec3> {
        let axes = match self {
            Self::Plane(axes)
            | Self::Cylinder(axes, _)
            | Self::Cone(axes, ..)
            | Self::Sphere(axes, _)
            | Self::Torus(axes, ..) => axes,
            Self::Spline(_) | Self::Swept(_) | Self::General => return None,
        };
        let arm = sub(point, axes.origin);
        Some([dot(arm, axes.x), dot(arm, axes.y), dot(arm, axes.z)])
    }
}
