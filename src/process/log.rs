//! Logs: the output of programs, in a file.
use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::Stdio;

/// Lines of a log that an error tells.
const LAST_LINES: usize = 12;

/// Of those that are put in one line.
const IN_ONE_LINE: usize = 3;

/// Bytes at the end of a log that they are looked for in.
const END: u64 = 16 << 10;

/// What begins the line of a command in a log.
const COMMAND: &str = "$ ";

/// A log, locked while any process writes to it.
///
/// The lock is that of flock(2), which belongs to what is open, not to a process: children have it as their output, so it is held as long as
/// one of them lives, also when the program that started them was killed.
pub struct Log {
    file: File,
}

impl Log {
    /// A new log, or the end of one that is there.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        // Without it, on a file system that has no locks, all else is the same.
        let _ = file.try_lock();
        Ok(Self { file })
    }

    /// A log without what was in it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(path: &Path) -> io::Result<Self> {
        File::create(path)?;
        Self::open(path)
    }

    /// Adds the line of a command.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn command(&mut self, line: &str) -> io::Result<()> {
        writeln!(self.file, "{COMMAND}{line}")
    }

    /// A way for a program to write to it.
    pub(super) fn sink(&self) -> io::Result<Stdio> {
        self.file.try_clone().map(Stdio::from)
    }
}

/// The end of a log: as much as its last lines can be.
fn end_of(log: &Path) -> String {
    let read = |log: &Path| -> io::Result<Vec<u8>> {
        let mut file = File::open(log)?;
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(END)))?;
        let mut bytes = Vec::new();
        file.take(END).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    String::from_utf8_lossy(&read(log).unwrap_or_default()).into_owned()
}

/// The last line of a log that says something; none where there is only the command.
pub fn last_line(log: &Path) -> Option<String> {
    let text = end_of(log);
    // Programs with a bar of their own overwrite a line.
    let line = text.split(['\n', '\r']).map(str::trim).rfind(|line| !line.is_empty())?;
    (!line.starts_with(COMMAND)).then(|| line.to_owned())
}

/// The last lines of a log.
pub fn last_lines(log: &Path) -> String {
    let text = end_of(log);
    let lines: Vec<&str> = text.lines().map(str::trim_end).filter(|line| !line.is_empty()).collect();
    lines[lines.len().saturating_sub(LAST_LINES)..]
        .iter()
        .map(|line| format!("    {line}"))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The last lines of the last program, in one line, none of them twice in a row. Errors come first, but lines with one of these words, which only sum errors up, do
/// not count as errors.
pub fn errors_or_last_lines(log: &Path, sums: &[&str]) -> String {
    let text = end_of(log);
    let from = text.rfind(&format!("\n{COMMAND}")).map_or(0, |at| at + 1);
    let says_something = |line: &&str| line.contains(char::is_alphanumeric) && !line.ends_with("---");
    let lines = text[from..].lines().filter(|line| !line.starts_with(COMMAND));
    let lines: Vec<&str> = lines.map(str::trim).filter(says_something).collect();
    let is_error = |line: &&str| line.contains("rror") && !sums.iter().any(|word| line.contains(word));
    let errors: Vec<&str> = lines.iter().copied().filter(is_error).collect();
    let mut told = if errors.is_empty() { lines } else { errors };
    // Several processes say the same.
    told.dedup();
    told[told.len().saturating_sub(IN_ONE_LINE)..].join(" | ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_log_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.txt");
        let told = |text: &str| {
            std::fs::write(&path, text).unwrap();
            last_line(&path)
        };
        assert_eq!(last_line(&path), None, "there is no file");
        assert_eq!(told("$ solver --fast\n"), None);
        assert_eq!(told("$ solver\nstep 1\nstep 2\n\n"), Some("step 2".into()));
        assert_eq!(told("10 %\r20 %\r"), Some("20 %".into()));
        let long = format!("{}\nlast\n", "x".repeat(3 * END as usize));
        assert_eq!(told(&long), Some("last".into()));
        assert!(last_lines(&path).len() < 2 * END as usize && last_lines(&path).ends_with("    last"));
    }

    #[test]
    fn errors_of_the_last_program_come_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let told = |text: &str| {
            std::fs::write(&path, text).unwrap();
            errors_or_last_lines(&path, &[" errors"])
        };
        assert_eq!(told("$ mesher\none\ntwo\nthree\nfour\n"), "two | three | four");
        let text = "$ mesher\nError: before\n$ mesher again\nError: no room\nError : ---\nError : 2 errors\ngoodbye\n";
        assert_eq!(told(text), "Error: no room");
        assert_eq!(told("Error: no licence\nError: no licence\nabout\nError: no licence\n"), "Error: no licence");
    }
}
