//! How much a command tells, and to whom: --quiet, --verbose, --json and --report are the same in all of them, and files have no colours.

use crate::common::adapting::{Workplace, cube, isotropic, stderr, text};
use crate::common::program;
use serde_json::Value;
use std::process::Output;

/// A cube, a metric and a field of it.
struct Bench {
    work: Workplace,
    mesh: String,
    metric: String,
}

impl Bench {
    fn new() -> Self {
        let (work, mesh) = (Workplace::new(), cube(2, |_| 1));
        let metric = work.metric(&mesh, |_| isotropic(0.4));
        let path = text(&work.mesh(&mesh));
        Self { work, mesh: path, metric }
    }

    fn run(&self, words: &str, more: &[&str]) -> Output {
        let place = |word: &str| match word {
            "MESH" => self.mesh.clone(),
            "METRIC" => self.metric.clone(),
            word => match word.strip_prefix("NEW/") {
                Some(name) => text(&self.work.path(name)),
                None => word.into(),
            },
        };
        let run = program().args(words.split(' ').map(place)).args(more).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{words} {more:?}: {}", stderr(&run));
        run
    }
}

/// Commands that print figures, and take --json and --report.
const FIGURES: [&str; 6] = [
    "adapt MESH --metric METRIC --threads 1 -o NEW/a.meshb",
    "inspect MESH --metric METRIC",
    "metric show MESH METRIC",
    "metric geometry MESH -o NEW/g.solb",
    "field evaluate MESH --function sinfun3 -o NEW/u.solb",
    "transfer MESH METRIC MESH --metric -o NEW/t.solb",
];

/// Commands that print something and take neither.
const OTHERS: [&str; 4] = [
    "classify MESH --surface MESH -o NEW/c.meshb",
    "convert MESH NEW/c.vtu",
    "field pick METRIC --take 1 -o NEW/p.solb",
    "metric isotropic MESH METRIC -o NEW/i.solb",
];

#[test]
fn quiet_commands_tell_nothing() {
    let bench = Bench::new();
    for words in FIGURES.into_iter().chain(OTHERS) {
        let loud = bench.run(words, &[]);
        assert!(!loud.stdout.is_empty(), "{words}");
        for quiet in ["-q", "--quiet"] {
            let run = bench.run(words, &[quiet]);
            assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{words}: {}", stderr(&run));
        }
        // Before the command, too.
        let run = bench.run(&format!("--quiet {words}"), &[]);
        assert!(run.stdout.is_empty() && run.stderr.is_empty(), "{words}: {}", stderr(&run));
    }
}

#[test]
fn figures_are_the_same_on_the_terminal_and_in_a_file() {
    let bench = Bench::new();
    for words in FIGURES {
        let path = bench.work.path("figures.json");
        let run = bench.run(words, &["--json", "--report", &text(&path)]);
        let mut printed: Value = serde_json::from_slice(&run.stdout).expect(words);
        let mut written: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        // What passed until one or the other.
        for figures in [&mut printed, &mut written] {
            figures["seconds"].take();
        }
        assert_eq!(printed, written, "{words}");
        // JSON that is asked for is no table.
        assert!(!bench.run(words, &["--json", "--quiet"]).stdout.is_empty(), "{words}");
        let table = bench.run(words, &[]);
        assert!(serde_json::from_slice::<Value>(&table.stdout).is_err(), "{words}");
    }
}

#[test]
fn verbose_commands_tell_their_stages() {
    let bench = Bench::new();
    let words = "adapt MESH --metric METRIC --threads 1 -o NEW/a.meshb";
    let told = |more: &[&str]| stderr(&bench.run(words, more));
    assert!(!told(&[]).contains("stage "));
    let once = told(&["-v"]);
    assert!(once.contains("stage mesh read") && once.contains(" MB") && !once.contains("Split"), "{once}");
    assert!(told(&["-vv"]).contains("Split"));
}

#[cfg(target_os = "linux")]
#[test]
fn what_goes_into_a_file_has_no_colours() {
    let bench = Bench::new();
    let run = program().args(["inspect", &bench.mesh, "--metric", "none.sol"]).env_remove("NO_COLOR").output().unwrap();
    assert!(stderr(&run).starts_with("geo-adapt: error: none.sol"), "{}", stderr(&run));
    let terminal = |no_color: &str| {
        let line = format!("{} inspect {} --metric none.sol", env!("CARGO_BIN_EXE_geo-adapt"), bench.mesh);
        let mut script = std::process::Command::new("script");
        script.args(["-qec", &line, "/dev/null"]).env("NO_COLOR", no_color).env("TERM", "xterm");
        String::from_utf8_lossy(&script.output().unwrap().stdout).into_owned()
    };
    assert!(terminal("").contains("\u{1b}[1;31merror:\u{1b}[0m none.sol"), "{}", terminal(""));
    assert!(terminal("1").contains("geo-adapt: error: none.sol") && !terminal("1").contains('\u{1b}'));
}

/// Several processes of one run write to the same file: an error in pieces would be mixed with that of another. A datagram is what one write was.
#[cfg(unix)]
#[test]
fn an_error_is_written_in_one_piece() {
    use std::os::{fd::OwnedFd, unix::net::UnixDatagram};
    let (theirs, ours) = UnixDatagram::pair().unwrap();
    ours.set_nonblocking(true).unwrap();
    let stderr = std::process::Stdio::from(OwnedFd::from(theirs));
    let run = program().args(["inspect", "/nowhere/mesh.meshb"]).stderr(stderr).output().unwrap();
    assert_eq!(run.status.code(), Some(2));
    let mut text = [0; 4096];
    let length = ours.recv(&mut text).unwrap();
    let said = std::str::from_utf8(&text[..length]).unwrap();
    assert!(said.starts_with("geo-adapt: error: /nowhere/mesh.meshb") && said.ends_with('\n'), "{said}");
    assert!(ours.recv(&mut text).is_err(), "more was written");
}
