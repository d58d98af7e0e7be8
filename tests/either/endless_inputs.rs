//! Files that are no files, as inputs: a pipe that nobody writes to, a device without an end, a folder. Each is one error, at once.
#![cfg(target_os = "linux")]

use crate::common::program;
use geo_adapt::mesh::io::write_mesh;
use geo_adapt::mesh::samples::cube;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Commands that read `IN`, and what that ends in.
const READERS: &[(&str, &str)] = &[
    ("inspect IN", "meshb"),
    ("inspect a.mesh --metric IN", "solb"),
    ("adapt IN --analytic linear -o o.mesh", "mesh"),
    ("convert IN o.vtu", "meshb"),
    ("convert IN o.mesh", "msh"),
    ("convert IN o.mesh", "su2"),
    ("convert IN o.mesh", "vtu"),
    ("convert IN o.mesh", "b8.ugrid"),
    ("convert IN o.mesh", "unknown"),
    ("convert a.mesh --fields IN o.vtu", "sol"),
    ("convert a.mesh --fields IN o.vtu", "csv"),
    ("convert a.mesh --fields IN o.vtu", "dat"),
    ("convert a.mesh --names IN o.vtu", "json"),
    ("image-mesh IN -o o.mesh", "nrrd"),
    ("image-mesh v.nhdr -o o.mesh", "raw"),
    ("metric from-points a.mesh IN -o o.sol", "csv"),
    ("metric limit IN --hmax 1 -o o.sol", "sol"),
    ("transfer a.mesh IN a.mesh -o o.sol", "solb"),
    ("view a.mesh --field IN -o o.html", "sol"),
    // Beside what is named.
    ("convert in.mesh o.vtu", "names.json"),
    ("adapt in.mesh --analytic linear -o o.mesh", "names.json"),
    ("convert in.b8.ugrid o.vtu", "mapbc"),
    ("convert case o.vtu", "points"),
    #[cfg(feature = "occt")]
    ("model IN", "step"),
    #[cfg(feature = "occt")]
    ("classify a.mesh --cad IN -o o.mesh", "brep"),
];

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        for name in ["a.mesh", "in.mesh"] {
            write_mesh(&place.path(name), &cube(1)).unwrap();
        }
        let data = geo_adapt::formats::Dataset { mesh: cube(1), ..Default::default() };
        geo_adapt::formats::write(&place.path("in.b8.ugrid"), &data).unwrap();
        geo_adapt::formats::write(&place.path("case/"), &data).unwrap();
        let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: in.raw\n";
        fs::write(place.path("v.nhdr"), header).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs to the end, which must come soon: code and what was said.
    fn run(&self, arguments: &str, input: &str) -> (Option<i32>, String) {
        let mut command = program();
        command.args(arguments.split(' ').map(|word| if word == "IN" { input } else { word }));
        let command = command.current_dir(self.0.path()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let began = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if began.elapsed() > Duration::from_secs(60) {
                child.kill().unwrap();
                panic!("{arguments}: reads for ever");
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let done = child.wait_with_output().unwrap();
        (done.status.code(), String::from_utf8(done.stderr).unwrap())
    }
}

#[test]
fn pipes_devices_and_folders_are_refused_by_every_reader() {
    let place = Place::new();
    for (arguments, ending) in READERS {
        let (input, path) = match *ending {
            "points" => ("points".into(), place.path("case/constant/polyMesh/points")),
            _ => (format!("in.{ending}"), place.path(&format!("in.{ending}"))),
        };
        let was = fs::read(&path).ok();
        for (kind, expected) in [("pipe", "device or a pipe"), ("device", "device or a pipe"), ("folder", "folder")] {
            let _ = fs::remove_file(&path);
            match kind {
                "pipe" => assert!(Command::new("mkfifo").arg(&path).status().unwrap().success()),
                "device" => symlink("/dev/zero", &path).unwrap(),
                _ => fs::create_dir(&path).unwrap(),
            }
            let (code, said) = place.run(arguments, &input);
            let what = format!("{arguments} with a {kind} as {input}: {said}");
            assert!(code == Some(2) && said.lines().count() == 1 && said.starts_with("geo-adapt: error: "), "{what}");
            // A folder may be a case of OpenFOAM, which then has no mesh.
            let is_case = kind == "folder" && arguments.starts_with("convert IN");
            assert!(said.contains(&input) && (is_case || said.contains(expected)), "{what}");
            if kind == "folder" {
                fs::remove_dir(&path).unwrap();
            }
        }
        let _ = fs::remove_file(&path);
        was.into_iter().for_each(|was| fs::write(&path, was).unwrap());
    }
}

#[test]
fn files_of_no_bytes_are_refused_by_every_reader() {
    let place = Place::new();
    for (arguments, ending) in READERS.iter().filter(|(_, ending)| *ending != "points") {
        let input = format!("in.{ending}");
        let was = fs::read(place.path(&input)).ok();
        fs::write(place.path(&input), "").unwrap();
        let (code, said) = place.run(arguments, &input);
        assert!(code == Some(2) && said.lines().count() == 1 && said.contains(&input), "{arguments}: {said}");
        fs::remove_file(place.path(&input)).unwrap();
        was.into_iter().for_each(|was| fs::write(place.path(&input), was).unwrap());
    }
}
