//! The scripts in geometry/ still write the STEP and BREP files that lie there, byte for byte.
//!
//! They need the virtual environments that tests/run makes (.venv/geometry with cadquery, .venv/build123d). Without one its test says so
//! and passes; under tests/run (GEO_ADAPT_SET_UP) it fails. Nothing of it depends on the feature: once is enough.
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn geometry() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry")
}

/// The folders of geometry/ whose models one environment writes with one script.
struct Kind {
    environment: &'static str,
    script: &'static str,
    places: &'static [&'static str],
}

const CADQUERY: Kind =
    Kind { environment: "geometry", script: "write_all.py", places: &["", "aircraft", "faults", "zoo"] };
const BUILD123D: Kind = Kind { environment: "build123d", script: "build123d/write_all.py", places: &["build123d"] };

/// The models in these places below a folder, relative to it.
fn models(folder: &Path, places: &[&str]) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for place in places {
        for entry in fs::read_dir(folder.join(place)).expect("the folder") {
            let name = PathBuf::from(entry.expect("an entry").file_name());
            if name.extension().is_some_and(|kind| kind == "step" || kind == "brep") {
                found.insert(Path::new(place).join(name));
            }
        }
    }
    found
}

/// Runs a script with `-o FOLDER`; false where the environment is not there.
fn written(environment: &str, script: &str, folder: &Path) -> bool {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv").join(environment).join("bin/python");
    if !python.exists() {
        assert!(std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "{} is not there", python.display());
        eprintln!("not run: {} is not there; tests/run makes it", python.display());
        return false;
    }
    let output =
        Command::new(python).arg(geometry().join(script)).arg("-o").arg(folder).output().expect("python starts");
    assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
    true
}

/// What is wrong with a new file, or nothing.
fn difference(folder: &Path, model: &Path) -> Option<String> {
    let read = |place: &Path| fs::read_to_string(place.join(model)).expect("a model's text");
    let (new, old) = (read(folder), read(&geometry()));
    let first = new.lines().zip(old.lines()).position(|(new, old)| new != old);
    let line = first.map_or(new.lines().count().min(old.lines().count()), |i| i) + 1;
    (new != old).then(|| format!("{} comes out otherwise than it lies in geometry/, from line {line}", model.display()))
}

/// In one process, since importing cadquery or build123d takes longer than the models do.
fn all_come_out_as_they_lie_there(kind: &Kind) {
    let folder = tempfile::tempdir().expect("a folder for the new files");
    if !written(kind.environment, kind.script, folder.path()) {
        return;
    }
    let there = models(&geometry(), kind.places);
    assert_eq!(models(folder.path(), kind.places), there, "{} writes other models than lie in geometry/", kind.script);
    let differences: Vec<String> = there.iter().filter_map(|model| difference(folder.path(), model)).collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn all_models_of_cadquery_come_out_as_they_lie_there() {
    all_come_out_as_they_lie_there(&CADQUERY);
}

#[test]
fn all_models_of_build123d_come_out_as_they_lie_there() {
    all_come_out_as_they_lie_there(&BUILD123D);
}

/// The command line of the scripts outside zoo/ and build123d/.
#[test]
fn a_script_alone_writes_the_same() {
    let folder = tempfile::tempdir().expect("a folder for the new file");
    if written(CADQUERY.environment, "cube.py", folder.path()) {
        assert_eq!(difference(folder.path(), Path::new("cube.step")), None);
    }
}

#[test]
fn every_model_has_its_line_in_the_readme() {
    let text = fs::read_to_string(geometry().join("README.md")).expect("geometry/README.md");
    let places = [CADQUERY.places, BUILD123D.places].concat();
    for model in models(&geometry(), &places) {
        // A BREP stands beside the STEP of its name.
        let name = model.with_extension("step");
        let name = name.file_name().expect("a name").to_string_lossy();
        assert!(text.contains(&format!("| {name} | ")), "geometry/README.md has no line about {name}");
    }
}
