//! `geo-adapt tune` measures what it is asked to and prints what can be given to `adapt`.

use crate::common::adapting::{Workplace, stderr, text};
use geo_adapt::mesh::samples::cube;
use serde_json::Value;
use std::process::Command;

fn tune(work: &Workplace, arguments: &[&str]) -> std::process::Output {
    let mesh = work.mesh(&cube(3));
    let mut command: Command = crate::common::program();
    command.arg("tune").arg(mesh).args(["--analytic", "polar-1", "--complexity", "1000", "--threads", "2"]);
    command.args(arguments).output().unwrap()
}

#[test]
fn the_best_can_be_given_to_adapt() {
    let work = Workplace::new();
    let report = text(&work.path("tune.json"));
    let run = tune(&work, &["--grains", "8,64", "--strategies", "flat,two-level", "--report", &report, "--quiet"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(stderr(&run).is_empty(), "{}", stderr(&run));
    let told: Vec<Value> = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    let of = |scheduler: &str| told.iter().filter(|timing| timing["scheduler"] == scheduler).count();
    let backends = told.iter().filter(|t| t["scheduler"] == "deterministic").map(|t| t["backend"].to_string());
    let backends = backends.collect::<std::collections::BTreeSet<_>>().len();
    assert!(backends >= 2, "stealing and rayon at least");
    assert_eq!([of("sequential"), of("deterministic"), of("speculative")], [1, 2 * backends, 4 * backends]);
    for timing in &told {
        let seconds: Vec<f64> = serde_json::from_value(timing["seconds"].clone()).unwrap();
        assert!(seconds.iter().all(|&s| s >= 0.0) && seconds.iter().sum::<f64>() > 0.0, "{timing}");
    }
    let printed = String::from_utf8(run.stdout).unwrap();
    let best: Vec<_> = printed.lines().filter(|line| line.starts_with("best, ")).collect();
    assert_eq!(best.len(), 2, "{printed}");
    for line in best {
        let flags: Vec<_> = line[line.find("--").unwrap()..].split_whitespace().collect();
        let mesh = work.mesh(&cube(3));
        let mut command =
            work.command(&mesh, &[&["--analytic", "linear", "--complexity", "300", "-q"], &flags[..]].concat());
        let run = command.output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{line}: {}", stderr(&run));
    }
}

#[test]
fn what_is_no_grain_is_refused() {
    let work = Workplace::new();
    for wrong in ["0", "x", "-5", "swapping=3"] {
        let run = tune(&work, &["--grains", wrong]);
        assert_eq!(run.status.code(), Some(2), "{wrong}");
        assert!(stderr(&run).contains(wrong.split('=').next().unwrap()), "{}", stderr(&run));
    }
}
