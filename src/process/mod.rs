//! Other programs. Everything that this program starts, it starts here.
//!
//! [`Runner`] starts a program and waits for it. At an interrupt or a limit of time it ends the program with all that this has started. It
//! returns how the program ended ([`Outcome`]). A [`Program`] may be started first and waited for later. [`Group`] is a group of processes that a
//! later run finds again, [`Log`] a file for what programs say. While there are
//! [`HeldSignals`] an interrupt waits.
mod fork;
mod group;
mod log;
mod outcome;
mod run;
mod signals;

pub use fork::may_fork;
pub use group::{Group, who_has_open};
pub use log::{Log, errors_or_last_lines, last_line, last_lines};
pub use outcome::Outcome;
pub use run::{Program, Runner, Tie, is_exhausted, is_running};
pub use signals::HeldSignals;

use std::sync::atomic::AtomicBool;

/// The environment variable that names a file for the progress of a run, one JSON object a line.
pub const EVENTS: &str = "GEO_ADAPT_EVENTS";

/// This program, to be started again: on Linux the very one that runs, also when a newer one has taken its file meanwhile.
///
/// # Errors
/// When the system does not tell.
pub fn own() -> std::io::Result<std::path::PathBuf> {
    if cfg!(target_os = "linux") { Ok("/proc/self/exe".into()) } else { std::env::current_exe() }
}

/// What the user wants to end.
#[derive(Debug, Default)]
pub struct Stop {
    /// The work, where it can be ended in good order.
    pub asked: AtomicBool,
    /// The program that runs, too.
    pub now: AtomicBool,
}

impl Stop {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self { asked: AtomicBool::new(false), now: AtomicBool::new(false) }
    }
}
