//! The scripts in geometry/ still write the STEP files that lie there, byte for byte.
//!
//! They need the virtual environment that tests/run makes (.venv/geometry, cadquery). Without it the test says so and
//! passes; under tests/run (GEO_ADAPT_SET_UP) it fails. Nothing of it depends on the feature: once is enough.
#![cfg(feature = "occt")]
use std::fs;
use std::path::Path;
use std::process::Command;

fn regenerates(script: &str, name: &str) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = root.join(".venv/geometry/bin/python");
    if !python.exists() {
        assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "{} is not there", python.display());
        eprintln!("not run: {} is not there; tests/run makes it", python.display());
        return;
    }
    let folder = tempfile::tempdir().expect("a folder for the new file");
    let output = Command::new(python)
        .arg(root.join("geometry").join(script))
        .arg("-o")
        .arg(folder.path())
        .output()
        .expect("python starts");
    assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
    let new = fs::read_to_string(folder.path().join(name)).expect("the script's file");
    let old = fs::read_to_string(root.join("geometry").join(name)).expect("the file of the project");
    let first = new.lines().zip(old.lines()).position(|(new, old)| new != old);
    assert!(
        new == old,
        "{name} comes out otherwise than it lies in geometry/ (first at line {:?})",
        first.map(|i| i + 1)
    );
}

#[test]
fn sphere_in_box_comes_out_as_it_lies_there() {
    regenerates("sphere_in_box.py", "sphere-in-box.step");
}

#[test]
fn cube_cylinder_comes_out_as_it_lies_there() {
    regenerates("cube_cylinder.py", "cube-cylinder.step");
}

#[test]
fn cube_comes_out_as_it_lies_there() {
    regenerates("cube.py", "cube.step");
}

#[test]
fn filleted_block_comes_out_as_it_lies_there() {
    regenerates("filleted_block.py", "filleted-block.step");
}

#[test]
fn shapes_of_known_curvature_come_out_as_they_lie_there() {
    for name in ["sphere", "torus", "cylinder", "cone", "spheroid"] {
        regenerates(&format!("{name}.py"), &format!("{name}.step"));
    }
}

#[test]
fn wing_comes_out_as_it_lies_there() {
    regenerates("wing.py", "wing.step");
}

#[test]
fn what_is_thin_or_near_comes_out_as_it_lies_there() {
    regenerates("thin_plate.py", "thin-plate.step");
    regenerates("slot.py", "slot.step");
}

#[test]
fn models_of_several_solids_come_out_as_they_lie_there() {
    regenerates("two_materials.py", "two-materials.step");
    regenerates("block_on_plate.py", "block-on-plate.step");
}
