//! The cubic patches of one discrete face, and what is asked of them.
use super::cubic::{CubicTriangle, straight};
use super::foot::{Foot, NONE, foot};
use super::local_fit::axes;
use super::tree::{Box3, box_of};
use super::vertex_normals::SectorShape;
use crate::geometry::{SurfaceFrame, principal};
use crate::mesh::vector::{Vec3, area2, cross, dot, norm, scale, unit};
use nalgebra::Matrix2;
use std::sync::Arc;

/// A patch's normal shorter than this share of its triangle's greatest side squared is none.
const COLLAPSED: f64 = 1e-9;

/// Cubic patches over the triangles of a face; flat triangles have none.
pub(crate) struct Smooth {
    nets: Vec<CubicTriangle>,
    /// Number of each triangle's patch in `nets`, or `NONE`.
    net_of: Vec<u32>,
    /// Across 3·triangle + side: 3·triangle + side there, or `NONE` where the face ends.
    beyond: Vec<u32>,
    /// Normals and curvatures at the vertices, of all faces.
    shapes: Arc<Vec<SectorShape>>,
    /// Which of them stand at the corners of each triangle.
    shape_of: Vec<[u32; 3]>,
}

impl Smooth {
    /// Of a face's triangles, in their order.
    pub fn new(
        nets: impl Iterator<Item = Option<CubicTriangle>>,
        beyond: Vec<u32>,
        shapes: Arc<Vec<SectorShape>>,
        shape_of: Vec<[u32; 3]>,
    ) -> Option<Self> {
        let (mut kept, mut net_of) = (Vec::new(), Vec::with_capacity(shape_of.len()));
        for net in nets {
            net_of.push(if net.is_some() { kept.len() as u32 } else { NONE });
            kept.extend(net);
        }
        (!kept.is_empty()).then_some(Self { nets: kept, net_of, beyond, shapes, shape_of })
    }

    /// The box of all control points: the patches lie in it.
    pub fn bounds(&self) -> Box3 {
        box_of(self.nets.iter().flat_map(CubicTriangle::points))
    }

    /// The box of triangle k, or of its patch's control points.
    pub fn bounds_of(&self, k: usize, corners: [Vec3; 3]) -> Box3 {
        box_of(self.net(k, corners).points())
    }

    /// Whether triangle k is flat.
    pub fn is_chord(&self, k: usize) -> bool {
        self.net_of[k] == NONE
    }

    fn net(&self, k: usize, [a, b, c]: [Vec3; 3]) -> CubicTriangle {
        match self.net_of[k] {
            NONE => CubicTriangle::within(&[straight(a, b), straight(b, c), straight(c, a)]),
            net => self.nets[net as usize],
        }
    }

    /// The point of triangle k at barycentric weights.
    pub fn point(&self, k: usize, corners: [Vec3; 3], weights: [f64; 3]) -> Vec3 {
        self.net(k, corners).at(weights).point
    }

    /// Unit normal of triangle k at barycentric weights.
    pub fn normal(&self, k: usize, corners: [Vec3; 3], weights: [f64; 3]) -> Vec3 {
        self.unit_normal(k, corners, weights, self.net(k, corners).normal(weights))
    }

    /// The direction of a normal; of one that collapses that of the mean of the corners' normals.
    fn unit_normal(&self, k: usize, [a, b, c]: [Vec3; 3], weights: [f64; 3], normal: Vec3) -> Vec3 {
        let size = norm(area2(a, b, c));
        if norm(normal) > COLLAPSED * size {
            return unit(normal);
        }
        unit(self.mix(k, weights, |shape| shape.normal))
    }

    /// Point, derivatives by u and v (u = k + b1/2, v = b2), normal, and the curvatures at the corners carried over linearly.
    pub fn frame(&self, k: usize, corners: [Vec3; 3], weights: [f64; 3]) -> SurfaceFrame {
        let at = self.net(k, corners).at(weights);
        let [du, dv] = [scale(at.first[0], 2.0), at.first[1]];
        let normal = self.unit_normal(k, corners, weights, cross(at.first[0], at.first[1]));
        let shape = self.mix(k, weights, |shape| shape.shape);
        let (e1, e2) = axes(normal);
        let apply = |v: Vec3| {
            let [xx, xy, yy, xz, yz, zz] = shape;
            [dot([xx, xy, xz], v), dot([xy, yy, yz], v), dot([xz, yz, zz], v)]
        };
        let (first, second) = (apply(e1), apply(e2));
        let (curvatures, directions) =
            principal(Matrix2::new(dot(e1, first), dot(e2, first), dot(e1, second), dot(e2, second)), [e1, e2]);
        SurfaceFrame { point: at.point, du, dv, normal, curvatures, directions }
    }

    /// The closest point near a place on triangle k.
    pub fn foot(&self, p: Vec3, k: usize, weights: [f64; 3], corners: impl Fn(usize) -> [Vec3; 3]) -> Foot {
        foot(p, k, weights, |k| self.net(k, corners(k)), |side| self.beyond[side])
    }

    fn mix<const N: usize>(&self, k: usize, weights: [f64; 3], of: impl Fn(&SectorShape) -> [f64; N]) -> [f64; N] {
        let at = self.shape_of[k].map(|s| of(&self.shapes[s as usize]));
        std::array::from_fn(|i| weights[0] * at[0][i] + weights[1] * at[1][i] + weights[2] * at[2][i])
    }
}
