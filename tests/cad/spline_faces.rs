//! Closest points on spline faces whose distances are known otherwise: a torus and a sphere as rational splines, with
//! seams and poles, and a blade whose sides are close to each other.

use crate::common::models::{Random, data};
use geo_adapt::geometry::{Evaluate, Geometry, OcctModel, SurfaceKind};
use geo_adapt::mesh::vector::{Vec3, add, cross, distance, dot, norm, scale, sub, unit};

/// Agreement with the formulas, model units (sizes are about 1, coordinates up to 10).
const SMALL: f64 = 1e-11;

/// Distance from nurbs-torus.brep (tests/data/make_splines.cpp).
fn from_torus(p: Vec3) -> f64 {
    let arm = sub(p, [5.3, 5.8, 7.1]);
    let height = dot(arm, unit([1.0, 2.0, 3.0]));
    let radius = (dot(arm, arm) - height * height).max(0.0).sqrt();
    ((radius - 1.0).hypot(height) - 0.3).abs()
}

/// Distance from nurbs-sphere.brep.
fn from_sphere(p: Vec3) -> f64 {
    (distance(p, [0.2, -0.3, 0.1]) - 0.7).abs()
}

fn check(name: &str, distance_from: fn(Vec3) -> f64) {
    let model = OcctModel::read(&data(name)).unwrap();
    let mut on = model.evaluator();
    let face = &model.topology().faces[0];
    assert_eq!((face.kind, model.topology().faces.len()), (SurfaceKind::BSpline, 1), "{name}");
    let mut random = Random(31);
    for k in 0..3000 {
        let point = random.within(face.bounds, [0.0, 0.3, 3.0][k % 3]);
        // From nowhere, from anywhere, from the ends of the range.
        let guess = match k % 4 {
            0 => None,
            1 => Some([face.range[0][k / 4 % 2], face.range[1][k / 8 % 2]]),
            _ => Some(face.range.map(|range| random.between(range))),
        };
        let found = on.closest_on_face(0, point, guess);
        let expected = distance_from(point);
        let what = format!("{name} {point:?} from {guess:?}: {found:?}, {expected} away");
        assert!((found.distance - expected).abs() <= SMALL, "{what}");
        assert!(distance(on.face_frame(0, found.uv).point, found.point) <= SMALL, "{what}");
    }
}

#[test]
fn a_torus_is_as_far_as_its_formula_says_from_any_guess() {
    check("nurbs-torus.brep", from_torus);
}

#[test]
fn a_sphere_is_as_far_as_its_formula_says_from_any_guess() {
    check("nurbs-sphere.brep", from_sphere);
}

/// A guess beyond the seam is a near one.
#[test]
fn a_foot_across_the_seam_is_found() {
    for (name, distance_from) in
        [("nurbs-torus.brep", from_torus as fn(Vec3) -> f64), ("nurbs-sphere.brep", from_sphere)]
    {
        let model = OcctModel::read(&data(name)).unwrap();
        let mut on = model.evaluator();
        let face = &model.topology().faces[0];
        let [low, high] = face.range[0];
        let mut random = Random(32);
        let mut crossed = 0;
        for _ in 0..500 {
            let v = face.range[1][0] + (face.range[1][1] - face.range[1][0]) * random.between([0.1, 0.9]);
            let step = 0.01 * (high - low) * random.next();
            let frame = on.face_frame(0, [low + step, v]);
            let point = add(frame.point, scale(frame.normal, random.between([-0.1, 0.1])));
            let guess = [high - 0.01 * (high - low) * random.next(), v];
            let found = on.closest_on_surface(0, point, guess);
            let what = format!("{name} {point:?} from {guess:?}: {found:?}");
            assert!((found.distance - distance_from(point)).abs() <= SMALL, "{what}");
            crossed += usize::from((found.uv[0] - low - step).abs() < 1e-9);
        }
        assert!(crossed > 450, "{name}: {crossed} of 500 feet are where they were taken off");
    }
}

/// At a pole S_u vanishes, and every u is as good.
#[test]
fn points_at_the_poles_find_them() {
    let model = OcctModel::read(&data("nurbs-sphere.brep")).unwrap();
    let mut on = model.evaluator();
    let range = model.topology().faces[0].range;
    let mut random = Random(33);
    for end in range[1] {
        let pole = on.face_frame(0, [range[0][0], end]);
        assert!((norm(pole.normal) - 1.0).abs() < 1e-9, "a pole has a normal: {pole:?}");
        for k in 0..200 {
            let side = unit(cross(pole.normal, [0.3, -0.5, random.next()]));
            let aside = [0.0, 1e-9, 1e-5, 1e-2][k % 4];
            let point = add(pole.point, add(scale(pole.normal, random.between([-0.3, 0.5])), scale(side, aside)));
            let guess = range.map(|range| random.between(range));
            for guess in [None, Some(guess), Some([guess[0], end])] {
                let found = on.closest_on_face(0, point, guess);
                let off = (found.distance - from_sphere(point)).abs();
                assert!(off <= SMALL, "{point:?} from {guess:?}: {found:?} is off by {off:e}");
            }
        }
    }
}

/// Where a blade is thin, the other side is close; at its sharp end the curvature is high. Nothing that a fine
/// sampling finds may be closer.
#[test]
fn no_sample_of_a_blade_is_closer() {
    const ALONG: usize = 400;
    let model = OcctModel::read(&data("blade.brep")).unwrap();
    let mut on = model.evaluator();
    let faces = (0..).zip(&model.topology().faces);
    let (index, face) = faces.into_iter().find(|(_, face)| face.kind == SurfaceKind::Extrusion).expect("its side");
    let at =
        |k: usize, i: usize, n: usize| face.range[k][0] + (face.range[k][1] - face.range[k][0]) * i as f64 / n as f64;
    let samples: Vec<Vec3> = (0..=ALONG)
        .flat_map(|i| (0..=20).map(move |j| (i, j)))
        .map(|(i, j)| on.face_frame(index, [at(0, i, ALONG), at(1, j, 20)]).point)
        .collect();
    let mut random = Random(34);
    for k in 0..2000 {
        let point = random.within(face.bounds, [0.0, 0.1, 1.0][k % 3]);
        let guess = (k % 5 > 0).then(|| face.range.map(|range| random.between(range)));
        let found = on.closest_on_face(index, point, guess);
        let nearest = samples.iter().map(|&sample| distance(sample, point)).fold(f64::INFINITY, f64::min);
        assert!(found.distance <= nearest + SMALL, "{point:?} from {guess:?}: {found:?}, a sample is {nearest} away");
    }
}
