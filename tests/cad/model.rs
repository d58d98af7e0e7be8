//! What a CAD model holds, as `geo-adapt model` and the library tell it, and what a bad file gets.

use crate::common::models::data;
use crate::common::shared_case;
use geo_adapt::geometry::{CurveKind, Evaluate, Geometry, OcctModel, SurfaceKind};
use geo_adapt::mesh::vector::{Vec3, distance, dot, norm, sub};
use std::path::Path;
use std::process::{Command, Output};

fn program(arguments: &[&str], file: &Path) -> Output {
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
fn listing(file: &Path) -> serde_json::Value {
    let output = program(&["--json"], file);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn vector(value: &serde_json::Value) -> Vec3 {
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

/// The program in a folder; what it prints.
fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_geo-adapt")).current_dir(folder).args(arguments).output().unwrap()
}

#[test]
fn faces_are_named_beside_the_model_and_keep_their_names() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data("block-inches.igs"), folder.path().join("a.igs")).unwrap();
    let json = listing(&folder.path().join("a.igs"));
    let top = json["faces"].as_array().unwrap().iter().find(|face| vector(&face["normal"])[2] > 0.5).unwrap();
    let top = top["number"].as_u64().unwrap();
    let others: Vec<u64> = (1..=6).filter(|number| *number != top).collect();
    let inlet = format!("inlet={},{}", others[0], others[1]);
    let done = run_in(folder.path(), &["model", "a.igs", "--name", &inlet, "--name", "lid=near:0.5,1,3.5"]);
    let text = String::from_utf8(done.stdout).unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(text.contains(&format!("lid: face {top}\n")) && text.contains("a.igs.names.json"), "{text}");
    let named = |number: u64| {
        let json = listing(&folder.path().join("a.igs"));
        json["faces"][number as usize - 1]["name"].clone()
    };
    assert_eq!(
        (named(top), named(others[1]), named(others[2])),
        ("lid".into(), "inlet".into(), serde_json::Value::Null)
    );
    // Another name is added to those that are there; a mesh of the model has them all.
    let outlet = format!("outlet={}", others[2]);
    assert_eq!(run_in(folder.path(), &["model", "a.igs", "--name", &outlet]).status.code(), Some(0));
    assert_eq!((named(top), named(others[2])), ("lid".into(), "outlet".into()));
    let made = run_in(folder.path(), &["bootstrap", "a.igs", "-o", "a.meshb", "-q"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let names = std::fs::read_to_string(folder.path().join("a.names.json")).unwrap();
    let names: serde_json::Value = serde_json::from_str(&names).unwrap();
    assert_eq!(names["triangles"][top.to_string()]["name"], "lid");
    // And the space around it too, whose faces have other numbers.
    let far = ["bootstrap", "a.igs", "-o", "far.meshb", "--far-field", "box:1", "-q"];
    assert_eq!(run_in(folder.path(), &far).status.code(), Some(0));
    let domain = listing(&folder.path().join("far.brep"));
    let lid = domain["faces"].as_array().unwrap().iter().find(|face| face["name"] == "lid").unwrap();
    assert!((vector(&lid["centre"])[2] - 3.0).abs() < 1e-6 && lid["number"] != top, "{lid}");
}

#[test]
fn names_that_fit_no_face_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data("block-inches.igs"), folder.path().join("a.igs")).unwrap();
    let refusal = |arguments: &[&str]| {
        let output = run_in(folder.path(), &[&["model", "a.igs"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        message
    };
    assert!(refusal(&["--name", "inlet=7"]).contains("a.igs: --name inlet: there is no face 7; the faces are 1 to 6"));
    assert!(refusal(&["--name", "inlet=0"]).contains("there is no face 0"));
    assert!(refusal(&["--name", "a=1", "--name", "b=2,1"]).contains("face 1 would be a and b"));
    assert!(refusal(&["--name", "a=near:0,1,3"]).contains("equally near"));
    for wrong in ["a", "a=", "=1", "a=x", "a=near:1,2", "a=near:1,2,inf"] {
        assert!(refusal(&["--name", wrong]).contains("inlet=3,7"), "{wrong}");
    }
    assert!(!folder.path().join("a.igs.names.json").exists());
    // The names file may be another name of the model: that is never written over.
    std::fs::hard_link(folder.path().join("a.igs"), folder.path().join("a.igs.names.json")).unwrap();
    assert!(refusal(&["--name", "inlet=1"]).contains("would be overwritten"));
    std::fs::remove_file(folder.path().join("a.igs.names.json")).unwrap();
    std::fs::write(folder.path().join("a.igs.names.json"), r#"{"triangles": {"9": {"name": "lid"}}}"#).unwrap();
    let message = refusal(&[]);
    assert!(message.contains("a.igs.names.json: names face 9, but a.igs has 6"), "{message}");
}

#[test]
fn a_model_in_other_units_keeps_its_numbers_and_names() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| folder.path().join(name);
    // Planes and a cylinder; a cone with its apex; a torus alone; splines; names and colours of its own.
    for name in ["capped-cylinder.step", "cone-apex.brep", "torus.brep", "block-inches.igs", "cadquery-names.step"] {
        std::fs::copy(data(name), here(name)).unwrap();
        let bytes = std::fs::read(here(name)).unwrap();
        let named = run_in(folder.path(), &["model", name, "--name", "first=1"]);
        assert_eq!(named.status.code(), Some(0), "{}", String::from_utf8_lossy(&named.stderr));
        let made =
            run_in(folder.path(), &["model", name, "--scale", "0.001", "--translate", "1,-2,0.5", "-o", "m.brep"]);
        assert_eq!(made.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&made.stderr));
        assert!(String::from_utf8_lossy(&made.stdout).contains("m.brep"), "{name}");
        assert_eq!(std::fs::read(here(name)).unwrap(), bytes, "{name}");
        let (before, after) = (listing(&here(name)), listing(&here("m.brep")));
        assert_eq!((&before["names"], &before["solids"]), (&after["names"], &after["solids"]), "{name}");
        let close = |a: f64, b: f64| assert!((a - b).abs() <= 1e-9 * b.abs() + 1e-12, "{name}: {a} {b}");
        let number = |value: &serde_json::Value| value.as_f64().unwrap_or(f64::NAN);
        let moved = |a: Vec3, b: Vec3| {
            let expected = [0, 1, 2].map(|i: usize| 1e-3 * b[i] + [1.0, -2.0, 0.5][i]);
            assert!(distance(a, expected) < 1e-9, "{name}: {a:?} {expected:?}");
        };
        let both = |key: &str| {
            let [a, b] = [&after, &before].map(|json| json[key].as_array().unwrap().clone());
            assert_eq!(a.len(), b.len(), "{name}: {key}");
            a.into_iter().zip(b)
        };
        for (a, b) in both("faces") {
            for key in ["kind", "name", "colour", "neighbours", "edges"] {
                assert_eq!(a[key], b[key], "{name}: {key}");
            }
            close(number(&a["area"]), 1e-6 * number(&b["area"]));
            moved(vector(&a["centre"]), vector(&b["centre"]));
            if a["closed"] == false {
                assert!(distance(vector(&a["normal"]), vector(&b["normal"])) < 1e-6, "{name}: {a} {b}");
            }
        }
        for (a, b) in both("edges") {
            for key in ["kind", "vertices", "faces", "seam", "degenerate"] {
                assert_eq!(a[key], b[key], "{name}: {key}");
            }
            if b["degenerate"] == false {
                close(number(&a["length"]), 1e-3 * number(&b["length"]));
            }
        }
        for (a, b) in both("vertices") {
            moved(vector(&a["point"]), vector(&b["point"]));
        }
    }
    // Other commands take it.
    let made = run_in(folder.path(), &["bootstrap", "m.brep", "-o", "m.vtu", "--no-adapt", "-q"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
}

#[test]
fn what_no_model_can_be_scaled_by_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data("capped-cylinder.step"), folder.path().join("a.step")).unwrap();
    let refusal = |arguments: &[&str]| {
        let output = run_in(folder.path(), &[&["model", "a.step"], arguments].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        message
    };
    for wrong in ["0", "-1", "inf", "a"] {
        assert!(refusal(&["--scale", wrong, "-o", "b.brep"]).contains("positive"), "{wrong}");
    }
    assert!(refusal(&["--translate", "1,2", "-o", "b.brep"]).contains("0,0,1.5"));
    assert!(refusal(&["--scale", "2", "-o", "b.step"]).contains("must end in .brep"));
    assert!(refusal(&["--scale", "2"]).contains("--output"));
    // A thousandth of the length within which OpenCASCADE takes points for one.
    assert!(refusal(&["--scale", "1e-10", "-o", "b.brep"]).contains("a scale nearer to 1"));
    assert!(!folder.path().join("b.brep").exists());
}

#[test]
fn names_beside_a_brep_may_be_those_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(data("duct.brep"), folder.path().join("a.brep")).unwrap();
    let names = r#"{"triangles": {"2": {"name": "inlet"}, "70": {"name": "of a mesh"}}, "tetrahedra": {"9": {"name": "steel"}}}"#;
    std::fs::write(folder.path().join("a.names.json"), names).unwrap();
    let json = listing(&folder.path().join("a.brep"));
    assert_eq!(json["faces"][1]["name"], "inlet");
    assert_eq!(json["names"]["triangles"].as_object().unwrap().len(), 1);
    // A name that is given to the model leaves the mesh's file as it is.
    assert_eq!(run_in(folder.path(), &["model", "a.brep", "--name", "wall=1"]).status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(folder.path().join("a.names.json")).unwrap(), names);
    let json = listing(&folder.path().join("a.brep"));
    assert_eq!((&json["faces"][0]["name"], &json["faces"][1]["name"]), (&"wall".into(), &"inlet".into()));
}

#[test]
fn names_and_colours_of_cadquery_are_read() {
    // tests/data/cadquery_names.py
    let json = listing(&data("cadquery-names.step"));
    let faces = json["faces"].as_array().unwrap();
    let looks = |axis: usize, sign: f64| {
        faces.iter().find(|face| face["closed"] == false && sign * vector(&face["normal"])[axis] > 0.9).unwrap()
    };
    assert_eq!((&looks(0, -1.0)["name"], &looks(0, -1.0)["colour"]), (&"inlet".into(), &"#FF0000".into()));
    assert_eq!(looks(0, 1.0)["name"], "outlet");
    assert_eq!(looks(1, -1.0)["colour"], "#00FF00");
    assert_eq!(json["names"]["tetrahedra"]["1"]["name"], "body");
}

/// Bad input: exit 2, one message that names the file and holds `part`, and nothing else.
fn refused(path: &Path, part: &str) {
    let output = program(&[], path);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{}: {message}", path.display());
    assert!(output.stdout.is_empty(), "{}", path.display());
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with("geo-adapt: error: ") && message.contains(path.to_str().unwrap()), "{message}");
    assert!(message.contains(part), "{part:?} is not in {message}");
}

#[test]
fn files_that_are_no_model_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path
    };
    for kind in ["step", "igs", "brep", "egads"] {
        refused(&file(&format!("empty.{kind}"), b""), "empty");
        refused(&file(&format!("text.{kind}"), b"A shopping list:\nmilk, bread\n"), "this is no");
        refused(&file(&format!("picture.{kind}"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x01\0"), "this is no");
        refused(&folder.path().join(format!("missing.{kind}")), "No such file");
    }
    refused(&file("mesh.stl", b"solid"), ".step");
    refused(&file("model", b"solid"), ".step");
    std::fs::create_dir(folder.path().join("folder.step")).unwrap();
    refused(&folder.path().join("folder.step"), "is a folder");
    let empty = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
                 FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
    refused(&file("nothing.step", empty.as_bytes()), "no shape");
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
fn cut_and_damaged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["capped-cylinder.step", "block-inches.igs", "duct.brep", "torus.brep"] {
        let whole = std::fs::read(data(name)).unwrap();
        let path = folder.path().join(name);
        for share in [0.2, 0.5, 0.8, 0.97] {
            std::fs::write(&path, &whole[..(share * whole.len() as f64) as usize]).unwrap();
            refused(&path, "again");
        }
    }
    // A reference to nothing, where OCCT's reader would follow a null pointer.
    let text = std::fs::read_to_string(data("capped-cylinder.step")).unwrap();
    let place = text.find("= LINE(").unwrap();
    let damaged = text[..place].to_string() + &text[place..].replacen(",#", ",#9", 1);
    let path = folder.path().join("damaged.step");
    std::fs::write(&path, damaged).unwrap();
    refused(&path, "damaged");
}

#[test]
fn a_model_without_faces_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wire.brep");
    // One vertex, by hand.
    let text = "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nLocations 0\nCurve2ds 0\nCurves 0\n\
                Polygon3D 0\nPolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\n\nTShapes 1\nVe\n1e-07\n0 0 0\n\
                0 0\n\n0101101\n*\n\n+1 0 \n";
    std::fs::write(&path, text).unwrap();
    refused(&path, "no faces");
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
