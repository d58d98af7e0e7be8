//! A mesh grows as long as there is memory for it, and as far as it may; and what will come is told before.
#![cfg(target_os = "linux")]

use crate::common::adapting::{Workplace, cube, isotropic, stderr, text};
use std::process::Command;

/// Address spaces, in kilobytes, in which there is room for the mesh, but not for four times as much: the store asks for less and less of it.
const LIMITS: [u32; 2] = [300_000, 340_000];

/// What the libraries of OpenCASCADE take besides.
const LIBRARIES: u32 = if cfg!(feature = "occt") { 130_000 } else { 0 };

#[test]
fn a_mesh_that_fits_into_the_memory_that_is_there_is_not_called_overgrown() {
    let work = Workplace::new();
    let input = cube(10, |_| 1);
    let metric = work.metric(&input, |_| isotropic(0.033));
    let (mesh, report, output) = (work.mesh(&input), work.path("report.json"), work.path("out.meshb"));
    for limit in LIMITS {
        let limited = format!("ulimit -v {} && exec \"$0\" \"$@\"", limit + LIBRARIES);
        let mut run = Command::new("sh");
        run.args(["-c", &limited, env!("CARGO_BIN_EXE_geo-adapt"), "adapt", &text(&mesh), "--metric", &metric]);
        run.args(["-o", &text(&output), "--report", &text(&report), "--threads", "1", "--quiet"]);
        let run = run.output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{limit}: {}", stderr(&run));
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        let vertices = report["statistics"]["vertices"].as_u64().unwrap();
        assert!(report["overgrown"] == false && vertices > 20_000, "{vertices} vertices, {}", report["overgrown"]);
    }
}

/// Runs `adapt` on a cube for edges of this length; its exit code, what it says, its mesh's vertices and its report.
fn adapted(size: f64, arguments: &[&str]) -> (Option<i32>, String, usize, serde_json::Value) {
    let work = Workplace::new();
    let input = cube(6, |_| 1);
    let metric = work.metric(&input, |_| isotropic(size));
    let (mesh, report) = (work.mesh(&input), work.path("report.json"));
    let mut run = work.command(&mesh, &["--metric", &metric, "--threads", "1", "--report", &text(&report)]);
    let run = run.args(arguments).output().unwrap();
    let made = geo_adapt::mesh::io::read_mesh(&work.path("out.meshb")).unwrap().content;
    assert!(geo_adapt::mesh::validity::check(&made).is_valid());
    let report = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    (run.status.code(), stderr(&run), made.vertices.len(), report)
}

#[test]
fn a_mesh_with_as_many_vertices_as_it_may_have_is_written_and_the_exit_code_is_3() {
    let (code, said, vertices, report) = adapted(0.02, &["--max-vertices", "3000"]);
    assert_eq!(code, Some(3), "{said}");
    assert!((2900..=3000).contains(&vertices), "{vertices}");
    assert_eq!(report["growth_end"], "max-vertices");
    assert!(said.contains("will end with 3000 vertices"), "{said}");
    // One that needs fewer is not touched by it, however many it had.
    let (code, said, vertices, report) = adapted(0.5, &["--max-vertices", "200"]);
    assert_eq!((code, report["growth_end"].is_null()), (Some(0), true), "{vertices}: {said}");
    let (code, said, vertices, report) = adapted(0.1, &["--max-vertices", "3000"]);
    assert_eq!((code, report["growth_end"].is_null()), (Some(0), true), "{said}");
    assert!(vertices < 3000 && !said.contains("will end"), "{vertices}: {said}");
}

#[test]
fn what_a_run_will_take_is_told_before() {
    for size in [0.1, 0.03] {
        let (_, said, vertices, report) = adapted(size, &[]);
        let forecast = report["forecast"]["vertices"].as_f64().unwrap();
        let ratio = forecast / vertices as f64;
        assert!((0.8..1.25).contains(&ratio), "{forecast} for {vertices}");
        let [seconds, bytes] = ["seconds", "bytes"].map(|name| report["forecast"][name].as_f64().unwrap());
        assert!(seconds > 0.0 && bytes > 1e5, "{report}");
        // What takes less than a second is not worth a line.
        assert_eq!(said.contains("the metric asks for about"), seconds >= 1.0, "{seconds}: {said}");
    }
    let (_, said, _, _) = adapted(0.1, &["--quiet"]);
    assert_eq!(said, "");
}
