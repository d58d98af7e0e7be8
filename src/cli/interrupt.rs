//! Ctrl-C, and the signals that ask a program to end: one answer for all commands.
//!
//! By itself an interrupt ends the program at once, with exit code 130; a program that it has started is ended first. A command that can
//! come to a good end says so ([`finish_on`]): then the first interrupt asks for that, and a second one ends it at once. SIGUSR1 asks for it
//! too, however often it comes: mpirun hands it on to its processes and leaves them their time, while it ends them one second after an interrupt.
use super::terminal;
use crate::process::{self, Stop};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::sync::{Mutex, PoisonError};

/// Exit code after an interrupt: 128 + SIGINT, as shells have it.
pub const EXIT_CODE: u8 = 130;

static STOP: Stop = Stop::new();

/// Whether the interrupt was told already.
static IS_TOLD: AtomicBool = AtomicBool::new(false);

/// What is said when the first interrupt only asks; none where it ends the program.
static FINISHES: Mutex<Option<&'static str>> = Mutex::new(None);

/// The error of work that an interrupt has ended.
#[derive(Debug, thiserror::Error)]
#[error("interrupted: {0}")]
pub struct Interrupted(pub String);

/// Listens to interrupts from now on.
pub fn listen() {
    let handler = || {
        let is_first = !STOP.asked.swap(true, SeqCst);
        let says = *FINISHES.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(says) = says.filter(|_| is_first) {
            IS_TOLD.store(true, SeqCst);
            tell(says);
            return;
        }
        STOP.now.store(true, SeqCst);
        // What runs for us is ended by who waits for it, and then so are we.
        if !process::is_running() || !is_first && says.is_none() {
            leave();
        }
    };
    // Where no handler can be set an interrupt ends the program, and the inputs are untouched all the same.
    let _ = ctrlc::set_handler(handler);
}

fn tell(what: &str) {
    if !terminal::is_hushed() {
        terminal::tell(format_args!("\ngeo-adapt: interrupted: {what}"));
    }
}

/// Ends the program from whichever thread, whatever the others are at.
fn leave() -> ! {
    if !IS_TOLD.load(SeqCst) {
        tell("nothing was written");
    }
    super::workplace::clear();
    #[cfg(unix)]
    // SAFETY: the process ends; nobody waits for what its threads hold.
    unsafe {
        libc::_exit(i32::from(EXIT_CODE))
    }
    #[cfg(not(unix))]
    std::process::exit(i32::from(EXIT_CODE))
}

/// From now on the first interrupt asks the command to come to its end, and says this.
pub fn finish_on(says: &'static str) -> &'static AtomicBool {
    *FINISHES.lock().unwrap_or_else(PoisonError::into_inner) = Some(says);
    #[cfg(unix)]
    // SAFETY: the handler does nothing but to store in an atomic, which a handler may.
    unsafe {
        libc::signal(libc::SIGUSR1, ask as *const () as libc::sighandler_t);
    }
    &STOP.asked
}

#[cfg(unix)]
extern "C" fn ask(_: libc::c_int) {
    STOP.asked.store(true, SeqCst);
}

/// From now on an interrupt does nothing here: the command listens itself.
#[cfg(all(feature = "serve", target_os = "linux"))]
pub fn let_commands_end() {
    *FINISHES.lock().unwrap_or_else(PoisonError::into_inner) = Some("what is at work waits for the next start");
}

/// From now on an interrupt ends the program at once again. The flag returned is set when that has to wait for a program that runs.
pub fn end_at_once() -> &'static AtomicBool {
    *FINISHES.lock().unwrap_or_else(PoisonError::into_inner) = None;
    &STOP.now
}

/// What the user wants to end.
pub fn stop() -> &'static Stop {
    &STOP
}

/// The exit code as a command returns it.
pub fn exit_code() -> ExitCode {
    ExitCode::from(EXIT_CODE)
}
