//! `geo-adapt bootstrap --heal`: small edges and faces go, gaps are closed, and what was done is told.
#![cfg(unix)]

use crate::common::adapting::stderr;
use crate::common::{program, shared_case};
use geo_adapt::mesh::{TetMesh, io, validity};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Output;

fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// A run into a folder.
fn heal(model: &Path, arguments: &[&str], out: &Path) -> Output {
    let mut command = program();
    command.arg("bootstrap").arg(model).arg("-o").arg(out).args(["--mesher", "own", "--threads", "1"]).args(arguments);
    command.output().unwrap()
}

fn faces(mesh: &TetMesh) -> usize {
    mesh.triangles.refs.iter().collect::<BTreeSet<_>>().len()
}

/// The mesh, the lines that are told, and whether the healed model is there.
fn healed(model: &Path, arguments: &[&str]) -> (TetMesh, String) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.meshb");
    let run = heal(model, arguments, &out);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let mesh = io::read_mesh(&out).unwrap().content;
    assert!(validity::check(&mesh).is_valid());
    // The model that the mesh lies on is beside it.
    let brep = folder.path().join("out.brep");
    let mut classify = program();
    classify.arg("classify").arg(&out).arg("--cad").arg(&brep).arg("-o").arg(folder.path().join("again.meshb"));
    let classified = classify.output().unwrap();
    assert_eq!(classified.status.code(), Some(0), "{}", stderr(&classified));
    (mesh, stderr(&run))
}

#[test]
fn slivers_and_tiny_edges_go_into_their_neighbours() {
    let model = here("geometry/zoo/sliver-steps.step");
    let (mesh, told) = healed(&model, &["--heal=1e-2"]);
    assert_eq!(faces(&mesh), 10);
    assert!(told.contains("12 faces are 10 now") && told.contains("4 edges were collapsed"), "{told}");
    assert!(told.contains("2 faces were merged into their neighbours"), "{told}");
}

#[test]
fn nothing_is_done_to_a_sound_model() {
    let model = here("geometry/two-materials.step");
    let (mesh, told) = healed(&model, &["--heal"]);
    assert_eq!(faces(&mesh), 11);
    assert!(told.contains("11 faces are 11 now") && !told.contains("collapsed"), "{told}");
}

#[test]
fn gaps_between_faces_are_closed() {
    let model = here("geometry/faults/gap-box.step");
    let folder = tempfile::tempdir().unwrap();
    let run = heal(&model, &[], &folder.path().join("open.meshb"));
    assert!(run.status.code() == Some(2) && stderr(&run).contains("--heal"), "{}", stderr(&run));
    let (mesh, told) = healed(&model, &["--heal=1e-2"]);
    assert_eq!(faces(&mesh), 6);
    assert!(told.contains("24 open edges were sewn"), "{told}");
    // The gaps are wider than that.
    let run = heal(&model, &["--heal=1e-3"], &folder.path().join("open.meshb"));
    assert!(run.status.code() == Some(2) && stderr(&run).contains("has no solid"), "{}", stderr(&run));
}

/// Bodies that touch and were sewn to one shell, with both of the walls between them: no mesher made a mesh, after two minutes.
#[test]
fn bodies_that_were_sewn_with_both_of_their_walls_share_one() {
    let shared = shared_case("cad-faults/wingSew3.stp").map(|path| (path, 10));
    for (model, count) in [(here("geometry/faults/double-wall.step"), 8)].into_iter().chain(shared) {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out.meshb");
        let run = heal(&model, &[], &out);
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        assert!(stderr(&run).contains("faces of a solid lie on each other, at ("), "{}", stderr(&run));
        assert!(stderr(&run).contains("what was one solid is 2"), "{}", stderr(&run));
        let mesh = io::read_mesh(&out).unwrap().content;
        assert!(validity::check(&mesh).is_valid());
        assert_eq!(faces(&mesh), count, "{}", model.display());
        assert_eq!(mesh.tets.refs.iter().collect::<BTreeSet<_>>().len(), 2);
    }
}

#[test]
fn tiny_fillets_go() {
    let Some(model) = shared_case("cad-faults/n-tinyfillet.egads") else { return };
    let (mesh, told) = healed(&model, &["--heal=5e-3"]);
    assert_eq!(faces(&mesh), 6);
    assert!(told.contains("20 faces were merged"), "{told}");
}

/// A far field is made of the healed body.
#[test]
fn a_far_field_is_that_of_the_healed_body() {
    let model = here("geometry/zoo/sliver-steps.step");
    let (mesh, _) = healed(&model, &["--heal=1e-2", "--far-field", "box:1"]);
    assert_eq!(faces(&mesh), 16);
}

#[test]
fn what_cannot_be_healed_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.meshb");
    // Everything is smaller than that.
    let run = heal(&here("geometry/cube.step"), &["--heal=10"], &out);
    let told = stderr(&run);
    assert_eq!(run.status.code(), Some(2), "{told}");
    assert!(told.contains("cube.step") && told.contains("--heal"), "{told}");
    for wrong in ["--heal=0", "--heal=x", "--heal=-1"] {
        assert_eq!(heal(&here("geometry/cube.step"), &[wrong], &out).status.code(), Some(2), "{wrong}");
    }
    let run = heal(&here("README.md"), &["--heal"], &out);
    assert!(run.status.code() == Some(2) && stderr(&run).contains("README.md"), "{}", stderr(&run));
    assert!(!out.exists());
}
