//! Damaged CAD files through the built program: `model` and `bootstrap` end by themselves with a result or one clear error.
//!
//! A few by default. tests/run --long takes 10 000 of each format through `model` (GEO_ADAPT_MUTATIONS), and all that still are models
//! through `bootstrap` (GEO_ADAPT_LONG=1). GEO_ADAPT_SEED damages them in another way.
#![cfg(unix)]

use crate::common::damage::{Random, damaged};
use crate::common::program;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};

fn run(folder: &Path, arguments: &[&str]) -> Output {
    program().current_dir(folder).args(arguments).stdin(Stdio::null()).output().expect("the program is built")
}

/// Exit code 0, or 2 with one error that names the file; or another one that is allowed.
fn ends_well(output: &Output, what: &str, other: Option<i32>) {
    let (code, told) = (output.status.code(), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.signal().is_none(), "{what}: ended by a signal, {:?}: {told}", output.status);
    assert!(matches!(code, Some(0 | 2)) || code == other, "{what}: {:?}: {told}", output.status);
    assert!(!told.contains("panicked"), "{what}: {told}");
    assert!(code != Some(2) || told.contains("damaged."), "{what}: no error that names the file: {told}");
}

fn is_long() -> bool {
    std::env::var("GEO_ADAPT_LONG").is_ok_and(|long| long == "1")
}

/// The number in a variable of the environment.
fn asked<T: std::str::FromStr>(variable: &str) -> Option<T> {
    std::env::var(variable).ok()?.parse().ok()
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Damages the file again and again; each goes through `model`, and of those that are models some through `bootstrap`.
fn survives(source: &str, extension: &str) {
    let valid = fs::read(data(source)).expect("a file of the tests");
    let count = asked("GEO_ADAPT_MUTATIONS").unwrap_or(24);
    let meshed = if is_long() { count } else { 1 };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let name = format!("damaged.{extension}");
    let (mut random, mut models, mut meshes) = (Random(asked("GEO_ADAPT_SEED").unwrap_or(20_261_122)), 0, 0);
    for number in 0..count {
        fs::write(folder.path().join(&name), damaged(&valid, &mut random)).expect("the folder is ours");
        let output = run(folder.path(), &["model", &name]);
        let keep = |what: &str| format!("{what} of {source}, number {number} of this seed");
        ends_well(&output, &keep("model"), None);
        if output.status.success() {
            models += 1;
            if models <= meshed {
                let output = run(folder.path(), &["bootstrap", &name, "-o", "out.meshb", "--time-limit", "5"]);
                // A mesh that has flaws is written and told, with exit code 1.
                ends_well(&output, &keep("bootstrap"), Some(1));
                meshes += usize::from(output.status.success());
            }
        }
    }
    assert!(models < count, "no file was damaged enough to tell");
    eprintln!("{source}: {count} damaged files, {models} still models, {meshes} meshed");
}

/// OCCT asks a curve for its poles that there is on a surface alone, and has none: a line that became an arc has no curve in space.
#[test]
fn an_edge_without_a_curve_in_space_has_a_length() {
    let valid = fs::read_to_string(data("block-inches.igs")).expect("a file of the tests");
    let line = valid.lines().nth(49).expect("it has more lines");
    assert!(line.starts_with("     110"), "another file: {line}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let damaged = valid.replace(line, &line.replacen("110", "100", 1));
    fs::write(folder.path().join("damaged.igs"), damaged).expect("the folder is ours");
    ends_well(&run(folder.path(), &["model", "damaged.igs"]), "an arc for a line", None);
}

/// OpenCASCADE walks to parameters turn by turn, here 1e15 and 1e62 of them: for its box, and to tell what is inside.
#[test]
fn a_face_that_goes_round_too_often_is_refused() {
    let damages = [
        ("torus.brep", "brep", "3  3 4CN 1 0 0 6.28318530717959", "3  3 4CN 1 0 0 6628318530717959"),
        ("vase.brep", "egads", "\n1 6.2831853071795862 0 0 1 \n", "\n1 6.2831853071795e62 0 0 1 \n"),
    ];
    for (source, extension, line, damaged) in damages {
        let valid = fs::read_to_string(data(source)).expect("a file of the tests");
        assert!(valid.contains(line), "another file");
        let folder = tempfile::tempdir().expect("a temporary folder");
        let name = format!("damaged.{extension}");
        fs::write(folder.path().join(&name), valid.replace(line, damaged)).expect("the folder is ours");
        let output = run(folder.path(), &["model", &name]);
        ends_well(&output, source, None);
        assert!(String::from_utf8_lossy(&output.stderr).contains("goes round its surface too often"), "{output:?}");
    }
}

/// OpenCASCADE's classifier crashes where an edge has no end in the parameters of its face. That was in our own process.
#[test]
fn a_boundary_that_goes_to_infinity_is_refused() {
    let valid = fs::read_to_string(data("blade.brep")).expect("a file of the tests");
    let pole = " 1.2053474510301097 0.00665";
    assert!(valid.contains(pole), "another file");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let damaged = valid.replacen(pole, " 1.20534E4510301097 0.00665", 1);
    fs::write(folder.path().join("damaged.brep"), damaged).expect("the folder is ours");
    let output = run(folder.path(), &["model", "damaged.brep"]);
    ends_well(&output, "a pole at infinity", None);
    assert!(String::from_utf8_lossy(&output.stderr).contains("damaged.brep: is damaged"), "{output:?}");
}

#[test]
fn damaged_step_files_end_well() {
    survives("capped-cylinder.step", "step");
}

#[test]
fn damaged_iges_files_end_well() {
    survives("block-inches.igs", "igs");
}

#[test]
fn damaged_brep_files_end_well() {
    survives("torus.brep", "brep");
}

#[test]
fn damaged_egads_files_end_well() {
    survives("torus.brep", "egads");
}

/// A plane that was moved away leaves its edges with tolerances greater than the model: no mesh can lie on both.
#[test]
fn tolerances_greater_than_the_model_are_refused() {
    let valid = fs::read_to_string(data("block-inches.igs")).expect("a file of the tests");
    let plane = "108,1.,0.,-0.,1.,0,1.,0.,0.,0.;";
    assert!(valid.contains(plane), "another file");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let damaged = valid.replace(&format!("{plane} "), "108,1.,0.,-0.,18,0,1.,0.,0.,0.; ");
    fs::write(folder.path().join("damaged.igs"), damaged).expect("the folder is ours");
    let output = run(folder.path(), &["model", "damaged.igs"]);
    ends_well(&output, "a plane elsewhere", None);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && told.contains("largest tolerance"), "{output:?}");
}
