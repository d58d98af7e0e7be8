//! `geo-adapt metric multiscale`, and `geo-adapt adapt --field`, as a user runs them.

use crate::common::adapting::{Workplace, stderr, text};
use crate::common::program;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::mesh::{TetMesh, io};
use geo_adapt::metric::{Field, field};
use geo_adapt::tasks::Team;
use io::{FieldKind, Solution, SolutionField};
use serde_json::Value;
use std::process::Output;

/// A front at x + y/4 = ½, and something everywhere.
fn front([x, y, z]: Vec3) -> f64 {
    (30.0 * (x + 0.25 * y - 0.5)).tanh() + 0.2 * (y - z) * (y - z) + 0.1 * x * x
}

fn write(work: &Workplace, name: &str, fields: &[(FieldKind, Vec<f64>)]) -> String {
    let path = work.path(name);
    let vertices = fields[0].1.len() / fields[0].0.values();
    let fields = fields.iter().map(|(kind, values)| SolutionField { kind: *kind, values: values.clone() }).collect();
    io::write_solution(&path, &Solution { vertices, fields }).unwrap();
    text(&path)
}

fn scalar(work: &Workplace, name: &str, mesh: &TetMesh, u: impl Fn(Vec3) -> f64) -> String {
    write(work, name, &[(FieldKind::Scalar, mesh.vertices.iter().map(|&p| u(p)).collect())])
}

fn run(work: &Workplace, mesh: &str, arguments: &[&str]) -> Output {
    let output = text(&work.path("made.solb"));
    program().args(["metric", "multiscale", mesh]).args(arguments).args(["-o", &output]).output().unwrap()
}

fn made(work: &Workplace, mesh: &str, arguments: &[&str]) -> Field {
    let found = run(work, mesh, arguments);
    assert_eq!(found.status.code(), Some(0), "{}", stderr(&found));
    let vertices = io::read_mesh(mesh.as_ref()).unwrap().content.vertices.len();
    Field::read(&work.path("made.solb"), vertices).unwrap().content
}

#[test]
fn the_complexity_is_met_and_what_was_done_is_told() {
    let (work, mesh) = (Workplace::new(), cube(8));
    let path = text(&work.mesh(&mesh));
    let u = scalar(&work, "u.solb", &mesh, front);
    let report = text(&work.path("report.json"));
    for options in [
        &[][..],
        &["--norm", "1", "--hessian", "l2"],
        &["--norm", "inf", "--gradation", "1.2"],
        &["--norm", "4", "--gradation", "off", "--hmin", "0.01", "--hmax", "0.3", "--aspect-ratio", "10"],
    ] {
        let arguments = [&[&u, "--complexity", "3000", "--report", &report][..], options].concat();
        let found = made(&work, &path, &arguments);
        let complexity = field::complexity(Team::alone(), &mesh, &found.metrics);
        assert!((complexity / 3000.0 - 1.0).abs() < 0.01, "{options:?}: {complexity}");
        let told: Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        assert!((told["multiscale"]["complexity"].as_f64().unwrap() / complexity - 1.0).abs() < 1e-6);
        assert!(told["metric"]["aspect_ratio"]["greatest"].as_f64().unwrap() >= 1.0);
    }
    let found = run(&work, &path, &[&u, "--complexity", "3000", "--norm", "4"]);
    let table = String::from_utf8(found.stdout).unwrap();
    for word in ["hessian", "L^4", "gradation", "1.500", "complexity reached", "made.solb"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    assert!(run(&work, &path, &[&u, "--complexity", "3000", "-q"]).stdout.is_empty());
}

#[test]
fn the_file_is_the_same_on_any_number_of_threads() {
    let (work, mesh) = (Workplace::new(), cube(17));
    let path = text(&work.mesh(&mesh));
    let u = scalar(&work, "u.solb", &mesh, front);
    let bytes = |hessian: &str, threads: &str| {
        let found = run(&work, &path, &[&u, "--complexity", "5000", "--hessian", hessian, "--threads", threads]);
        assert_eq!(found.status.code(), Some(0), "{}", stderr(&found));
        std::fs::read(work.path("made.solb")).unwrap()
    };
    for hessian in ["fit", "l2", "jumps"] {
        let alone = bytes(hessian, "1");
        assert!(bytes(hessian, "2") == alone && bytes(hessian, "5") == alone, "{hessian}");
    }
}

#[test]
fn components_steps_and_several_fields() {
    let (work, mesh) = (Workplace::new(), cube(5));
    let path = text(&work.mesh(&mesh));
    let (a, b) = (|p: Vec3| p[0] * p[0] + 0.01 * p[1] * p[1], |p: Vec3| 3.0 * p[2] * p[2] + 0.01 * p[1] * p[1]);
    let values = |u: &dyn Fn(Vec3) -> f64| mesh.vertices.iter().map(|&p| u(p)).collect::<Vec<f64>>();
    let (first, second) = (scalar(&work, "a.solb", &mesh, a), scalar(&work, "b.solb", &mesh, b));
    let vector: Vec<f64> = mesh.vertices.iter().flat_map(|&p| [0.0, a(p), b(p)]).collect();
    let mixed = write(&work, "mixed.solb", &[(FieldKind::Scalar, values(&b)), (FieldKind::Vector, vector)]);
    let both = write(&work, "both.solb", &[(FieldKind::Scalar, values(&a)), (FieldKind::Scalar, values(&b))]);
    let wanted = ["--complexity", "300", "--gradation", "off"];
    let of = |arguments: &[&str]| made(&work, &path, &[arguments, &wanted].concat());
    // Counted through all fields: 1, then 2 3 4 of the vector.
    assert_eq!(of(&[&mixed, "--component", "3"]), of(&[&first]));
    assert_eq!(of(&[&mixed, "--component", "1"]), of(&[&second]));
    // Two scalars in a file are intersected, as two files are that are not steps.
    let intersected = of(&[&both]);
    assert_eq!(of(&[&first, &second, "--combine", "intersect"]), intersected);
    let averaged = of(&[&first, &second]);
    assert_eq!(of(&[&second, &first, "--combine", "average"]), averaged);
    let ratio = |field: &Field| field.metrics[60].0[5] / field.metrics[60].0[0];
    // Averaged: |H| is 1 and 3 halved. Intersected: each at the same complexity, so alike.
    assert!((ratio(&averaged) - 3.0).abs() < 1e-6, "{}", ratio(&averaged));
    assert!((0.5..2.0).contains(&ratio(&intersected)), "{}", ratio(&intersected));
}

#[test]
fn bad_input_is_named() {
    let (work, mesh) = (Workplace::new(), cube(3));
    let path = text(&work.mesh(&mesh));
    let u = scalar(&work, "u.solb", &mesh, front);
    let constant = scalar(&work, "constant.solb", &mesh, |_| 2.5);
    let linear = scalar(&work, "linear.solb", &mesh, |p| 1.0 + p[0] - 3.0 * p[2]);
    let few = write(&work, "few.solb", &[(FieldKind::Scalar, vec![1.0; 7])]);
    let vector = write(&work, "vector.solb", &[(FieldKind::Vector, vec![1.0; 3 * 64])]);
    let nan = text(&work.path("nan.sol"));
    let lines: Vec<String> = (0..64).map(|v| if v == 16 { "nan".into() } else { format!("{}", v * v) }).collect();
    std::fs::write(
        &nan,
        format!("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n64\n1 1\n{}\nEnd\n", lines.join("\n")),
    )
    .unwrap();
    let wanted = ["--complexity", "300"];
    let cases: [(&[&str], &[&str]); 11] = [
        (&[&constant], &["constant.solb", "constant or linear"]),
        (&[&linear], &["linear.solb", "constant or linear"]),
        (&[&few], &["few.solb", "7 vertices", "64"]),
        (&[&vector], &["vector.solb", "--component"]),
        (&[&vector, "--component", "4"], &["vector.solb", "3 values"]),
        (&[&nan], &["nan.sol", "SolAtVertices 17 of 64", "finite number"]),
        (&[&u, "--hmin", "0.3"], &["300", "cannot be reached", "--hmin"]),
        (&[&u, "--hmin", "0.3", "--hmax", "0.2"], &["--hmin"]),
        (&[&u, "--norm", "0.5"], &["--norm"]),
        (&[&u, "--gradation", "0.9"], &["--gradation", "above 1"]),
        (&["nowhere.solb"], &["nowhere.solb"]),
    ];
    for (arguments, words) in cases {
        let found = run(&work, &path, &[arguments, &wanted].concat());
        assert_eq!(found.status.code(), Some(2), "{arguments:?}");
        let message = stderr(&found);
        assert!(words.iter().all(|word| message.contains(word)), "{arguments:?}: {message}");
        assert!(!message.contains("panicked") && !work.path("made.solb").exists(), "{message}");
    }
    let found = run(&work, &path, &[&u, &constant, "--combine", "intersect", "--complexity", "300"]);
    assert!(stderr(&found).contains("constant.solb: the field is constant"), "{}", stderr(&found));
}

#[test]
fn adapt_makes_the_metric_itself() {
    let (work, mesh) = (Workplace::new(), cube(6));
    let path = work.mesh(&mesh);
    let u = scalar(&work, "u.solb", &mesh, front);
    let found = work.adapt(&path, &["--field", &u, "--complexity", "600", "--norm", "4", "--hmax", "0.5"]);
    let made = &found.report["multiscale"];
    assert_eq!((made["norm"].as_f64(), made["hessian"].as_str()), (Some(4.0), Some("fit")));
    assert!((made["complexity"].as_f64().unwrap() / 600.0 - 1.0).abs() < 0.01);
    let vertices = found.mesh.vertices.len();
    assert!((900..1800).contains(&vertices), "{vertices}");
    let refused = |arguments: &[&str], word: &str| {
        let run = work.command(&path, arguments).output().unwrap();
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&run).contains(word), "{arguments:?}: {}", stderr(&run));
    };
    refused(&["--field", &u], "--complexity");
    refused(&["--analytic", "linear", "--norm", "4"], "--field");
    refused(&["--analytic", "linear", "--gradation", "2"], "--field");
    refused(&["--field", &u, "--analytic", "linear", "--complexity", "100"], "--analytic");
}
