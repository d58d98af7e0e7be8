//! A mesh grows as long as there is memory for it.
#![cfg(target_os = "linux")]
mod common;

use common::adapting::{Workplace, cube, isotropic, stderr, text};
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
