//! Progress for programs: one JSON object a line, to the file that `GEO_ADAPT_EVENTS` names. The service reads it.
use crate::process;
use serde_json::Value;
use std::fs::File;
use std::io::Write;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// What is told often is told at most this often.
const OFTEN: Duration = Duration::from_millis(100);

/// The file, and when something was told last that is told often.
struct Told {
    file: File,
    often: Option<Instant>,
}

fn told() -> Option<&'static Mutex<Told>> {
    static TOLD: OnceLock<Option<Mutex<Told>>> = OnceLock::new();
    // A process that was forked is told of it later than the one that it is of.
    let path = std::env::var_os(process::EVENTS)?;
    let open = || {
        let file = File::options().create(true).append(true).open(path).ok()?;
        Some(Mutex::new(Told { file, often: None }))
    };
    TOLD.get_or_init(open).as_ref()
}

fn write(told: &mut Told, event: &Value) {
    // Nobody needs it who does not get it.
    let _ = told.file.write_all(format!("{event}\n").as_bytes());
}

/// Tells an event, where somebody listens.
pub fn tell(event: impl FnOnce() -> Value) {
    if let Some(told) = told() {
        write(&mut told.lock().unwrap_or_else(PoisonError::into_inner), &event());
    }
}

/// Tells an event of which there are many, unless one was told just now.
pub fn tell_often(event: impl FnOnce() -> Value) {
    let Some(told) = told() else { return };
    let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
    if told.often.is_none_or(|at| at.elapsed() >= OFTEN) {
        told.often = Some(Instant::now());
        write(&mut told, &event());
    }
}
