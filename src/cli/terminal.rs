//! Standard output and standard error, and how much goes there.
use super::waiting::aside;
use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering::Relaxed};

/// How much is told; of all commands.
#[derive(clap::Args)]
pub struct How {
    /// No progress, no tables, no notes: errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Tell the stages of the work with seconds and memory; -vv also each sweep of an adaptation
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
}

static QUIET: AtomicBool = AtomicBool::new(false);
static VERBOSE: AtomicU8 = AtomicU8::new(0);
static HUSHED: AtomicBool = AtomicBool::new(false);

impl How {
    /// Holds from now on.
    pub fn set(&self) {
        QUIET.store(self.quiet, Relaxed);
        VERBOSE.store(self.verbose, Relaxed);
        if self.verbose > 0 {
            crate::tasks::tell_stages();
        }
    }
}

/// Says nothing from now on but errors: another process speaks for this one.
pub fn hush() {
    QUIET.store(true, Relaxed);
    HUSHED.store(true, Relaxed);
}

/// Whether another process speaks for this one.
pub fn is_hushed() -> bool {
    HUSHED.load(Relaxed)
}

/// Whether nothing but errors is wanted.
pub fn is_quiet() -> bool {
    QUIET.load(Relaxed)
}

/// Whether each sweep is to be told.
pub fn tells_sweeps() -> bool {
    VERBOSE.load(Relaxed) > 1 || std::env::var_os("GEO_ADAPT_TRACE").is_some()
}

/// What is printed cannot be written, say to a full disk.
#[derive(Debug, thiserror::Error)]
#[error("standard output: {0}; what was printed is not complete")]
pub struct PrintError(io::Error);

/// Writes to standard output what the user asked for; a closed pipe (`| head`) is no error.
///
/// # Errors
/// When it cannot be written.
pub fn print(text: &str) -> Result<(), PrintError> {
    let mut out = io::stdout().lock();
    check(aside(|| out.write_all(text.as_bytes()).and_then(|()| out.flush())))
}

/// The same of what the user may want to know, such as a table: not with --quiet.
///
/// # Errors
/// When it cannot be written.
pub fn say(text: &str) -> Result<(), PrintError> {
    if is_quiet() { Ok(()) } else { print(text) }
}

/// Whether writing to standard output went well enough.
pub fn check(done: io::Result<()>) -> Result<(), PrintError> {
    match done {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(PrintError(error)),
        _ => Ok(()),
    }
}

/// Writes a line to standard error in one call, so that lines of several processes do not mix. A failure is ignored: there is nobody to tell.
pub fn tell(line: impl Display) {
    let line = format!("{line}\n");
    let _ = aside(|| io::stderr().lock().write_all(line.as_bytes()));
}

/// Tells what the user should know.
pub fn note(notice: impl Display) {
    if !is_quiet() {
        tell(format_args!("geo-adapt: {} {notice}", painted("note:", CYAN, has_colours())));
    }
}

/// Tells why the command ends.
pub fn error(error: impl Display) {
    tell(format_args!("geo-adapt: {} {error}", painted("error:", RED, has_colours())));
}

/// Bold, as terminals know it since ECMA-48.
const RED: u8 = 31;
const CYAN: u8 = 36;

/// A word in a bold colour, or as it is.
fn painted(word: &str, colour: u8, is_coloured: bool) -> String {
    if is_coloured { format!("\x1b[1;{colour}m{word}\x1b[0m") } else { word.into() }
}

/// Whether standard error is a terminal that may have colours: NO_COLOR, if it says anything, forbids them (no-color.org).
fn has_colours() -> bool {
    let forbids = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    !forbids && !is_dumb && io::stderr().is_terminal()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_only_where_they_are_wanted() {
        assert_eq!(painted("error:", RED, true), "\x1b[1;31merror:\x1b[0m");
        assert_eq!(painted("error:", RED, false), "error:");
        // Standard error of a test is no terminal, or this says nothing.
        assert!(!has_colours() || io::stderr().is_terminal());
    }
}
