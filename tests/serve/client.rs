//! `geo-adapt --server URL …` does what it does here.
use crate::common::program;
use crate::service::{Service, cube};
use std::fs;
use std::path::Path;
use std::process::Output;

fn run(folder: &Path, server: Option<&Service>, arguments: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(folder).args(server.iter().flat_map(|server| ["--server".to_owned(), server.url()]));
    command.args(arguments).output().unwrap()
}

/// All files of a folder.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    all.sort();
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    all.iter().map(|path| (name(path), fs::read(path).unwrap())).collect()
}

#[test]
fn commands_do_the_same_on_a_service() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for place in [&here, &there] {
        fs::create_dir(place.path().join("a")).unwrap();
        fs::write(place.path().join("a/m.meshb"), cube(3)).unwrap();
        // A side file that says what references are called.
        fs::write(place.path().join("a/m.names.json"), r#"{"triangles":{"1":{"name":"wall"}}}"#).unwrap();
    }
    for arguments in [
        &["adapt", "a/m.meshb", "-o", "m.meshb", "--size", "0.2", "--deterministic"][..],
        &["field", "evaluate", "m.meshb", "--function", "tanh3", "-o", "u.solb"],
        &["metric", "multiscale", "m.meshb", "u.solb", "--complexity", "500", "-o", "s.solb"],
        &["convert", "m.meshb", "m.vtu"],
        &["inspect", "m.meshb"],
        &["view", "m.meshb", "-o", "m.html"],
    ] {
        let (own, served) = (run(here.path(), None, arguments), run(there.path(), Some(&service), arguments));
        assert_eq!(
            own.status.code(),
            served.status.code(),
            "{arguments:?} {}",
            String::from_utf8_lossy(&served.stderr)
        );
        assert!(own.status.success() && contents(here.path()) == contents(there.path()), "{arguments:?}");
    }
    let figures = |of: Output| String::from_utf8(of.stdout).unwrap();
    let arguments = ["inspect", "m.meshb", "--json"];
    assert_eq!(figures(run(here.path(), None, &arguments)), figures(run(there.path(), Some(&service), &arguments)));
}

#[test]
fn what_goes_wrong_is_told_as_here() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::start(folder.path(), &[]);
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("bad.meshb"), "no mesh").unwrap();
    let arguments = ["adapt", "bad.meshb", "-o", "o.meshb", "--size", "0.1"];
    let served = run(place.path(), Some(&service), &arguments);
    let said = String::from_utf8(served.stderr).unwrap();
    assert!(served.status.code() == Some(2) && said.contains("geo-adapt: error: bad.meshb"), "{said}");
    drop(service);
    let nobody = run(place.path(), None, &["--server", "http://127.0.0.1:9", "inspect", "bad.meshb"]);
    let said = String::from_utf8(nobody.stderr).unwrap();
    assert!(nobody.status.code() == Some(2) && said.contains("geo-adapt serve"), "{said}");
}
