//! A plane face: the mean plane of its triangles.
use crate::geometry::SurfaceFrame;
use crate::mesh::vector::{Vec3, add, area2, cross, dot, norm, scale, sub, unit};

/// A plane with its axes: e1 × e2 = normal.
pub(crate) struct Plane {
    pub origin: Vec3,
    pub axes: [Vec3; 2],
    pub normal: Vec3,
}

impl Plane {
    /// The plane of triangles, if no corner is farther than `flat` from it and all look to the same side.
    pub fn fit(triangles: &[[Vec3; 3]], flat: f64) -> Option<Self> {
        let (mut sum, mut moment, mut total) = ([0.0; 3], [0.0; 3], 0.0);
        for &[a, b, c] in triangles {
            let twice = area2(a, b, c);
            sum = add(sum, twice);
            total += norm(twice);
            moment = add(moment, scale(add(add(a, b), c), norm(twice) / 3.0));
        }
        let turned = |&[a, b, c]: &[Vec3; 3]| dot(area2(a, b, c), sum) < 0.0;
        if total == 0.0 || triangles.iter().any(turned) {
            return None;
        }
        let (origin, normal) = (scale(moment, 1.0 / total), unit(sum));
        if triangles.iter().flatten().any(|&p| dot(sub(p, origin), normal).abs() > flat) {
            return None;
        }
        let least = (1..3).fold(0, |m, i| if normal[i].abs() < normal[m].abs() { i } else { m });
        let mut axis = [0.0; 3];
        axis[least] = 1.0;
        let e1 = unit(cross(axis, normal));
        Some(Self { origin, axes: [e1, cross(normal, e1)], normal })
    }

    /// Parameters of a point's projection.
    pub fn parameters(&self, p: Vec3) -> [f64; 2] {
        self.axes.map(|axis| dot(sub(p, self.origin), axis))
    }

    /// The closest point of the plane.
    pub fn project(&self, p: Vec3) -> Vec3 {
        sub(p, scale(self.normal, dot(sub(p, self.origin), self.normal)))
    }

    /// Point and derivatives at parameters.
    pub fn frame(&self, uv: [f64; 2]) -> SurfaceFrame {
        let point = add(self.origin, add(scale(self.axes[0], uv[0]), scale(self.axes[1], uv[1])));
        let [du, dv] = self.axes;
        SurfaceFrame { point, du, dv, normal: self.normal, curvatures: [0.0; 2], directions: self.axes }
    }
}
