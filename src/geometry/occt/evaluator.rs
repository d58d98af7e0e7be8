//! The evaluator of one thread: points, derivatives, normals and curvatures.
use super::OcctModel;
use super::bridge::ffi;
use super::range::{self, bring_near, place};
use super::surface::{Jet, Surface};
use super::{newton, project, project_edges};
use crate::geometry::{CurveFrame, Evaluate, OnCurve, OnSurface, SurfaceFrame};
use crate::mesh::vector::{Vec3, cross, distance, dot, norm, scale, unit};
use cxx::UniquePtr;
use std::sync::PoisonError;

/// Evaluator of one thread, with adaptors and classifiers of its own. The next evaluator goes on with these.
pub struct OcctEvaluator<'a> {
    pub(super) model: &'a OcctModel,
    pub(super) occt: UniquePtr<ffi::Evaluator>,
    /// Points of a hull, allocated once.
    pub(super) points: Vec<Vec3>,
}

/// Below this sine, or this share of the longer side, Su × Sv gives no normal.
const SINGULAR: f64 = 1e-9;
/// Where Su × Sv gives no normal, it is taken so far towards the middle of the range.
const NUDGE: f64 = 1e-4;

impl<'a> OcctEvaluator<'a> {
    pub(super) fn new(model: &'a OcctModel) -> Self {
        let idle = model.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        // A new one only reserves memory: the adaptors are made when first asked for.
        let occt = idle.unwrap_or_else(|| ffi::new_evaluator(&model.occt).expect("memory for an evaluator"));
        Self { model, occt, points: Vec::new() }
    }

    /// The distance that OCCT's own search (BRepExtrema) finds from a face or an edge: slow, the oracle of the tests.
    pub fn reference_distance(&self, is_face: bool, index: u32, point: Vec3) -> Option<f64> {
        self.occt.reference_distance(is_face, index, &point).ok()
    }

    /// OCCT's own S, Su, Sv, Suu, Suv, Svv: the oracle of the tests.
    #[doc(hidden)]
    pub fn reference_surface(&mut self, face: u32, uv: [f64; 2]) -> [Vec3; 6] {
        let jet = self.jet_by_occt(face, uv);
        [jet.point, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv]
    }

    /// Ours, from the copy where there is one.
    #[doc(hidden)]
    pub fn surface_derivatives(&mut self, face: u32, uv: [f64; 2]) -> [Vec3; 6] {
        let jet = self.jet(face, uv);
        [jet.point, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv]
    }

    /// OCCT's own C, C′, C″: the oracle of the tests.
    #[doc(hidden)]
    pub fn reference_curve(&mut self, edge: u32, t: f64) -> [Vec3; 3] {
        let frame = self.curve_by_occt(edge, t);
        [frame.point, frame.d1, frame.d2]
    }

    /// The point of an edge's p-curve, by OCCT or (`copied`) from the copy; none where there is none.
    #[doc(hidden)]
    pub fn pcurve(&mut self, edge: u32, face: u32, t: f64, copied: bool) -> Option<[f64; 2]> {
        if copied {
            let pcurve = self.model.pcurves[edge as usize].iter().find(|pcurve| pcurve.face == face)?;
            return pcurve.curve.frame(t).map(|frame| [frame.point[0], frame.point[1]]);
        }
        let mut uv = [0.0; 2];
        self.occt.pin_mut().pcurve_d0(edge, face, t, &mut uv).unwrap_or(false).then_some(uv)
    }

    /// Point and derivatives; NaN where OCCT has to evaluate and cannot.
    #[inline]
    pub(super) fn jet(&mut self, face: u32, uv: [f64; 2]) -> Jet {
        match self.model.surfaces[face as usize].form.jet(uv) {
            Some(jet) => jet,
            None => self.jet_by_occt(face, uv),
        }
    }

    fn jet_by_occt(&mut self, face: u32, uv: [f64; 2]) -> Jet {
        let mut out = [f64::NAN; 18];
        if self.occt.pin_mut().surface_d2(face, uv[0], uv[1], &mut out).is_err() {
            out = [f64::NAN; 18];
        }
        let part = |k: usize| [out[k], out[k + 1], out[k + 2]];
        Jet { point: part(0), du: part(3), dv: part(6), duu: part(9), duv: part(12), dvv: part(15) }
    }

    /// S(u, v).
    pub(super) fn surface_point(&mut self, face: u32, uv: [f64; 2]) -> Vec3 {
        if let Some(jet) = self.model.surfaces[face as usize].form.jet(uv) {
            return jet.point;
        }
        let mut out = [f64::NAN; 3];
        let done = self.occt.pin_mut().surface_d0(face, uv[0], uv[1], &mut out);
        if done.is_ok() { out } else { [f64::NAN; 3] }
    }

    /// C(t) and derivatives, t as it is; NaN where OCCT has to evaluate and cannot.
    #[inline]
    pub(super) fn curve(&mut self, edge: u32, t: f64) -> CurveFrame {
        match self.model.curves[edge as usize].form.frame(t) {
            Some(frame) => frame,
            None => self.curve_by_occt(edge, t),
        }
    }

    fn curve_by_occt(&mut self, edge: u32, t: f64) -> CurveFrame {
        let mut out = [f64::NAN; 9];
        if self.occt.pin_mut().curve_d2(edge, t, &mut out).is_err() {
            out = [f64::NAN; 9];
        }
        let part = |k: usize| [out[k], out[k + 1], out[k + 2]];
        CurveFrame { point: part(0), d1: part(3), d2: part(6) }
    }

    /// Whether OCCT's classifier finds the parameters in the trimmed face or on its boundary.
    pub(super) fn inside_by_occt(&mut self, face: u32, uv: [f64; 2]) -> bool {
        self.occt.pin_mut().inside(face, uv[0], uv[1]).unwrap_or(false)
    }

    /// Parameters within the face's range.
    pub(super) fn placed(&self, face: u32, uv: [f64; 2]) -> ([f64; 2], bool) {
        let face = &self.model.topology.faces[face as usize];
        let (u, in_u) = place(uv[0], face.range[0], face.period[0]);
        let (v, in_v) = place(uv[1], face.range[1], face.period[1]);
        ([u, v], in_u && in_v)
    }

    /// Unit normal Su × Sv; none where it is undefined.
    fn regular_normal(&self, face: u32, jet: &Jet) -> Option<Vec3> {
        let spans = self.model.topology.faces[face as usize].range.map(|[low, high]| high - low);
        let (a, b) = (norm(jet.du), norm(jet.dv));
        let normal = cross(jet.du, jet.dv);
        let length = norm(normal);
        // Rounding leaves Su of a sphere a direction even at a pole. At a cone's apex such a direction means nothing.
        let sphere = matches!(self.model.surfaces[face as usize].form, Surface::Sphere(..));
        let least = if sphere { 1e-30 } else { SINGULAR };
        let (long, short) = ((a * spans[0]).max(b * spans[1]), (a * spans[0]).min(b * spans[1]));
        (short > least * long && length > SINGULAR * a * b).then(|| scale(normal, 1.0 / length))
    }

    /// Unit normal Su × Sv, at a pole its limit; zero where there is none (an apex).
    fn normal(&mut self, face: u32, uv: [f64; 2], jet: &Jet) -> Vec3 {
        if let Some(normal) = self.regular_normal(face, jet) {
            return normal;
        }
        // The limits from two sides agree at a pole, and not at an apex.
        let range = self.model.topology.faces[face as usize].range;
        let sides = [0.25, 0.75].map(|s| {
            let middle = range.map(|[low, high]| low + s * (high - low));
            let near = [0, 1].map(|k: usize| uv[k] + NUDGE * (middle[k] - uv[k]));
            // The parameter without length is free, so it is varied.
            let free = usize::from(norm(jet.du) > norm(jet.dv));
            let mut at = near;
            at[free] = middle[free];
            let jet = self.jet(face, at);
            self.regular_normal(face, &jet)
        });
        match sides {
            [Some(a), Some(b)] if dot(a, b) > 0.99 => unit([a[0] + b[0], a[1] + b[1], a[2] + b[2]]),
            _ => [0.0; 3],
        }
    }

    /// Turns the normal out of the solid.
    fn outward(&self, face: u32, normal: Vec3) -> Vec3 {
        if self.model.topology.faces[face as usize].reversed { scale(normal, -1.0) } else { normal }
    }

    /// The point of a degenerate edge: its vertex.
    pub(super) fn degenerate_point(&self, edge: u32) -> Option<Vec3> {
        let topology = &self.model.topology;
        let entity = &topology.edges[edge as usize];
        let vertex = entity.vertices.into_iter().flatten().next();
        entity.degenerate.then(|| vertex.map_or([f64::NAN; 3], |v| topology.vertices[v as usize].point))
    }

    /// Moves the parameters of an edge's point to where the surface is closest to it: p-curves miss their edge by more
    /// than the tolerance that the file states, mostly along it. They stay on their side of a seam.
    fn refined(&mut self, face: u32, uv: [f64; 2], target: Vec3) -> [f64; 2] {
        let entity = &self.model.topology.faces[face as usize];
        let (range, period) = (entity.range, entity.period);
        let better = if let Some(foot) = self.model.surfaces[face as usize].form.foot(target, uv) {
            [0, 1].map(|k: usize| bring_near(foot[k], uv[k], period[k]).clamp(range[k][0], range[k][1]))
        } else {
            let size = self.model.size;
            newton::descend(|uv| self.jet(face, uv), target, uv, range, range::longest(range), size).uv
        };
        let near = (0..2).all(|k| (better[k] - uv[k]).abs() <= 0.05 * (range[k][1] - range[k][0]));
        let closer =
            distance(self.surface_point(face, better), target) < distance(self.surface_point(face, uv), target);
        if near && closer { better } else { uv }
    }
}

impl Drop for OcctEvaluator<'_> {
    fn drop(&mut self) {
        let occt = std::mem::replace(&mut self.occt, UniquePtr::null());
        self.model.idle.lock().unwrap_or_else(PoisonError::into_inner).push(occt);
    }
}

/// Principal curvatures and directions of a regular point, along the unit normal `normal`.
fn principal(jet: &Jet, normal: Vec3) -> ([f64; 2], [Vec3; 2]) {
    // In the orthonormal basis e1 = Su/|Su|, e2 = n × e1: Su = a e1, Sv = b e1 + c e2.
    let a = norm(jet.du);
    let e1 = scale(jet.du, 1.0 / a);
    let e2 = cross(normal, e1);
    let (b, c) = (dot(jet.dv, e1), dot(jet.dv, e2));
    let (l, m, n) = (dot(jet.duu, normal), dot(jet.duv, normal), dot(jet.dvv, normal));
    let q = b / a;
    let (s11, s12, s22) = (l / (a * a), (m - q * l) / (a * c), (n - 2.0 * q * m + q * q * l) / (c * c));
    let (mean, half) = (0.5 * (s11 + s22), 0.5 * (s11 - s22));
    let root = half.hypot(s12);
    let angle = 0.5 * s12.atan2(half);
    let (sin, cos) = angle.sin_cos();
    let along = |x: f64, y: f64| [0, 1, 2].map(|k: usize| x * e1[k] + y * e2[k]);
    let (high, low) = ((mean + root, along(cos, sin)), (mean - root, along(-sin, cos)));
    let (first, second) = if high.0.abs() >= low.0.abs() { (high, low) } else { (low, high) };
    if first.0.is_finite() && second.0.is_finite() {
        ([first.0, second.0], [first.1, second.1])
    } else {
        ([0.0; 2], [[0.0; 3]; 2])
    }
}

impl Evaluate for OcctEvaluator<'_> {
    fn edge_frame(&mut self, edge: u32, t: f64) -> CurveFrame {
        if let Some(point) = self.degenerate_point(edge) {
            return CurveFrame { point, d1: [0.0; 3], d2: [0.0; 3] };
        }
        let entity = &self.model.topology.edges[edge as usize];
        let (t, _) = place(t, entity.range, entity.period);
        self.curve(edge, t)
    }

    fn face_frame(&mut self, face: u32, uv: [f64; 2]) -> SurfaceFrame {
        let (uv, _) = self.placed(face, uv);
        let jet = self.jet(face, uv);
        let normal = match self.regular_normal(face, &jet) {
            Some(normal) => self.outward(face, normal),
            None => {
                let normal = self.normal(face, uv, &jet);
                let normal = self.outward(face, normal);
                let (curvatures, directions) = ([0.0; 2], [[0.0; 3]; 2]);
                return SurfaceFrame { point: jet.point, du: jet.du, dv: jet.dv, normal, curvatures, directions };
            }
        };
        let (curvatures, directions) = principal(&jet, normal);
        SurfaceFrame { point: jet.point, du: jet.du, dv: jet.dv, normal, curvatures, directions }
    }

    fn face_normal(&mut self, face: u32, uv: [f64; 2]) -> Vec3 {
        let (uv, _) = self.placed(face, uv);
        let jet = match self.model.surfaces[face as usize].form.tangents(uv) {
            Some(jet) => jet,
            None => self.jet_by_occt(face, uv),
        };
        let normal = self.normal(face, uv, &jet);
        self.outward(face, normal)
    }

    fn edge_on_face(&mut self, edge: u32, t: f64, face: u32) -> Option<[f64; 2]> {
        let topology = &self.model.topology;
        let entity = &topology.edges[edge as usize];
        if !entity.faces.contains(&face) {
            return None;
        }
        let (t, _) = place(t, entity.range, entity.period);
        let uv = self.pcurve(edge, face, t, true).or_else(|| self.pcurve(edge, face, t, false))?;
        let uv = [0, 1].map(|k: usize| {
            let entity = &topology.faces[face as usize];
            let [low, high] = entity.range[k];
            bring_near(uv[k], 0.5 * (low + high), entity.period[k].filter(|_| uv[k] < low || uv[k] > high))
                .clamp(low, high)
        });
        if entity.degenerate {
            return Some(uv);
        }
        let target = self.curve(edge, t).point;
        Some(self.refined(face, uv, target))
    }

    fn closest_on_edge(&mut self, edge: u32, point: Vec3, guess: Option<f64>) -> OnCurve {
        project_edges::on_edge(self, edge, point, guess)
    }

    fn closest_on_face(&mut self, face: u32, point: Vec3, guess: Option<[f64; 2]>) -> OnSurface {
        project::on_face(self, face, point, guess)
    }

    fn closest_on_face_within(&mut self, face: u32, point: Vec3, limit: f64) -> Option<OnSurface> {
        project::on_face_within(self, face, point, None, limit)
    }

    fn closest_on_edge_within(&mut self, edge: u32, point: Vec3, limit: f64) -> Option<OnCurve> {
        project_edges::on_edge_within(self, edge, point, None, limit)
    }

    fn closest_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        project::on_surface(self, face, point, guess)
    }

    fn foot_on_surface(&mut self, face: u32, point: Vec3, guess: [f64; 2]) -> OnSurface {
        project::foot(self, face, point, guess)
    }
}
