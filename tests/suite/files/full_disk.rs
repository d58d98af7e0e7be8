//! What cannot be written is an error with code 2, and leaves the files as they were: all that belong together, or none.
#![cfg(target_os = "linux")]

use crate::common::adapting::{Workplace, isotropic, stderr};
use crate::common::program;
use geo_adapt::formats::{self, Dataset};
use geo_adapt::geometry::Label;
use geo_adapt::mesh::samples::cube;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A device that takes nothing, as a full disk.
fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

/// A pipe that nobody reads.
fn closed() -> Stdio {
    std::io::pipe().unwrap().1.into()
}

/// A folder with a cube and its metric.
fn prepared() -> Workplace {
    let (work, mesh) = (Workplace::new(), cube(2));
    work.mesh(&mesh);
    work.metric(&mesh, |_| isotropic(0.4));
    work
}

fn command(work: &Workplace, arguments: &str) -> Command {
    let mut command = program();
    command.args(arguments.split(' ')).current_dir(work.path("."));
    command
}

/// Every file below a folder with its bytes; links as what they point to by name.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match fs::symlink_metadata(&path).unwrap().file_type() {
            kind if kind.is_dir() => found.extend(files(&path)),
            kind if kind.is_file() => drop(found.insert(path.clone(), fs::read(&path).unwrap())),
            _ => drop(found.insert(path, Vec::new())),
        }
    }
    found
}

/// Commands that print.
const PRINTING: &[&str] = &[
    "inspect in.meshb",
    "inspect in.meshb --json",
    "inspect in.meshb --metric size.solb",
    "adapt in.meshb --metric size.solb -o o.meshb",
    "convert in.meshb o.vtu",
    "field evaluate in.meshb --function sinfun3 -o o.solb",
    "field pick size.solb --take 1 -o o.solb",
    "metric show in.meshb size.solb",
    "metric scale in.meshb size.solb --complexity 50 -o o.solb",
    "transfer in.meshb size.solb in.meshb -o o.solb",
    "view in.meshb -o o.html",
    "cycle --example analytic",
    "--help",
    "metric scale --help",
    "--version",
];

#[test]
fn a_full_disk_under_standard_output_is_an_error() {
    let work = prepared();
    for arguments in PRINTING {
        let run = command(&work, arguments).stdout(full()).output().unwrap();
        let said = stderr(&run);
        assert_eq!(run.status.code(), Some(2), "{arguments}: {said}");
        assert!(said.contains("error: standard output: ") && said.contains("not complete"), "{arguments}: {said}");
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let work = prepared();
    for arguments in PRINTING {
        let run = command(&work, arguments).stdout(closed()).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{arguments}: {}", stderr(&run));
        assert!(!stderr(&run).contains("error") && !stderr(&run).contains("panic"), "{arguments}: {}", stderr(&run));
    }
}

#[test]
fn standard_error_that_takes_nothing_ends_no_run() {
    let work = prepared();
    fs::write(work.path("bad.mesh"), "nothing").unwrap();
    for sink in [full, closed] {
        for (arguments, code) in [
            ("convert in.meshb o.vtu", 0), // has a note
            ("inspect none.meshb", 2),
            ("inspect bad.mesh", 2),
            ("inspect", 2),
        ] {
            let run = command(&work, arguments).stderr(sink()).output().unwrap();
            assert_eq!(run.status.code(), Some(code), "{arguments}");
        }
    }
}

/// A run that must fail for want of room, and change nothing.
fn fails(work: &Workplace, mut run: Command) {
    let before = files(&work.path("."));
    let run = run.output().unwrap();
    assert_eq!(run.status.code(), Some(2), "{}", stderr(&run));
    assert!(stderr(&run).contains("No space left") || stderr(&run).contains("File too large"), "{}", stderr(&run));
    let after = files(&work.path("."));
    let names = |files: &BTreeMap<PathBuf, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&after), names(&before));
    assert!(after == before, "files have changed");
}

#[test]
fn a_mesh_and_what_belongs_to_it_are_always_of_one_run() {
    let work = prepared();
    for name in ["o.meshb", "o.solb", "o.json", "o.names.json"] {
        fs::write(work.path(name), "old").unwrap();
    }
    // One of the files cannot be written, each in turn.
    for name in ["o.solb", "o.json", "o.names.json"] {
        fs::remove_file(work.path(name)).unwrap();
        symlink("/dev/full", work.path(name)).unwrap();
        fails(&work, command(&work, "adapt in.meshb --metric size.solb -o o.meshb --report o.json -q"));
        fs::remove_file(work.path(name)).unwrap();
        fs::write(work.path(name), "old").unwrap();
    }
    let mut data = Dataset { mesh: cube(2), ..Dataset::default() };
    data.names.triangles.insert(2, Label { name: Some("wing".into()), colour: None });
    formats::write(&work.path("in.b8.ugrid"), &data).unwrap();
    for (name, to) in [("c.names.json", "c.meshb"), ("c.mapbc", "c.lb8.ugrid")] {
        symlink("/dev/full", work.path(name)).unwrap();
        fs::write(work.path(to), "old").unwrap();
        fails(&work, command(&work, &format!("convert in.b8.ugrid {to}")));
    }
}

/// Runs with files of at most so many kilobytes: then the disk is full.
fn on_small_disk(work: &Workplace, kilobytes: u32, arguments: &str) -> Command {
    let mut command = Command::new("bash");
    let script = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec \"$0\" {arguments}");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_geo-adapt")]).current_dir(work.path("."));
    command
}

#[test]
fn a_case_of_openfoam_on_a_full_disk_is_not_half_there() {
    let work = Workplace::new();
    let write = |cells: u32, name: &str| {
        let data = Dataset { mesh: cube(cells), ..Dataset::default() };
        formats::write(&work.path(name), &data).unwrap();
    };
    write(2, "small.su2");
    write(6, "large.su2");
    let case = |name: &str| work.path("case").join(name);
    // A new case: points and cells of the faces find room, the faces do not.
    fails(&work, on_small_disk(&work, 20, "convert large.su2 case/"));
    fails(&work, on_small_disk(&work, 20, "convert large.su2 deep/down/case/"));
    assert!(!work.path("case").exists() && !work.path("deep").exists());
    let good = |run: Output| assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    good(on_small_disk(&work, 20, "convert small.su2 case/").output().unwrap());
    // What is not ours stays, and so does the old mesh until the new one is whole.
    fs::create_dir_all(case("constant/polyMesh/sets")).unwrap();
    for name in ["constant/polyMesh/sets/inlet", "constant/polyMesh/faceZones", "system/controlDict", "0.orig"] {
        fs::write(case(name), "mine").unwrap();
    }
    fails(&work, on_small_disk(&work, 20, "convert large.su2 case/"));
    assert_eq!(fs::read(case("constant/polyMesh/faceZones")).unwrap(), b"mine");
    good(command(&work, "convert large.su2 case").output().unwrap());
    for name in ["constant/polyMesh/sets/inlet", "system/controlDict", "0.orig"] {
        assert_eq!(fs::read(case(name)).unwrap(), b"mine", "{name}");
    }
    assert!(!case("constant/polyMesh/faceZones").exists(), "the zones of another mesh are left");
    assert_eq!(formats::read(&work.path("case")).unwrap().content.mesh.tets.len(), cube(6).tets.len());
    fails(&work, on_small_disk(&work, 20, "convert large.su2 out.meshb"));
}

#[test]
fn what_is_printed_is_kept_when_a_report_goes_to_the_same_place() {
    let work = prepared();
    let log = File::create(work.path("log")).unwrap();
    let mut run = command(&work, "adapt in.meshb --metric size.solb -o o.meshb --report /dev/stdout");
    assert_eq!(run.stdout(log).status().unwrap().code(), Some(0));
    let text = fs::read_to_string(work.path("log")).unwrap();
    assert!(text.starts_with('{') && text.contains("\"version\"") && text.contains("written "), "{text}");
    // Under a name of its own that file would lose one or the other.
    let log = File::options().append(true).open(work.path("log")).unwrap();
    let run = command(&work, "adapt in.meshb --metric size.solb -o o.meshb --report log").stdout(log).output().unwrap();
    assert!(run.status.code() == Some(2) && stderr(&run).contains("standard output goes to this file"));
    assert_eq!(fs::read_to_string(work.path("log")).unwrap(), text);
}
