//! Runs of several processes, for tests.
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// How long a run may take in which something fails: what hangs, hangs for ever.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Whether there is an mpirun. Under tests/run there must be.
pub fn is_there() -> bool {
    let there = Command::new("mpirun").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    assert!(there || std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run has set up mpirun");
    if !there {
        eprintln!("skipped: mpirun is not there (apt-get install openmpi-bin)");
    }
    there
}

/// `mpirun` on so many processes, whose command is still to come: more of them than cores, and as root in CI.
pub fn mpirun(ranks: usize) -> Command {
    let mut command = Command::new("mpirun");
    command.args(["--oversubscribe", "-n", &ranks.to_string()]).stdin(Stdio::null());
    command.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")]);
    command.env(SESSIONS, sessions());
    command
}

/// The variable that tells Open MPI where to keep the folder of its sessions.
pub const SESSIONS: &str = "OMPI_MCA_orte_tmpdir_base";

/// A folder for the sessions of one mpirun: two that begin at once, and make the same folder, fail.
fn sessions() -> PathBuf {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("geo-adapt-mpi-{}", std::process::id())).join(call.to_string());
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The words behind the name in /proc/ID/stat: state, parent, group.
fn stat(id: u32) -> Option<Vec<String>> {
    let text = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    Some(text.rsplit_once(") ")?.1.split(' ').map(str::to_owned).collect())
}

/// Whether a process works.
pub fn works(id: u32) -> bool {
    stat(id).is_some_and(|words| words[0] != "Z")
}

/// The processes that one has started and that work.
pub fn children(parent: u32) -> Vec<u32> {
    let all = fs::read_dir("/proc").unwrap().flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let is_ours = |words: Vec<String>| words[0] != "Z" && words[1] == parent.to_string();
    all.filter(|&id| stat(id).is_some_and(is_ours)).collect()
}

/// Waits until something holds.
pub fn until(what: &str, patience: Duration, holds: impl FnMut() -> bool) {
    let (began, mut holds) = (Instant::now(), holds);
    while !holds() {
        assert!(began.elapsed() < patience, "not after {patience:?}: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The end of a run that has been made to end.
pub fn end(run: &mut Child) -> ExitStatus {
    until("it ends", PATIENCE, || run.try_wait().unwrap().is_some());
    run.wait().unwrap()
}

/// Sends a signal: KILL, TERM, INT.
pub fn signal(name: &str, id: u32) {
    // It may have ended by itself.
    let _ = Command::new("kill").args(["-s", name, &id.to_string()]).stderr(Stdio::null()).status();
}

/// The files of a folder by their names.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
