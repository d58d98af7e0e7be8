//! The runs of several ranks, by mpirun.
use super::PART;
use crate::mpirun::SESSIONS;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How long a run may take in which a rank fails: what hangs, hangs for ever.
const PATIENCE: Duration = Duration::from_secs(30);

/// How a run ended.
struct End {
    code: Option<i32>,
    output: String,
    errors: String,
}

/// Whether there is an mpirun. Under tests/run there must be.
fn has_mpirun() -> bool {
    let there = Command::new("mpirun").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    assert!(there || std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run has set up mpirun");
    if !there {
        eprintln!("skipped: mpirun is not there (apt-get install openmpi-bin)");
    }
    there
}

/// Runs a test of this program as so many ranks. None where there is no mpirun.
fn run(test: &str, part: &str, ranks: usize, patience: Duration) -> Option<End> {
    if !has_mpirun() {
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let mut child = Command::new("mpirun")
        // More ranks than cores, and as root in CI.
        .args(["--oversubscribe", "-n", &ranks.to_string()])
        .envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"), (PART, part)])
        .env(SESSIONS, folder.path())
        .arg(std::env::current_exe().unwrap())
        // On the main thread, and nothing of it kept back.
        .args([&format!("ranks::parts::{test}"), "--exact", "--nocapture", "--test-threads=1"])
        .stdin(Stdio::null())
        .stdout(File::create(file("output")).unwrap())
        .stderr(File::create(file("errors")).unwrap())
        .spawn()
        .unwrap();
    let began = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break Some(status);
        }
        if began.elapsed() > patience {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let text = |name: &str| String::from_utf8_lossy(&fs::read(file(name)).unwrap()).into_owned();
    let (output, errors) = (text("output"), text("errors"));
    let status = status.unwrap_or_else(|| panic!("{part}: not at its end after {patience:?}:\n{output}\n{errors}"));
    Some(End { code: status.code(), output, errors })
}

/// All ranks come to their end with all that they had to hear.
fn all_hear(part: &str, ranks: usize) {
    let Some(end) = run("play", part, ranks, Duration::from_secs(300)) else { return };
    assert_eq!(end.code, Some(0), "{part}:\n{}\n{}", end.output, end.errors);
    for rank in 0..ranks {
        let line = format!("rank {rank} of {ranks} heard all");
        assert_eq!(end.output.matches(&line).count(), 1, "{line}:\n{}\n{}", end.output, end.errors);
    }
}

/// Rank 1 of three fails while the others wait for it: the run ends soon, none of its processes is left, and mpirun has this code.
fn all_end(test: &str, part: &str, code: Option<i32>) -> Option<End> {
    let end = run(test, part, 3, PATIENCE)?;
    match code {
        Some(code) => assert_eq!(end.code, Some(code), "{part}:\n{}\n{}", end.output, end.errors),
        None => assert_ne!(end.code, Some(0), "{part}:\n{}\n{}", end.output, end.errors),
    }
    let pids: Vec<&str> = end.output.lines().filter_map(|line| Some(line.split_once("process ")?.1.trim())).collect();
    assert_eq!(pids.len(), 3, "{part}:\n{}\n{}", end.output, end.errors);
    let began = Instant::now();
    while pids.iter().any(|pid| Path::new("/proc").join(pid).exists()) {
        assert!(began.elapsed() < PATIENCE, "{part}: a process of {pids:?} still runs");
        std::thread::sleep(Duration::from_millis(10));
    }
    Some(end)
}

#[test]
fn every_message_comes_to_its_rank_whole_and_in_order() {
    all_hear("exchange", 3);
    all_hear("pieces", 4);
}

#[test]
fn ranks_agree_and_add_up() {
    all_hear("agree", 3);
    all_hear("together", 3);
}

/// Long: it takes 5 GB.
#[test]
fn a_message_of_more_than_2_gib_comes_whole() {
    if std::env::var_os("GEO_ADAPT_LONG").is_some() {
        all_hear("large", 2);
    }
}

#[test]
fn one_rank_under_mpirun_is_alone() {
    let Some(end) = run("play", "start", 1, PATIENCE) else { return };
    assert!(end.code == Some(0) && end.output.contains("rank 0 of 1 started"), "{}\n{}", end.output, end.errors);
}

#[test]
fn no_rank_waits_for_one_that_is_killed_or_exits() {
    all_end("play", "killed", None);
    all_end("play", "exits", Some(5));
}

#[test]
fn no_rank_waits_for_one_that_panics() {
    if let Some(end) = all_end("play", "panics", None) {
        assert!(end.errors.contains("rank 1 has a mistake"), "{}", end.errors);
    }
}

#[test]
fn no_rank_waits_for_one_that_aborts() {
    all_end("play", "aborts", Some(7));
    all_end("play", "aborts on a thread", Some(7));
}

#[test]
fn a_rank_that_leaves_ends_all_and_its_error_is_seen() {
    if let Some(end) = all_end("leave", "leaves", Some(4)) {
        assert!(end.errors.contains("rank 1 found no file"), "{}", end.errors);
        assert!(!end.errors.contains("still needs it"), "{}", end.errors);
    }
}

#[test]
fn ranks_with_different_calls_end() {
    if let Some(end) = all_end("play", "other call", None) {
        assert!(end.errors.contains("for something else"), "{}", end.errors);
    }
}
