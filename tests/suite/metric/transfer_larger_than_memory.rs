//! `transfer --memory`: fields between meshes that are larger than memory, from their files, and the result has the same bytes.
use crate::common::adapting::{Workplace, isotropic, stderr, text};
use crate::common::program;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::Vec3;
use serde_json::Value;
use std::fs;
use std::process::Output;

/// Two meshes of some thousand vertices: the new one reaches out of the old one, in part far out.
struct Case {
    work: Workplace,
    old: TetMesh,
}

/// A field: its kind, and its values at a point.
type Asked<'f> = (FieldKind, &'f dyn Fn(Vec3) -> Vec<f64>);

impl Case {
    fn new() -> Self {
        let (work, old, mut new) = (Workplace::new(), cube(12), cube(14));
        for p in &mut new.vertices {
            *p = [1.2 * p[0] - 0.05, p[1] + 0.1 * p[0] * (1.0 - p[0]), if p[0] > 0.8 { 1.5 * p[2] } else { p[2] }];
        }
        io::write_mesh(&work.path("old.meshb"), &old).unwrap();
        io::write_mesh(&work.path("new.meshb"), &new).unwrap();
        let case = Self { work, old };
        case.fields("old.solb", &[(FieldKind::Scalar, &wave), (FieldKind::Vector, &|p| p.to_vec())]);
        case.fields("sizes.solb", &[(FieldKind::Scalar, &|p| vec![0.1 + p[0]])]);
        case.fields("metric.solb", &[(FieldKind::SymmetricTensor, &|p| isotropic(0.1 + p[0]).0.to_vec())]);
        case
    }

    fn fields(&self, name: &str, fields: &[Asked<'_>]) {
        let field = |&(kind, at): &Asked<'_>| SolutionField {
            kind,
            values: self.old.vertices.iter().flat_map(|&p| at(p)).collect(),
        };
        let fields = fields.iter().map(field).collect();
        io::write_solution(&self.work.path(name), &Solution { vertices: self.old.vertices.len(), fields }).unwrap();
    }

    fn transfer(&self, [fields, output]: [&str; 2], arguments: &[&str]) -> Output {
        let mut command = program();
        command.arg("transfer").args(["old.meshb", fields, "new.meshb"].map(|name| self.work.path(name)));
        command.arg("-o").arg(self.work.path(output)).args(arguments);
        // Each thread takes some memory.
        if !arguments.contains(&"--threads") {
            command.args(["--threads", "2"]);
        }
        command.output().unwrap()
    }

    /// The bytes of the fields, and what is printed but for the seconds.
    fn made(&self, fields: &str, arguments: &[&str]) -> (Vec<u8>, Value) {
        let run = self.transfer([fields, "new.solb"], &[&["--json"], arguments].concat());
        assert_eq!(run.status.code(), Some(0), "{arguments:?}: {}", stderr(&run));
        let mut figures: Value = serde_json::from_slice(&run.stdout).unwrap();
        assert!(figures.as_object_mut().unwrap().remove("seconds").is_some());
        (fs::read(self.work.path("new.solb")).unwrap(), figures)
    }

    /// What a run says that must be refused, and must leave nothing.
    fn refused(&self, files: [&str; 2], arguments: &[&str]) -> String {
        let names = || {
            let mut names: Vec<_> =
                fs::read_dir(self.work.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
            names.sort();
            names
        };
        let before = names();
        let run = self.transfer(files, arguments);
        let said = stderr(&run);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(!said.contains("panicked") && said.matches("error: ").count() == 1, "{said}");
        assert_eq!(names(), before, "{arguments:?}");
        said
    }
}

fn wave(p: Vec3) -> Vec<f64> {
    vec![2.0 + (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + if p[2] > 0.4 { 1.0 } else { 0.0 }]
}

#[test]
fn the_fields_have_the_same_bytes() {
    let case = Case::new();
    for (fields, options) in [
        ("old.solb", &[][..]),
        ("old.solb", &["--conservative"]),
        ("old.solb", &["--conservative=mass"]),
        ("metric.solb", &["--metric"]),
        ("sizes.solb", &["--metric"]),
    ] {
        let in_memory = case.made(fields, options);
        assert!(in_memory.1["outside"].as_u64() > Some(100), "{}", in_memory.1);
        for (memory, threads) in [("80MB", "1"), ("100MB", "2"), ("1GiB", "2")] {
            let found = case.made(fields, &[options, &["--memory", memory, "--threads", threads]].concat());
            assert_eq!(found.1, in_memory.1, "{options:?} {memory} {threads}");
            assert!(found.0 == in_memory.0, "{options:?} {memory} {threads}");
        }
    }
    let elsewhere = tempfile::tempdir().unwrap();
    let scratch = text(elsewhere.path());
    assert!(case.made("old.solb", &["--memory", "100MB", "--scratch", &scratch]) == case.made("old.solb", &[]));
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
    let quiet = case.transfer(["old.solb", "quiet.solb"], &["--memory", "100MB", "--quiet"]);
    assert_eq!((quiet.status.code(), quiet.stdout.len()), (Some(0), 0), "{}", stderr(&quiet));
    assert!(fs::read(case.work.path("quiet.solb")).unwrap() == case.made("old.solb", &[]).0);
}

#[test]
fn what_is_not_to_be_had_is_told_with_the_remedy() {
    let case = Case::new();
    let refused = |files: [&str; 2], arguments: &[&str], words: &[&str]| {
        let said = case.refused(files, &[&["--memory", "100MB"], arguments].concat());
        assert!(words.iter().all(|word| said.contains(word)), "{arguments:?}: {said}");
    };
    refused(["old.solb", "new.sol"], &[], &["new.sol", ".solb", "--memory"]);
    refused(["old.solb", "new.vtu"], &[], &["new.vtu", ".solb", "--memory"]);
    refused(["old.solb", "new.solb"], &["--scratch", "nowhere"], &["nowhere", "--scratch"]);
    refused(["old.solb", "new.solb"], &["--metric"], &["old.solb", "scalar, vector"]);
    case.fields("old.sol", &[(FieldKind::Scalar, &wave)]);
    refused(["old.sol", "new.solb"], &[], &["old.sol", ".solb", "--memory"]);
    let said = case.refused(["old.solb", "new.solb"], &["--memory", "45MB"]);
    assert!(said.contains("4 values a vertex") && said.contains("give --memory"), "{said}");
    let said = case.refused(["old.solb", "new.solb"], &["--scratch", "."]);
    assert!(said.contains("--memory"), "{said}");
}

#[test]
fn files_that_are_wrong_are_named() {
    let case = Case::new();
    let refused = |fields: &str, arguments: &[&str], words: &[&str]| {
        let said = case.refused([fields, "new.solb"], &[&["--memory", "100MB"], arguments].concat());
        assert!(words.iter().all(|word| said.contains(word)), "{words:?}: {said}");
    };
    let path = |name: &str| case.work.path(name);
    let few = Solution { vertices: 7, fields: vec![SolutionField { kind: FieldKind::Scalar, values: vec![1.0; 7] }] };
    io::write_solution(&path("few.solb"), &few).unwrap();
    refused("few.solb", &[], &["few.solb", "7 vertices", "old.meshb", "2197"]);
    refused("nowhere.solb", &[], &["nowhere.solb"]);
    // Cut off, a value that is none, and a tensor that is no metric.
    let good = fs::read(path("metric.solb")).unwrap();
    fs::write(path("short.solb"), &good[..good.len() / 2]).unwrap();
    refused("short.solb", &[], &["short.solb"]);
    let with = |value: f64| {
        let mut bytes = good.clone();
        let middle = bytes.len() - 8 * 6 * 1000 - 24;
        bytes[middle..middle + 8].copy_from_slice(&value.to_le_bytes());
        fs::write(path("wrong.solb"), bytes).unwrap();
    };
    with(f64::NAN);
    refused("wrong.solb", &[], &["wrong.solb"]);
    with(1e9);
    refused("wrong.solb", &["--metric"], &["wrong.solb", "not positive definite"]);
    // Meshes: cut off, with an inverted tetrahedron, a text.
    let (old, new) = (fs::read(path("old.meshb")).unwrap(), fs::read(path("new.meshb")).unwrap());
    fs::write(path("old.meshb"), &old[..old.len() * 2 / 3]).unwrap();
    refused("old.solb", &[], &["old.meshb"]);
    let mut inverted = case.old.clone();
    inverted.tets.nodes[41].swap(0, 1);
    io::write_mesh(&path("old.meshb"), &inverted).unwrap();
    refused("old.solb", &["--conservative"], &["old.meshb", "tetrahedron 42 of the old mesh is inverted"]);
    fs::write(path("old.meshb"), &old).unwrap();
    fs::write(path("new.meshb"), &new[..new.len() - 100]).unwrap();
    refused("old.solb", &[], &["new.meshb"]);
    io::write_mesh(&path("text.mesh"), &cube(2)).unwrap();
    fs::copy(path("text.mesh"), path("new.meshb")).unwrap();
    refused("old.solb", &[], &["new.meshb", "no binary file"]);
}
