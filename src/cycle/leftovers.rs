//! What a killed run has left behind: programs that still run, and files that were being written.
use super::error::Error;
use super::layout::Layout;
use crate::process::{Group, Stop, who_has_open};
use std::fs::{self, File, TryLockError};
use std::path::Path;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// The file with the group of the program that runs in a step.
pub const PID: &str = "pid";

/// How long a program may take to end: mpirun ends its own ones first, which are in other groups.
const LENIENCY: Duration = Duration::from_secs(4);

/// How long between two looks.
const LOOK: Duration = Duration::from_millis(20);

/// After so long the user is told what is waited for.
const PATIENCE: Duration = Duration::from_secs(5);

/// Ends programs that still run in the folder of a step and write to its log. Returns whether there were any; `tell` is told about a wait.
///
/// # Errors
/// [`Error::Interrupted`] when the user does not want to wait.
pub fn end(folder: &Path, stop: &Stop, tell: &dyn Fn(&str)) -> Result<bool, Error> {
    let log = folder.join("log.txt");
    let Ok(file) = File::open(&log) else { return Ok(false) };
    match file.try_lock() {
        Ok(()) => return Ok(false),
        Err(TryLockError::WouldBlock) => {}
        // A file system without locks.
        Err(TryLockError::Error(_)) => return Ok(false),
    }
    let text = fs::read_to_string(folder.join(PID)).ok();
    let mut group = text.as_deref().and_then(Group::parse).filter(|group| group.is_there(&log));
    let family = group.as_ref().map(Group::family).unwrap_or_default();
    group.iter().for_each(Group::ask_to_end);
    let (began, mut is_told) = (Instant::now(), false);
    while matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        if began.elapsed() > LENIENCY
            && let Some(group) = group.take()
        {
            group.kill();
        }
        if stop.asked.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        if !is_told && began.elapsed() > PATIENCE {
            is_told = true;
            let who = who_has_open(&log).unwrap_or_else(|| "a program on another machine, or of another user".into());
            tell(&format!("waits for {who}, which still writes to {}: end it, or end this (Ctrl-C)", log.display()));
        }
        std::thread::sleep(LOOK);
    }
    family.end();
    Ok(true)
}

/// Removes files of the loop's own folder that a killed run was writing. Only while the lock of the loop is held.
pub fn remove_temporaries(layout: &Layout) {
    let ours = [layout.state(), layout.page(), layout.figures()];
    let ours = ours.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
    let ours: Vec<String> = ours.collect();
    for entry in fs::read_dir(layout.root()).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let inside = name.strip_prefix('.').and_then(|rest| rest.strip_suffix(".tmp"));
        if inside.is_some_and(|inside| {
            ours.iter().any(|ours| inside.strip_prefix(ours.as_str()).is_some_and(|rest| rest.starts_with('.')))
        }) {
            let _ = fs::remove_file(entry.path());
        }
    }
}
