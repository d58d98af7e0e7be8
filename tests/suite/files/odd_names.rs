//! Names that users and their programs give: blanks, quotes, bytes that are no text; and several runs with the same output at once.
#![cfg(target_os = "linux")]

use crate::common::program;
use geo_adapt::formats::{self, Dataset, NamedField};
use geo_adapt::geometry::{Label, names};
use geo_adapt::mesh::io::{FieldKind, read_mesh, write_mesh};
use geo_adapt::mesh::samples::cube;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Names without their ending.
const NAMES: [&[u8]; 6] =
    [b"my mesh", b"it's \"one\"", b"-o", b"caf\xe9", "\u{3b1}\u{1f600}".as_bytes(), b"a.solb.names.json.b8"];

fn run(folder: &Path, arguments: &[&OsStr]) -> Output {
    program().args(arguments).current_dir(folder).output().unwrap()
}

fn good(folder: &Path, arguments: &[&OsStr]) {
    let run = run(folder, arguments);
    assert_eq!(run.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn every_name_of_a_file_is_taken() {
    for name in NAMES {
        let folder = tempfile::tempdir().unwrap();
        let file = |ending: &str| {
            let mut file = OsString::from("./");
            file.push(OsStr::from_bytes(name));
            file.push(ending);
            file
        };
        let (input, output, report) = (file(".meshb"), file("2.meshb"), file(".json"));
        write_mesh(&folder.path().join(&input), &cube(2)).unwrap();
        let word = |text: &'static str| OsStr::new(text);
        let adapt = [word("adapt"), &input, word("--analytic"), word("linear"), word("--complexity"), word("20")];
        good(folder.path(), &[&adapt[..], &[word("-o"), &output, word("--report"), &report, word("-q")]].concat());
        let text = fs::read_to_string(folder.path().join(&report)).unwrap();
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["output"], Path::new(&output).to_string_lossy().as_ref());
        let field = file("f.solb");
        let evaluate = [word("field"), word("evaluate"), &output, word("--function"), word("sinfun3")];
        good(folder.path(), &[&evaluate[..], &[word("-o"), &field, word("--report"), &report]].concat());
        let (metric, page, picture) = (file("m.solb"), file(".html"), file(".png"));
        let multiscale = [word("metric"), word("multiscale"), &output, &field, word("--complexity"), word("30")];
        good(folder.path(), &[&multiscale[..], &[word("-o"), &metric, word("--report"), &report]].concat());
        let geometry = [word("metric"), word("geometry"), &output, word("-o"), &metric, word("--report"), &report];
        good(folder.path(), &geometry);
        good(folder.path(), &[word("view"), &output, word("-o"), &page, word("--png"), &picture]);
        for ending in [".vtu", ".su2", ".msh", ".b8.ugrid", "case/"] {
            let converted = file(ending);
            good(folder.path(), &[word("convert"), &output, &converted]);
            good(folder.path(), &[word("convert"), &converted, &file("again.mesh")]);
        }
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert!(left.iter().all(|name| !name.as_bytes().ends_with(b".tmp")), "{left:?}");
    }
}

/// A mesh with a value a vertex and a name for its surface, each telling how fine it is.
fn dataset(cells: u32) -> Dataset {
    let mesh = cube(cells);
    let values = vec![f64::from(cells); mesh.vertices.len()];
    let mut data = Dataset { mesh, ..Dataset::default() };
    data.fields = vec![NamedField { name: format!("cells {cells}"), kind: FieldKind::Scalar, values }];
    data.names.triangles.insert(1, Label { name: Some(format!("wall {cells}")), colour: None });
    data
}

#[test]
fn runs_with_the_same_output_at_once_leave_all_files_of_one_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    const SIZES: [u32; 4] = [1, 2, 3, 4];
    for cells in SIZES {
        formats::write(&path(&format!("{cells}.vtu")), &dataset(cells)).unwrap();
    }
    for _ in 0..3 {
        let children = SIZES.map(|cells| {
            let input = format!("{cells}.vtu");
            program().args(["convert", &input, "out.meshb"]).current_dir(folder.path()).output()
        });
        assert!(children.iter().all(|child| child.as_ref().unwrap().status.success()));
        std::thread::scope(|scope| {
            for cells in SIZES {
                let data = dataset(cells);
                let path = &path;
                scope.spawn(move || (0..6).for_each(|_| drop(formats::write(&path("out.meshb"), &data).unwrap())));
            }
        });
        let mesh = read_mesh(&path("out.meshb")).unwrap().content;
        let cells = SIZES.into_iter().find(|&cells| cube(cells).vertices.len() == mesh.vertices.len()).unwrap();
        let read = formats::read(&path("out.meshb")).unwrap();
        assert_eq!(read.notices, [""; 0]);
        assert!(read.content == dataset(cells), "files of several runs");
        assert_eq!(names::read_fields(&path("out.meshb")).unwrap(), [format!("cells {cells}")]);
    }
}

#[test]
fn the_names_that_are_written_are_those_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.meshb");
    let long = folder.path().join("a.meshb.names.json");
    fs::write(&long, r#"{"triangles": {"1": {"name": "of an older mesh"}}}"#).unwrap();
    formats::write(&path, &dataset(1)).unwrap();
    assert_eq!(names::read(&path).unwrap(), dataset(1).names);
    assert!(!folder.path().join("a.names.json").exists());
}
