//! Child processes: what they say goes to a log, and none outlives its step.
use super::Error;
use super::solver::Call;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

/// How long between two looks at a child.
const LOOK: Duration = Duration::from_millis(20);

/// Lines of a log that an error tells.
const LAST_LINES: usize = 12;

/// Bytes at the end of a log that they are looked for in.
const END: u64 = 16 << 10;

/// What the user wants to end.
#[derive(Debug, Default)]
pub struct Stop {
    /// The loop, after the running child.
    pub asked: AtomicBool,
    /// The child too.
    pub now: AtomicBool,
}

/// The log of a step, locked while any process writes to it.
///
/// The lock is that of flock(2), which belongs to what is open, not to a process: children have it as their output, so it is held as long as
/// one of them lives, also when the loop was killed.
pub struct Log {
    file: File,
}

impl Log {
    /// The log of a new step.
    pub fn create(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        file.lock()?;
        Ok(Self { file })
    }

    /// Adds a line.
    pub fn line(&mut self, text: &str) -> io::Result<()> {
        writeln!(self.file, "{text}")
    }
}

/// Ends what a killed run may have left working in a folder. Whether there was something.
pub fn end_leftovers(folder: &Path, stop: &Stop) -> Result<bool, Error> {
    let log = folder.join("log.txt");
    let Ok(file) = File::open(&log) else { return Ok(false) };
    match file.try_lock() {
        Ok(()) => return Ok(false),
        Err(TryLockError::WouldBlock) => {}
        // A file system without locks.
        Err(TryLockError::Error(_)) => return Ok(false),
    }
    if let Ok(text) = std::fs::read_to_string(folder.join("pid"))
        && let Ok(group) = text.trim().parse::<u32>()
    {
        // The lock is held, so somebody of that group lives, and the number is still theirs.
        kill_group(group);
    }
    while matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
        if stop.asked.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        std::thread::sleep(LOOK);
    }
    Ok(true)
}

/// Runs a program to its end, its output in the log, its process group in the file `pid` of the folder.
pub fn run(call: &Call, log: &mut Log, folder: &Path, stop: &Stop) -> Result<ExitStatus, Error> {
    let [program, words @ ..] = &call.words[..] else { return Err(Error::Failed("no program is named".into())) };
    let failed = |error: io::Error| {
        Error::Failed(format!("{program} could not be started ({error}): is it installed and on the PATH?"))
    };
    let output = || log.file.try_clone().map(Stdio::from).map_err(failed);
    let mut command = Command::new(program);
    command.args(words).envs(call.env.iter().map(|(name, value)| (name, value))).current_dir(&call.folder);
    command.stdin(Stdio::null()).stdout(output()?).stderr(output()?);
    // A group of its own: an interrupt at the terminal is for the loop alone.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().map_err(failed)?;
    // Whoever comes after a kill before this line waits until the child has ended.
    let _ = std::fs::write(folder.join("pid"), child.id().to_string());
    let status = wait(&mut child, stop);
    let _ = std::fs::remove_file(folder.join("pid"));
    status
}

fn wait(child: &mut Child, stop: &Stop) -> Result<ExitStatus, Error> {
    let failed = |error: io::Error| Error::Failed(format!("waiting for a program failed: {error}"));
    loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            return Ok(status);
        }
        if stop.now.load(Relaxed) {
            kill_group(child.id());
            let _ = child.kill();
            child.wait().map_err(failed)?;
            return Err(Error::Interrupted);
        }
        std::thread::sleep(LOOK);
    }
}

/// Kills a process group, by the shell, which has that built in.
fn kill_group(group: u32) {
    let mut shell = Command::new("sh");
    shell.args(["-c", r#"kill -s KILL -- "-$0""#, &group.to_string()]).stdout(Stdio::null()).stderr(Stdio::null());
    // Where that fails the group is waited for.
    drop(shell.status());
}

/// How a program ended, in words.
pub fn describe(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("was killed or crashed (signal {signal})");
    }
    match status.code() {
        Some(code) => format!("ended with exit code {code}"),
        None => format!("ended with {status}"),
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
    (!line.starts_with("$ ")).then(|| line.to_owned())
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
}
