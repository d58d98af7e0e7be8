//! `--memory`: a mesh that is larger than memory is worked on from its files, and the result has the same bytes.
use crate::common::adapting::{Workplace, stderr, text};
use crate::common::program;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::Vec3;
use std::fs;
use std::process::Output;

fn front([x, y, z]: Vec3) -> f64 {
    (20.0 * (x + 0.25 * y - 0.5)).tanh() + 0.2 * (y - z) * (y - z) + 0.1 * x * x
}

/// A cube of some thousand vertices with a field, and what is run on them.
struct Case {
    work: Workplace,
    mesh: String,
    field: String,
}

impl Case {
    fn new() -> Self {
        let (work, mesh) = (Workplace::new(), cube(16));
        let field = work.path("u.solb");
        let values = mesh.vertices.iter().map(|&p| front(p)).collect();
        let fields = vec![SolutionField { kind: FieldKind::Scalar, values }];
        io::write_solution(&field, &Solution { vertices: mesh.vertices.len(), fields }).unwrap();
        Self { mesh: text(&work.mesh(&mesh)), field: text(&field), work }
    }

    fn multiscale(&self, output: &str, arguments: &[&str]) -> Output {
        let mut command = program();
        command.args(["metric", "multiscale", &self.mesh, &self.field, "--complexity", "3000", "-o"]);
        command.arg(self.work.path(output)).args(arguments);
        // Each thread takes some memory.
        if !arguments.contains(&"--threads") {
            command.args(["--threads", "2"]);
        }
        command.output().unwrap()
    }

    /// The bytes of the metric, and what is printed.
    fn made(&self, arguments: &[&str]) -> (Vec<u8>, String) {
        let run = self.multiscale("m.solb", arguments);
        assert_eq!(run.status.code(), Some(0), "{arguments:?}: {}", stderr(&run));
        (fs::read(self.work.path("m.solb")).unwrap(), String::from_utf8(run.stdout).unwrap())
    }

    /// What a run says that must be refused, and must leave nothing.
    fn refused(&self, output: &str, arguments: &[&str]) -> String {
        let names = || {
            let mut names: Vec<_> =
                fs::read_dir(self.work.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let before = names();
        let run = self.multiscale(output, arguments);
        let said = stderr(&run);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(!said.contains("panicked") && said.matches("error: ").count() == 1, "{said}");
        assert_eq!(names(), before, "{arguments:?}");
        said
    }
}

#[test]
fn the_multiscale_metric_has_the_same_bytes() {
    let case = Case::new();
    for options in [&[][..], &["--gradation", "off", "--norm", "4"], &["--gradation", "1.2", "--hmin", "0.02"]] {
        let options = [options, &["--json"]].concat();
        let in_memory = case.made(&options);
        for (memory, threads) in [("80MB", "1"), ("100MB", "2"), ("1GiB", "2")] {
            let found = case.made(&[&options[..], &["--memory", memory, "--threads", threads]].concat());
            assert!(found == in_memory, "{options:?} {memory} {threads}");
        }
    }
    let elsewhere = tempfile::tempdir().unwrap();
    let scratch = text(elsewhere.path());
    assert!(case.made(&["--memory", "100MB", "--scratch", &scratch]) == case.made(&[]));
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

#[test]
fn what_is_not_to_be_had_is_told_with_the_remedy() {
    let case = Case::new();
    let refused = |output: &str, arguments: &[&str], words: &[&str]| {
        let said = case.refused(output, &[&["--memory", "100MB"], arguments].concat());
        assert!(words.iter().all(|word| said.contains(word)), "{arguments:?}: {said}");
    };
    refused("m.sol", &[], &["m.sol", ".solb", "--memory"]);
    refused("m.vtu", &[], &["m.vtu", ".solb", "--memory"]);
    refused("m.solb", &["--hessian", "l2"], &["--hessian l2", "--memory"]);
    refused("m.solb", &["--hessian", "jumps"], &["--hessian jumps", "--memory"]);
    refused("m.solb", &["--scratch", "nowhere"], &["nowhere", "--scratch"]);
    refused("m.solb", &["--component", "2"], &["u.solb", "--component"]);
    refused("m.solb", &["--hmin", "0.3"], &["3000", "cannot be reached", "--hmin"]);
    let said = case.refused("m.solb", &["--memory", "45MB"]);
    assert!(said.contains("in.meshb") && said.contains("give --memory"), "{said}");
    let said = case.refused("m.solb", &["--scratch", "."]);
    assert!(said.contains("--memory"), "{said}");
}

#[test]
fn files_that_are_wrong_are_named() {
    let mut case = Case::new();
    let good = (case.mesh.clone(), case.field.clone());
    let refused = |case: &Case, words: &[&str]| {
        let said = case.refused("m.solb", &["--memory", "100MB"]);
        assert!(words.iter().all(|word| said.contains(word)), "{words:?}: {said}");
    };
    // Cut off, in the tetrahedra and in the values.
    let cut = |name: &str, of: &str, share: f64| {
        let bytes = fs::read(of).unwrap();
        let path = case.work.path(name);
        fs::write(&path, &bytes[..(share * bytes.len() as f64) as usize]).unwrap();
        text(&path)
    };
    let (short_mesh, short_field) = (cut("short.meshb", &good.0, 0.7), cut("short.solb", &good.1, 0.7));
    let (text_mesh, other) = (text(&case.work.path("text.mesh")), text(&case.work.path("other.solb")));
    io::write_mesh(text_mesh.as_ref(), &cube(2)).unwrap();
    let few = Solution { vertices: 7, fields: vec![SolutionField { kind: FieldKind::Scalar, values: vec![1.0; 7] }] };
    io::write_solution(other.as_ref(), &few).unwrap();
    case.mesh = short_mesh;
    refused(&case, &["short.meshb"]);
    case.mesh = text_mesh;
    refused(&case, &["text.mesh", ".meshb"]);
    (case.mesh, case.field) = (good.0.clone(), short_field);
    refused(&case, &["short.solb"]);
    case.field = other;
    refused(&case, &["other.solb", "7 vertices", "4913"]);
    case.field = "nowhere.solb".into();
    refused(&case, &["nowhere.solb"]);
    // One value that is none, and one index that is out of range.
    let mut bytes = fs::read(&good.1).unwrap();
    let middle = bytes.len() - 8 * 1000;
    bytes[middle..middle + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    case.field = text(&case.work.path("nan.solb"));
    fs::write(&case.field, bytes).unwrap();
    refused(&case, &["nan.solb", "of 4913"]);
}
