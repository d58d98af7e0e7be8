//! Standard output and standard error.
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

/// What is printed cannot be written, say to a full disk.
#[derive(Debug, thiserror::Error)]
#[error("standard output: {0}; what was printed is not complete")]
pub struct PrintError(io::Error);

/// Writes to standard output; a closed pipe (`| head`) is no error.
///
/// # Errors
/// When it cannot be written.
pub fn print(text: &str) -> Result<(), PrintError> {
    let mut out = io::stdout().lock();
    check(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Whether writing to standard output went well enough.
pub fn check(done: io::Result<()>) -> Result<(), PrintError> {
    match done {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(PrintError(error)),
        _ => Ok(()),
    }
}

/// Writes a line to standard error. A failure is ignored: there is nobody to tell.
pub fn tell(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Tells what the user should know.
pub fn note(notice: impl Display) {
    tell(format_args!("geo-adapt: note: {notice}"));
}
