//! What a CAD model holds, as `geo-adapt model` and the library tell it.

use crate::common::models::data;
use crate::common::shared_case;
use geo_adapt::geometry::{CurveKind, Evaluate, Geometry, OcctModel, SurfaceKind};
use geo_adapt::mesh::vector::{Vec3, distance, dot, norm, sub};
use std::path::Path;
use std::process::{Command, Output};

pub fn program(arguments: &[&str], file: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_geo-adapt")).arg("model").args(arguments).arg(file).output().unwrap()
}

fn counts(model: &OcctModel) -> [usize; 5] {
    let topology = model.topology();
    let degenerate = topology.edges.iter().filter(|edge| edge.degenerate).count();
    let seams = topology.edges.iter().filter(|edge| edge.seam).count();
    [topology.faces.len(), topology.edges.len(), topology.vertices.len(), degenerate, seams]
}

#[test]
fn shared_models_have_their_entities() {
    // Faces, edges, vertices, degenerate edges, seams; diagonal: FACTS.
    let cases = [
        ("cube-cylinder/cube-cylinder.step", [7, 15, 10, 0, 0], 1.73, 1e-7),
        ("cube-cylinder/cube-cylinder.egads", [7, 15, 10, 0, 0], 1.73, 3e-7),
        ("hemisphere-cylinder/hemisph-cyl.stp", [5, 14, 7, 4, 0], 245.0, 1e-5),
        ("hemisphere-cylinder/hemisph-cyl.egads", [5, 14, 7, 4, 0], 245.0, 3e-4),
        ("onera-m6/onera-m6-sharp-te.stp", [12, 25, 14, 2, 0], 300.0, 2e-5),
        ("onera-m6/onera-m6-sharp-te.egads", [12, 25, 14, 2, 0], 300.0, 2e-5),
    ];
    for (name, expected, diagonal, tolerance) in cases {
        let Some(path) = shared_case(name) else { continue };
        let model = OcctModel::read(&path).unwrap();
        assert_eq!(counts(&model), expected, "{name}");
        assert_eq!(model.topology().solids, 1, "{name}");
        assert!((model.topology().diagonal() / diagonal - 1.0).abs() < 2e-3, "{name}");
        assert!(model.topology().tolerance <= tolerance, "{name}");
    }
}

#[test]
fn the_box_of_the_cube_is_its_own() {
    let Some(path) = shared_case("cube-cylinder/cube-cylinder.step") else { return };
    let model = OcctModel::read(&path).unwrap();
    let [low, high] = model.topology().bounds;
    assert!(distance(low, [0.0; 3]) < 1e-12 && distance(high, [1.0; 3]) < 1e-12, "{low:?} {high:?}");
    let kinds: Vec<_> = model.topology().faces.iter().map(|face| face.kind).collect();
    assert_eq!(kinds.iter().filter(|&&kind| kind == SurfaceKind::Plane).count(), 6);
    assert_eq!(kinds.iter().filter(|&&kind| kind == SurfaceKind::Cylinder).count(), 1);
}

#[test]
fn own_models_have_their_entities() {
    let cases = [
        ("torus.brep", [1, 2, 1, 0, 2], 1),
        ("capped-cylinder.step", [3, 3, 2, 0, 1], 1),
        ("mirrored-cylinder.brep", [3, 3, 2, 0, 1], 1),
        ("cone-apex.brep", [4, 7, 4, 1, 0], 1),
        ("vase.brep", [1, 3, 2, 2, 1], 0),
        ("duct.brep", [6, 12, 8, 0, 0], 1),
        ("block-inches.igs", [6, 12, 8, 0, 0], 1),
    ];
    for (name, expected, solids) in cases {
        let model = OcctModel::read(&data(name)).unwrap();
        assert_eq!(counts(&model), expected, "{name}");
        assert_eq!(model.topology().solids, solids, "{name}");
        for (vertex, i) in model.topology().vertices.iter().zip(0..) {
            assert!(!vertex.edges.is_empty(), "{name}");
            for &edge in &vertex.edges {
                assert!(model.topology().edges[edge as usize].vertices.contains(&Some(i)), "{name}");
            }
        }
        for (edge, i) in model.topology().edges.iter().zip(0..) {
            assert!(edge.seam || edge.degenerate || edge.faces.len() == 2, "{name}: {edge:?}");
            assert_eq!(edge.kind == CurveKind::None, edge.degenerate, "{name}");
            for &face in &edge.faces {
                assert!(model.topology().faces[face as usize].edges.contains(&i), "{name}");
            }
        }
    }
}

#[test]
fn coordinates_are_the_numbers_of_the_file_whatever_its_unit() {
    let text = std::fs::read_to_string(data("capped-cylinder.step")).unwrap();
    let millimetre = "SI_UNIT(.MILLI.,.METRE.)";
    assert!(text.contains(millimetre));
    let folder = tempfile::tempdir().unwrap();
    let plain = OcctModel::read(&data("capped-cylinder.step")).unwrap();
    for unit in ["SI_UNIT($,.METRE.)", "SI_UNIT(.KILO.,.METRE.)", "SI_UNIT(.MICRO.,.METRE.)"] {
        let path = folder.path().join("unit.step");
        std::fs::write(&path, text.replace(millimetre, unit)).unwrap();
        let other = OcctModel::read(&path).unwrap();
        for (a, b) in plain.topology().vertices.iter().zip(&other.topology().vertices) {
            assert_eq!(a.point, b.point, "{unit}");
        }
    }
    // IGES in inches: the block is 1 by 2 by 3.
    let block = OcctModel::read(&data("block-inches.igs")).unwrap();
    let [low, high] = block.topology().bounds;
    assert!(distance(low, [0.0; 3]) < 1e-9 && distance(high, [1.0, 2.0, 3.0]) < 1e-9, "{low:?} {high:?}");
    let again = OcctModel::read(&data("capped-cylinder.step")).unwrap();
    assert_eq!(again.topology().bounds, plain.topology().bounds);
}

#[test]
fn normals_point_out_of_convex_solids() {
    for name in ["capped-cylinder.step", "mirrored-cylinder.brep", "block-inches.igs", "cone-apex.brep"] {
        let model = OcctModel::read(&data(name)).unwrap();
        let vertices = &model.topology().vertices;
        let mut on = model.evaluator();
        let inner = if name == "block-inches.igs" { [0.5, 1.0, 1.5] } else { middle_of_faces(&model) };
        assert!(!vertices.is_empty());
        for (face, i) in model.topology().faces.iter().zip(0..) {
            // An inner point of a disc, half disc or rectangle: off the middle, where an apex may be.
            let uv = face.range.map(|[low, high]| low + 0.45 * (high - low));
            let frame = on.face_frame(i, uv);
            assert!((norm(frame.normal) - 1.0).abs() < 1e-12);
            assert!(dot(frame.normal, sub(frame.point, inner)) > 0.0, "{name} face {}", i + 1);
            assert_eq!(on.face_normal(i, uv), frame.normal);
        }
    }
}

/// A point inside a convex solid: the mean of a point of each face.
fn middle_of_faces(model: &OcctModel) -> Vec3 {
    let mut on = model.evaluator();
    let faces = &model.topology().faces;
    let mut sum = [0.0; 3];
    for (face, i) in faces.iter().zip(0..) {
        let [low, high] = face.bounds;
        let middle = [0, 1, 2].map(|k: usize| 0.5 * (low[k] + high[k]));
        let point = on.closest_on_face(i, middle, None).point;
        sum = [0, 1, 2].map(|k: usize| sum[k] + point[k] / faces.len() as f64);
    }
    sum
}

#[test]
fn curvatures_are_those_of_the_shapes() {
    // Against the outward normal, so that a convex surface has negative curvatures.
    let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9;
    let torus = OcctModel::read(&data("torus.brep")).unwrap();
    let frame = torus.evaluator().face_frame(0, [0.7, 0.0]);
    assert!(close(frame.curvatures, [-1.0 / 0.3, -1.0 / 1.3]), "{frame:?}");
    let frame = torus.evaluator().face_frame(0, [0.7, std::f64::consts::PI]);
    assert!(close(frame.curvatures, [-1.0 / 0.3, 1.0 / 0.7]), "{frame:?}");
    let cylinder = OcctModel::read(&data("mirrored-cylinder.brep")).unwrap();
    let frame = cylinder.evaluator().face_frame(0, [2.0, 1.0]);
    assert!(close(frame.curvatures, [-2.0, 0.0]), "{frame:?}");
    assert!(dot(frame.directions[0], frame.directions[1]).abs() < 1e-12);
    assert!(dot(frame.directions[0], frame.normal).abs() < 1e-12);
    let edge = cylinder.evaluator().edge_frame(0, 1.0);
    assert!((edge.curvature() - 2.0).abs() < 1e-12);
    // Finite differences of the normal on a spline surface: n changes by −κ along a principal direction.
    let duct = OcctModel::read(&data("duct.brep")).unwrap();
    let mut on = duct.evaluator();
    let frame = on.face_frame(3, [3.4, 0.45]);
    for (direction, curvature) in frame.directions.iter().zip(frame.curvatures) {
        let step = 1e-5;
        let ahead = [0, 1, 2].map(|k: usize| frame.point[k] + step * direction[k]);
        let there = on.closest_on_surface(3, ahead, [3.4, 0.45]);
        let normal = on.face_normal(3, there.uv);
        let change = dot(sub(normal, frame.normal), *direction) / step;
        assert!((change + curvature).abs() < 1e-3, "{change} {curvature}");
    }
}

#[test]
fn poles_have_a_normal_and_an_apex_has_none() {
    let vase = OcctModel::read(&data("vase.brep")).unwrap();
    let mut on = vase.evaluator();
    let face = &vase.topology().faces[0];
    let bottom = on.face_frame(0, [1.0, face.range[1][0]]);
    assert!(norm(bottom.point) < 1e-12 && (norm(bottom.normal) - 1.0).abs() < 1e-9, "{bottom:?}");
    let cone = OcctModel::read(&data("cone-apex.brep")).unwrap();
    let mut on = cone.evaluator();
    let apex = on.face_frame(0, [1.0, cone.topology().faces[0].range[1][1]]);
    assert_eq!((apex.normal, apex.curvatures), ([0.0; 3], [0.0; 2]), "{apex:?}");
    let frame = on.edge_frame(0, 0.5);
    assert_eq!((frame.point, frame.d1), (cone.topology().vertices[0].point, [0.0; 3]));
}

#[test]
fn a_saved_model_is_the_same_when_it_is_read_again() {
    let place = tempfile::tempdir().unwrap();
    let saved = place.path().join("saved.bin");
    let own = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(name);
    let cases = [own("zoo/named-assembly.step"), own("zoo/three-tori.step"), own("block-on-plate.step")];
    let names = cases.iter().map(|path| OcctModel::read(path).unwrap().names().tetrahedra.len()).max();
    assert!(names.unwrap() > 1, "a case with names of solids");
    for path in cases.into_iter().chain(["mirrored-cylinder.brep", "hollow-solid.brep", "vase.brep"].map(data)) {
        let name = path.display();
        let model = OcctModel::read(&path).unwrap();
        model.save(&saved).unwrap();
        let again = OcctModel::read_saved(&saved).unwrap();
        assert_eq!(counts(&model), counts(&again), "{name}");
        assert_eq!(model.names(), again.names(), "{name}");
        assert_eq!(model.topology().solids, again.topology().solids, "{name}");
        // A location's matrix is made orthogonal again.
        let tolerance = 1e-14 * model.topology().diagonal();
        let (mut one, mut other) = (model.evaluator(), again.evaluator());
        for (i, (a, b)) in model.topology().faces.iter().zip(&again.topology().faces).enumerate() {
            assert_eq!((a.kind, &a.edges, a.reversed), (b.kind, &b.edges, b.reversed), "{name}");
            let at = a.range.map(|[low, high]| 0.3 * low + 0.7 * high);
            let [a, b] = [one.face_frame(i as u32, at), other.face_frame(i as u32, at)];
            assert!(distance(a.point, b.point) <= tolerance && distance(a.normal, b.normal) < 1e-12, "{name}");
        }
        for (a, b) in model.topology().vertices.iter().zip(&again.topology().vertices) {
            assert!(distance(a.point, b.point) <= tolerance && a.edges == b.edges, "{name}");
        }
    }
    std::fs::write(&saved, "no model").unwrap();
    assert!(OcctModel::read_saved(&saved).is_err());
    let nowhere = OcctModel::read(&data("torus.brep")).unwrap().save(&place.path().join("not/there"));
    assert!(nowhere.is_err());
}

#[test]
fn the_listing_names_what_is_there() {
    let output = program(&[], &data("vase.brep"));
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty());
    let text = String::from_utf8(output.stdout).unwrap();
    for part in ["revolution", "bezier", "seam", "degenerate", "0 solids, 1 face, 3 edges (1 seam, 2 degenerate)"] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    assert!(text.lines().any(|line| line.starts_with("diagonal") && line.ends_with("2.63392")), "{text}");
}

#[test]
fn the_json_is_the_topology() {
    let output = program(&["--json"], &data("capped-cylinder.step"));
    assert_eq!(output.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["solids"], 1);
    assert_eq!(json["faces"][0]["kind"], "cylinder");
    assert_eq!(json["edges"][1]["seam"], true);
    // All counts from 1, as the listing and meshes do.
    assert_eq!((&json["edges"][1]["number"], &json["faces"][0]["number"]), (&2.into(), &1.into()));
    assert_eq!(json["edges"][1]["faces"], serde_json::json!([1]));
    let area = json["faces"][0]["area"].as_f64().unwrap();
    assert!((area - 2.0 * std::f64::consts::PI).abs() < 1e-9);
    assert!((json["edges"][0]["length"].as_f64().unwrap() - std::f64::consts::PI).abs() < 1e-9);
}

/// The listing of a model as JSON.
pub fn listing(file: &Path) -> serde_json::Value {
    let output = program(&["--json"], file);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

pub fn vector(value: &serde_json::Value) -> Vec3 {
    [0, 1, 2].map(|i| value[i].as_f64().unwrap())
}

#[test]
fn each_face_has_its_centre_normal_box_and_neighbours() {
    // A block of 1 by 2 by 3 from the origin.
    let json = listing(&data("block-inches.igs"));
    let faces = json["faces"].as_array().unwrap();
    let middle = [0.5, 1.0, 1.5];
    for face in faces {
        let [centre, point, normal] = ["centre", "point", "normal"].map(|key| vector(&face[key]));
        let axis = (0..3).find(|&i| normal[i].abs() > 0.5).unwrap();
        let mut expected = middle;
        expected[axis] *= 1.0 + normal[axis].signum();
        assert!(distance(centre, expected) < 1e-9 && distance(point, expected) < 1e-9, "{face}");
        assert!((norm(normal) - 1.0).abs() < 1e-12 && dot(normal, sub(centre, middle)) > 0.0, "{face}");
        let bounds = [0, 1].map(|end| vector(&face["bounds"][end]));
        assert!((bounds[1][axis] - bounds[0][axis]).abs() < 1e-6, "{face}");
        // All but itself and the one opposite.
        let opposite = faces.iter().find(|other| dot(vector(&other["normal"]), normal) < -0.5).unwrap();
        let own = [&face["number"], &opposite["number"]].map(|number| number.as_u64().unwrap());
        let others: Vec<u64> = (1..=6).filter(|number| !own.contains(number)).collect();
        assert_eq!(face["neighbours"], serde_json::json!(others), "{face}");
    }
    // The side of a whole cylinder looks all round; its centre is on the axis.
    let json = listing(&data("capped-cylinder.step"));
    let side = &json["faces"][0];
    let box_of = [0, 1].map(|end| vector(&side["bounds"][end]));
    let middle = [0, 1, 2].map(|i: usize| 0.5 * (box_of[0][i] + box_of[1][i]));
    assert!(side["closed"] == true && distance(vector(&side["centre"]), middle) < 1e-6, "{side}");
    assert!((distance(vector(&side["point"]), middle) - 0.5).abs() < 1e-6, "{side}");
    let text = String::from_utf8(program(&[], &data("capped-cylinder.step")).stdout).unwrap();
    assert!(text.contains("all round") && text.contains("neighbours"), "{text}");
}

#[test]
fn the_check_tells_faces_with_flaws() {
    for name in ["duct.brep", "torus.brep", "cone-apex.brep", "capped-cylinder.step"] {
        assert_eq!(OcctModel::read(&data(name)).unwrap().flaws(), [], "{name}");
    }
    let bow = OcctModel::read(&data("faulty/bow-tie.brep")).unwrap();
    let ends: Vec<u32> = (0..6).filter(|&face| bow.topology().faces[face as usize].edges.len() == 4).collect();
    let flaws = bow.flaws();
    assert!(!flaws.is_empty() && flaws.iter().all(|(face, _)| ends.contains(face)), "{flaws:?}");
    assert!(flaws.iter().any(|(_, what)| what.contains("crosses itself")), "{flaws:?}");
}

#[test]
fn models_load_in_several_threads_at_once() {
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for name in ["capped-cylinder.step", "torus.brep", "block-inches.igs"] {
                    assert!(OcctModel::read(&data(name)).is_ok(), "{name}");
                }
            });
        }
    });
}
