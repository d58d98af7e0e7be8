//! The same files, byte for byte, whatever the number of threads.

use crate::common::adapting::{Workplace, stderr, text};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::samples::cube;
use geo_adapt::metric::Sym3;
use serde_json::Value;
use std::path::Path;

const THREADS: [&str; 4] = ["1", "2", "3", "8"];

/// What a run wrote: mesh, metric, and of the report all but the times and the threads.
struct Written {
    files: [Vec<u8>; 2],
    report: Value,
}

fn written(work: &Workplace, mesh: &Path, arguments: &[&str], threads: &str) -> Written {
    let report = text(&work.path("report.json"));
    let arguments = [arguments, &["--quiet", "--report", &report, "--threads", threads]].concat();
    let run = work.command(mesh, &arguments).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let mut report: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    let fields = report.as_object_mut().unwrap();
    fields.remove("seconds");
    fields.remove("threads");
    fields["forecast"].as_object_mut().unwrap().remove("seconds");
    for operation in fields["operations"].as_object_mut().unwrap().values_mut() {
        operation.as_object_mut().unwrap().remove("seconds");
    }
    Written { files: ["out.meshb", "out.solb"].map(|name| std::fs::read(work.path(name)).unwrap()), report }
}

fn same_on_any_threads(work: &Workplace, mesh: &Path, arguments: &[&str]) {
    let alone = written(work, mesh, arguments, THREADS[0]);
    assert!(alone.report["statistics"]["vertices"].as_u64().unwrap() > 1000, "large enough to be shared out");
    for threads in &THREADS[1..] {
        let shared = written(work, mesh, arguments, threads);
        assert_eq!(shared.report, alone.report, "{threads} threads");
        assert!(shared.files == alone.files, "{threads} threads write other bytes");
    }
}

#[test]
fn refined_by_an_analytic_field() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3));
    same_on_any_threads(&work, &mesh, &["--analytic", "polar-1", "--complexity", "3000"]);
}

#[test]
fn refined_at_centroids() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3));
    same_on_any_threads(&work, &mesh, &["--analytic", "linear", "--complexity", "2000", "--points", "centroid"]);
}

/// From a field at the vertices, of a mesh that is much too fine: it is coarsened first.
#[test]
fn coarsened_by_a_field_at_the_vertices() {
    let work = Workplace::new();
    let mesh: TetMesh = cube(24);
    let metric = work.metric(&mesh, |p| Sym3::diagonal(1.0, 1.0, 2.0).times(80.0 + 200.0 * p[0] * p[0]));
    let path = work.mesh(&mesh);
    same_on_any_threads(&work, &path, &["--metric", &metric]);
}

/// Two cycles in one process write what two runs write, of which the second reads what the first wrote.
#[test]
fn cycles_in_one_process_or_in_several() {
    let work = Workplace::new();
    let mesh: TetMesh = cube(6);
    let metric = work.metric(&mesh, |p| Sym3::diagonal(1.0, 4.0, 2.0).times(30.0 + 200.0 * p[2]));
    let path = work.mesh(&mesh);
    let at_once = written(&work, &path, &["--metric", &metric, "--complexity", "1500", "--cycles", "2"], "2");
    written(&work, &path, &["--metric", &metric, "--complexity", "1500"], "1");
    let [first, size] = ["first.meshb", "first.solb"].map(|name| work.path(name));
    std::fs::rename(work.path("out.meshb"), &first).unwrap();
    std::fs::rename(work.path("out.solb"), &size).unwrap();
    let second = written(&work, &first, &["--metric", &text(&size), "--complexity", "1500"], "3");
    assert!(second.files == at_once.files, "two processes write other bytes");
}

#[cfg(feature = "occt")]
#[test]
fn refined_on_a_model() {
    let work = Workplace::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let model = text(&root.join("geometry/cube-cylinder.step"));
    let mesh = root.join("cases/cube-cylinder/start.meshb");
    same_on_any_threads(&work, &mesh, &["--cad", &model, "--analytic", "polar-2", "--complexity", "3000"]);
}
