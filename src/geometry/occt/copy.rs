//! Copying of curves and surfaces out of OCCT, once, when a model is loaded. A copy is used only where it has the
//! points that OCCT has.
use super::bridge::ffi;
use super::curve::Curve;
use super::spline::SplineSurface;
use super::surface::Surface;
use super::swept::Swept;
use crate::geometry::{CurveFrame, Topology};
use crate::mesh::vector::{distance, norm};
use cxx::{Exception, SharedPtr, UniquePtr};

/// A copy that differs from OCCT by more than this, relative to the model's size, is not used. A scaled location, for one, changes the
/// parameters of a line.
const AGREEMENT: f64 = 1e-13;
/// Shares of a range at which a copy is compared.
const SHARES: [f64; 5] = [0.0, 0.31, 0.52, 0.77, 1.0];

/// An edge's curve in the parameters of a face.
pub struct PCurve {
    /// The face.
    pub face: u32,
    /// The curve, its third coordinate 0; without a copy it is general.
    pub curve: Curve,
    /// The second curve of a seam.
    pub other: Option<Curve>,
}

/// An edge's curve.
pub fn curve(
    occt: &SharedPtr<ffi::Model>,
    evaluator: &mut UniquePtr<ffi::Evaluator>,
    edge: u32,
    record: &ffi::EdgeRecord,
    size: f64,
) -> Result<Curve, Exception> {
    if record.degenerate {
        return Ok(Curve::General);
    }
    let closed = if record.kind <= 1 {
        Some(Curve::new(record.kind, &evaluator.pin_mut().curve_form(edge)?))
    } else {
        Curve::copied(&ffi::curve_spline(occt, edge)?)
    };
    let Some(curve) = closed else { return Ok(Curve::General) };
    for s in SHARES {
        let t = record.range[0] * (1.0 - s) + record.range[1] * s;
        let mut out = [0.0; 9];
        evaluator.pin_mut().curve_d2(edge, t, &mut out)?;
        let slope = [out[3], out[4], out[5]];
        let agrees = |frame: CurveFrame| {
            distance(frame.point, [out[0], out[1], out[2]]) <= AGREEMENT * size
                && (s != 0.52 || distance(frame.d1, slope) <= 1e3 * AGREEMENT * (size + norm(slope)))
        };
        if !curve.frame(t).is_some_and(agrees) {
            return Ok(Curve::General);
        }
    }
    Ok(curve)
}

/// A face's surface.
pub fn surface(
    occt: &SharedPtr<ffi::Model>,
    evaluator: &mut UniquePtr<ffi::Evaluator>,
    face: u32,
    record: &ffi::FaceRecord,
    size: f64,
) -> Result<Surface, Exception> {
    let surface = if record.kind <= 4 {
        Surface::new(record.kind, &evaluator.pin_mut().surface_form(face)?)
    } else {
        let record = ffi::surface_spline(occt, face)?;
        match record.kind {
            1 => SplineSurface::new(&record).map_or(Surface::General, |spline| Surface::Spline(Box::new(spline))),
            6 | 7 => Swept::new(&record, &ffi::surface_generatrix(occt, face)?)
                .map_or(Surface::General, |swept| Surface::Swept(Box::new(swept))),
            _ => Surface::General,
        }
    };
    let [u0, u1, v0, v1] = record.range;
    for (s, r) in SHARES.into_iter().zip([0.0, 0.77, 0.52, 1.0, 0.31]) {
        let uv = [u0 * (1.0 - s) + u1 * s, v0 * (1.0 - r) + v1 * r];
        let mut out = [0.0; 3];
        evaluator.pin_mut().surface_d0(face, uv[0], uv[1], &mut out)?;
        if !surface.jet(uv).is_some_and(|jet| distance(jet.point, out) <= AGREEMENT * size) {
            return Ok(Surface::General);
        }
    }
    Ok(surface)
}

/// The p-curves of all edges.
pub fn pcurves(
    occt: &SharedPtr<ffi::Model>,
    evaluator: &mut UniquePtr<ffi::Evaluator>,
    topology: &Topology,
) -> Result<Vec<Vec<PCurve>>, Exception> {
    let mut all = Vec::with_capacity(topology.edges.len());
    for (edge, entity) in (0..).zip(&topology.edges) {
        let mut some = Vec::with_capacity(entity.faces.len());
        for &face in &entity.faces {
            let copy = Curve::copied(&ffi::pcurve_spline(occt, edge, face, false)?);
            let other = if entity.seam { Curve::copied(&ffi::pcurve_spline(occt, edge, face, true)?) } else { None };
            let ranges = topology.faces[face as usize].range;
            let mut curve = copy.unwrap_or(Curve::General);
            for s in SHARES {
                let t = entity.range[0] * (1.0 - s) + entity.range[1] * s;
                let mut uv = [0.0; 2];
                let there = evaluator.pin_mut().pcurve_d0(edge, face, t, &mut uv)?;
                let near =
                    |k: usize, x: f64| (x - uv[k]).abs() <= AGREEMENT * (uv[k].abs() + ranges[k][1] - ranges[k][0]);
                if !there || !curve.frame(t).is_some_and(|frame| near(0, frame.point[0]) && near(1, frame.point[1])) {
                    curve = Curve::General;
                }
            }
            some.push(PCurve { face, curve, other });
        }
        all.push(some);
    }
    Ok(all)
}
