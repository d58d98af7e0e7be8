//! Whoever comes from mmg3d or refine types what he is used to; shells complete; manual pages are there; a mistyped file is told.

use crate::common::program;
use std::fs;
use std::path::Path;
use std::process::Output;

fn run(folder: &Path, arguments: &[&str]) -> Output {
    program().current_dir(folder).args(arguments).output().expect("the program is built")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The cube-cylinder's first mesh, with a metric.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let start = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/cube-cylinder/start.meshb");
    fs::copy(start, folder.path().join("in.meshb")).expect("the case has a mesh");
    let made = run(folder.path(), &["metric", "implied", "in.meshb", "-o", "in.solb"]);
    assert!(made.status.success(), "{}", told(&made));
    folder
}

#[test]
fn a_line_of_mmg3d_adapts() {
    let folder = folder();
    for line in [
        &["mmg3d", "-in", "in.meshb", "-sol", "in.solb", "-out", "a.meshb", "-hgrad", "-1"][..],
        &["-in", "in.meshb", "-out", "b.meshb", "-hgrad", "-1"],
    ] {
        let output = run(folder.path(), line);
        assert!(output.status.success(), "{line:?}: {}", told(&output));
        assert!(told(&output).contains("this is `geo-adapt adapt in.meshb --metric in.solb"), "{}", told(&output));
    }
    let [a, b] = ["a.meshb", "b.meshb"].map(|name| fs::read(folder.path().join(name)).expect("it was written"));
    assert!(a == b && a.len() > 1000, "the sizes beside the mesh are those of -sol");
    let refused = run(folder.path(), &["mmg3d", "in.meshb", "-sol", "in.solb", "-nosurf"]);
    assert!(refused.status.code() == Some(2) && told(&refused).contains("--freeze"), "{}", told(&refused));
}

#[test]
fn a_line_of_refine_adapts() {
    let folder = folder();
    let output = run(folder.path(), &["ref", "adapt", "in.meshb", "-m", "in.solb", "-x", "a.meshb", "-s", "20"]);
    assert!(output.status.success() && told(&output).contains("-s: sweeps end by themselves"), "{}", told(&output));
    let output = run(folder.path(), &["ref", "translate", "a.meshb", "a.su2"]);
    assert!(output.status.success() && folder.path().join("a.su2").is_file(), "{}", told(&output));
    let refused = run(folder.path(), &["ref", "adapt", "in.meshb", "-x", "b.meshb"]);
    assert!(
        refused.status.code() == Some(2) && told(&refused).contains("metric implied in.meshb"),
        "{}",
        told(&refused)
    );
}

#[test]
fn shells_complete_and_pages_are_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for shell in ["bash", "zsh", "fish"] {
        let output = run(folder.path(), &["completions", shell]);
        let script = String::from_utf8(output.stdout).expect("it is text");
        assert!(output.status.success() && script.contains("bootstrap") && script.contains("complexity"), "{shell}");
    }
    let output = run(folder.path(), &["man", "."]);
    assert!(output.status.success(), "{}", told(&output));
    for (name, word) in
        [("geo-adapt", "bootstrap"), ("geo-adapt-adapt", "complexity"), ("geo-adapt-metric-multiscale", "norm")]
    {
        let page = fs::read_to_string(folder.path().join(format!("{name}.1"))).expect("the page is there");
        assert!(
            page.contains(".TH") && page.contains(word) && page.contains(&name.replace('-', "\\-")),
            "{name}: {page}"
        );
    }
}

#[test]
fn what_is_mistyped_is_told_with_what_is_meant() {
    let folder = folder();
    for (line, said) in [
        (&["inspect", "im.meshb"][..], "did you mean in.meshb?"),
        (&["inspect", "no/in.meshb"], "there is no folder no"),
        (&["insepct", "in.meshb"], "inspect"),
        (&["inspect", "in.meshb", "--metrci", "in.solb"], "--metric"),
        (&["adapt", "in.meshb", "--metric", "in.slob", "-o", "a.meshb"], "did you mean in.solb?"),
    ] {
        let output = run(folder.path(), line);
        assert!(output.status.code() == Some(2) && told(&output).contains(said), "{line:?}: {}", told(&output));
    }
}
