//! Names of faces beside a model or in it, and models in other units: what `geo-adapt model` writes and reads again.

use crate::common::models::data;
use crate::model::{listing, vector};
use geo_adapt::mesh::vector::{Vec3, distance};
use std::path::Path;
use std::process::{Command, Output};

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
