//! Surfaces, curves and p-curves evaluated from their copies, against OpenCASCADE's own evaluation.

use crate::common::models::{Random, models};
use geo_adapt::geometry::{CurveKind, Evaluate, Geometry, OcctModel, SurfaceKind, Topology};
use geo_adapt::mesh::vector::{Vec3, distance, norm};

/// Random parameters of each face, edge and p-curve.
const POINTS: usize = 200;
/// Agreement with OCCT, relative.
const ROUNDING: f64 = 1e-13;

/// The size of a model that rounding is measured by: its box, and how far it lies from the origin.
fn size(topology: &Topology) -> f64 {
    topology.bounds.iter().flatten().fold(topology.diagonal(), |size, x| size.max(x.abs()))
}

/// How far two values are from each other, relative to the greater of them and what they are differences of: a
/// derivative is one of points over the width of a span.
fn off((ours, theirs): (Vec3, Vec3), terms: f64) -> f64 {
    distance(ours, theirs) / norm(ours).max(terms)
}

#[test]
fn surfaces_have_the_derivatives_that_occt_has() {
    let (mut splines, mut bridged) = (0, 0);
    for path in models() {
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut random = Random(11);
        let size = size(model.topology());
        for (i, face) in (0..).zip(&model.topology().faces) {
            let what = format!("{} face {} {:?}", path.display(), i + 1, face.kind);
            assert_eq!(model.is_on_bridge(i), face.kind == SurfaceKind::Offset, "{what}");
            bridged += usize::from(model.is_on_bridge(i));
            splines += usize::from(matches!(face.kind, SurfaceKind::BSpline | SurfaceKind::Bezier));
            let mut worst = [0.0f64; 6];
            for _ in 0..POINTS {
                let uv = face.range.map(|range| random.between(range));
                let [h, k] = model.face_span(i, uv);
                let terms = [1.0, 1.0 / h, 1.0 / k, 1.0 / (h * h), 1.0 / (h * k), 1.0 / (k * k)];
                let pairs = on.surface_derivatives(i, uv).into_iter().zip(on.reference_surface(i, uv));
                for ((worst, pair), terms) in worst.iter_mut().zip(pairs).zip(terms) {
                    *worst = worst.max(off(pair, terms * size));
                }
            }
            eprintln!("{what}: {worst:?}");
            assert!(worst.iter().all(|&off| off <= ROUNDING), "{what}: {worst:?}");
        }
    }
    assert!(splines >= 6 && bridged > 0, "the spline models are gone: {splines}, {bridged}");
}

#[test]
fn curves_have_the_derivatives_that_occt_has() {
    let mut splines = 0;
    for path in models() {
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut random = Random(12);
        let size = size(model.topology());
        for (i, edge) in (0..).zip(&model.topology().edges).filter(|(_, edge)| !edge.degenerate) {
            splines += usize::from(edge.kind == CurveKind::BSpline);
            let mut worst = [0.0f64; 3];
            for _ in 0..POINTS {
                let t = random.between(edge.range);
                let h = model.edge_span(i, t);
                let ours = on.edge_frame(i, t);
                let pairs = [ours.point, ours.d1, ours.d2].into_iter().zip(on.reference_curve(i, t));
                for ((worst, pair), terms) in worst.iter_mut().zip(pairs).zip([1.0, 1.0 / h, 1.0 / (h * h)]) {
                    *worst = worst.max(off(pair, terms * size));
                }
            }
            let what = format!("{} edge {} {:?}: {worst:?}", path.display(), i + 1, edge.kind);
            eprintln!("{what}");
            assert!(worst.iter().all(|&off| off <= ROUNDING), "{what}");
        }
    }
    assert!(splines >= 6, "the spline models are gone: {splines}");
}

#[test]
fn pcurves_have_the_points_that_occt_has() {
    for path in models() {
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut random = Random(13);
        let topology = model.topology();
        for (i, edge) in (0..).zip(&topology.edges) {
            for &face in &edge.faces {
                let range = topology.faces[face as usize].range;
                for _ in 0..POINTS {
                    let t = random.between(edge.range);
                    let what = format!("{} edge {} on face {}", path.display(), i + 1, face + 1);
                    let expected = on.pcurve(i, face, t, false).expect("OCCT has a p-curve");
                    let uv = on.pcurve(i, face, t, true).unwrap_or_else(|| panic!("{what}: no copy"));
                    for k in 0..2 {
                        let size = range[k][0].abs().max(range[k][1].abs());
                        assert!((uv[k] - expected[k]).abs() <= ROUNDING * size, "{what}: {uv:?} for {expected:?}");
                    }
                }
            }
        }
    }
}
