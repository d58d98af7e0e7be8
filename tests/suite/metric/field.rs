//! `geo-adapt field`: functions at vertices, values picked out, and the error against a finer mesh, by files.

use crate::common::adapting::{Workplace, complaint, cube, stderr, text};
use crate::common::program;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::vector::Vec3;
use serde_json::Value;
use std::process::Output;

/// A coarse and a fine mesh of the unit cube.
struct Pair {
    work: Workplace,
    meshes: [(&'static str, TetMesh); 2],
}

impl Pair {
    fn new(coarse: u32, fine: u32) -> Self {
        let work = Workplace::new();
        let meshes = [("coarse", cube(coarse, |_| 1)), ("fine", cube(fine, |_| 1))];
        for (name, mesh) in &meshes {
            io::write_mesh(&work.path(&format!("{name}.meshb")), mesh).unwrap();
        }
        Self { work, meshes }
    }

    fn path(&self, name: &str) -> String {
        text(&self.work.path(name))
    }

    /// The same field on both.
    fn fields(&self, kind: FieldKind, at: impl Fn(Vec3) -> Vec<f64>) {
        for (name, mesh) in &self.meshes {
            let values = mesh.vertices.iter().flat_map(|&p| at(p)).collect();
            let solution = Solution { vertices: mesh.vertices.len(), fields: vec![SolutionField { kind, values }] };
            io::write_solution(&self.work.path(&format!("{name}.solb")), &solution).unwrap();
        }
    }

    fn run(&self, subcommand: &str, files: &[&str], options: &[&str]) -> Output {
        let mut command = program();
        command.args(["field", subcommand]).args(files.iter().map(|name| self.path(name)));
        command.args(options.iter().map(|word| if word.contains('.') { self.path(word) } else { (*word).into() }));
        command.output().unwrap()
    }

    /// What `field error` reports of the coarse field against the fine one.
    fn error(&self, options: &[&str]) -> Value {
        let words = [&["--truth", "fine.meshb", "fine.solb", "--report", "error.json"], options].concat();
        let run = self.run("error", &["coarse.meshb", "coarse.solb"], &words);
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        serde_json::from_slice(&std::fs::read(self.path("error.json")).unwrap()).unwrap()
    }

    fn refusal(&self, files: &[&str], options: &[&str]) -> String {
        complaint(&self.run("error", files, options))
    }
}

fn norm(report: &Value, value: usize) -> f64 {
    report["values"][value]["norm"].as_f64().unwrap()
}

#[test]
fn linear_fields_have_no_error_against_a_finer_mesh() {
    let pair = Pair::new(3, 7);
    pair.fields(FieldKind::Vector, |p| vec![1.0 + p[0], p[1] - 2.0 * p[2], 5.0]);
    let report = pair.error(&[]);
    assert_eq!(report["vertices"], serde_json::json!([64, 512]));
    assert_eq!(report["outside"], 0);
    let names: Vec<_> = report["values"].as_array().unwrap().iter().map(|v| v["component"].as_u64().unwrap()).collect();
    assert_eq!(names, [1, 2, 3]);
    assert!((0..3).all(|value| norm(&report, value) < 1e-14), "{report}");
    assert!((report["values"][2]["of_truth"].as_f64().unwrap() - 5.0).abs() < 1e-13);
}

#[test]
fn against_a_mesh_that_is_fine_enough_the_error_is_that_against_the_function() {
    let pair = Pair::new(8, 32);
    let mut exact = 0.0;
    for name in ["coarse", "fine"] {
        let files = [format!("{name}.meshb")];
        let run = pair.run(
            "evaluate",
            &[&files[0]],
            &["--function", "sinfun3", "-o", &format!("{name}.solb"), "--report", "f.json"],
        );
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        if name == "coarse" {
            let report: Value = serde_json::from_slice(&std::fs::read(pair.path("f.json")).unwrap()).unwrap();
            exact = report["error"].as_f64().unwrap();
        }
    }
    let found = norm(&pair.error(&[]), 0);
    // The truth's own error is a sixteenth of the other.
    assert!((found / exact - 1.0).abs() < 0.08, "{found} for {exact}");
    let most = norm(&pair.error(&["--norm", "inf"]), 0);
    let greatest = pair.error(&["--norm", "1"])["values"][0]["greatest"].as_f64().unwrap();
    assert!(most > 2.0 * found && most == greatest, "{most} {greatest}");
    let bytes: Vec<_> = ["1", "2", "3"]
        .iter()
        .map(|threads| {
            pair.error(&["--threads", threads]);
            std::fs::read(pair.path("error.json")).unwrap()
        })
        .collect();
    assert!(bytes.iter().all(|one| *one == bytes[0]), "the same on any number of threads");
}

#[test]
fn what_does_not_fit_is_told() {
    let pair = Pair::new(2, 3);
    pair.fields(FieldKind::Scalar, |p| vec![p[0]]);
    let truth = ["--truth", "fine.meshb", "fine.solb"];
    let told = pair.refusal(&["coarse.meshb", "fine.solb"], &truth);
    assert!(told.contains("fine.solb: values at 64 vertices, but ") && told.contains("coarse.meshb has 27"), "{told}");
    let told = pair.refusal(&["coarse.meshb", "coarse.solb"], &["--truth", "fine.meshb", "none.solb"]);
    assert!(told.contains("none.solb"), "{told}");
    let told = pair.refusal(&["coarse.meshb", "coarse.solb"], &[&truth[..], &["--norm", "0"]].concat());
    assert!(told.contains("--norm"), "{told}");
    let told = pair.refusal(&["coarse.meshb", "coarse.solb"], &[&truth[..], &["--report", "coarse.meshb"]].concat());
    assert!(told.contains("must end in .json"), "{told}");
    std::fs::rename(pair.path("fine.solb"), pair.path("scalar.solb")).unwrap();
    pair.fields(FieldKind::Vector, |p| p.to_vec());
    std::fs::rename(pair.path("fine.solb"), pair.path("vector.solb")).unwrap();
    pair.fields(FieldKind::Scalar, |p| vec![p[0]]);
    let told = pair.refusal(&["coarse.meshb", "coarse.solb"], &["--truth", "fine.meshb", "vector.solb"]);
    assert!(told.contains("other fields than") && told.contains("vector.solb"), "{told}");
}

#[test]
fn values_are_picked_and_lengths_taken() {
    let pair = Pair::new(2, 3);
    pair.fields(FieldKind::Vector, |p| vec![3.0 * p[0], 4.0 * p[0], p[2]]);
    let run = pair.run("pick", &["coarse.solb"], &["--take", "3,norm:1-2", "-o", "picked.solb"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let picked = io::read_solution(&pair.work.path("picked.solb")).unwrap().content;
    for (p, (z, length)) in
        pair.meshes[0].1.vertices.iter().zip(picked.fields[0].values.iter().zip(&picked.fields[1].values))
    {
        assert!((z - p[2]).abs() < 1e-15 && (length - 5.0 * p[0]).abs() < 1e-14);
    }
    let told = complaint(&pair.run("pick", &["coarse.solb"], &["--take", "4", "-o", "more.solb"]));
    assert!(told.contains("3 values a vertex, but --take asks for value 4"), "{told}");
}
