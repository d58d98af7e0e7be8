//! Surfaces, curves and p-curves evaluated from their copies, against OpenCASCADE's own evaluation.
#![cfg(feature = "occt")]
mod support;

use geo_adapt::geometry::{CurveKind, Evaluate, Geometry, OcctModel, SurfaceKind};
use geo_adapt::mesh::vector::{Vec3, distance, norm};
use support::{Random, models};

/// Random parameters of each face, edge and p-curve.
const POINTS: usize = 200;
/// Agreement of the points, relative to the model's size.
const ROUNDING: f64 = 1e-13;

/// The greatest distance between pairs of vectors, relative to the greatest of the vectors.
fn off(pairs: &[(Vec3, Vec3)]) -> f64 {
    let size = pairs.iter().map(|(a, _)| norm(*a)).fold(0.0, f64::max);
    let off = pairs.iter().map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / size }
}

#[test]
fn surfaces_have_the_derivatives_that_occt_has() {
    let mut splines = 0;
    for path in models() {
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut random = Random(11);
        for (i, face) in (0..).zip(&model.topology().faces) {
            assert!(!model.is_on_bridge(i), "{} face {} {:?} has no copy", path.display(), i + 1, face.kind);
            splines += usize::from(face.kind == SurfaceKind::BSpline);
            let mut pairs = [const { Vec::new() }; 6];
            for _ in 0..POINTS {
                let uv = face.range.map(|range| random.between(range));
                let all = on.reference_surface(i, uv).into_iter().zip(on.surface_derivatives(i, uv));
                pairs.iter_mut().zip(all).for_each(|(pairs, pair)| pairs.push(pair));
            }
            let off = pairs.map(|pairs| off(&pairs));
            eprintln!("{} face {} {:?}: {off:?}", path.display(), i + 1, face.kind);
            assert!(off.iter().all(|&off| off <= ROUNDING), "{} face {}: {off:?}", path.display(), i + 1);
        }
    }
    assert!(splines >= 6, "the spline models are gone: {splines}");
}

#[test]
fn curves_have_the_derivatives_that_occt_has() {
    let mut splines = 0;
    for path in models() {
        let model = OcctModel::read(&path).unwrap();
        let mut on = model.evaluator();
        let mut random = Random(12);
        for (i, edge) in (0..).zip(&model.topology().edges).filter(|(_, edge)| !edge.degenerate) {
            splines += usize::from(edge.kind == CurveKind::BSpline);
            let mut pairs = [const { Vec::new() }; 3];
            for _ in 0..POINTS {
                let t = random.between(edge.range);
                let ours = on.edge_frame(i, t);
                let all = on.reference_curve(i, t).into_iter().zip([ours.point, ours.d1, ours.d2]);
                pairs.iter_mut().zip(all).for_each(|(pairs, pair)| pairs.push(pair));
            }
            let off = pairs.map(|pairs| off(&pairs));
            eprintln!("{} edge {} {:?}: {off:?}", path.display(), i + 1, edge.kind);
            assert!(off.iter().all(|&off| off <= ROUNDING), "{} edge {}: {off:?}", path.display(), i + 1);
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
