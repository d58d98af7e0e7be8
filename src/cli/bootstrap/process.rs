//! Runs of other programs: with a time limit, their output in a log.
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long between two looks at whether a program has ended.
const LOOK: Duration = Duration::from_millis(10);

/// Lines of the log that an error tells.
const LAST_LINES: usize = 3;

/// What is in the lines of that summary.
const SUMMARY: [&str; 4] = ["error summary", "Check the full log", " warnings", " errors"];

/// Why a program did not do its work.
#[derive(Debug)]
pub enum Failure {
    /// It could not be started.
    NotStarted(io::Error),
    /// The user ended it.
    Interrupted,
    /// It took longer than the limit, s, and was killed.
    TooLong(f64),
    /// It ended otherwise than with code 0.
    Ended(ExitStatus),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::NotStarted(error) => write!(f, "could not be started ({error})"),
            Self::Interrupted => write!(f, "was interrupted"),
            Self::TooLong(seconds) => write!(f, "had not ended after {seconds} s and was killed (--time-limit)"),
            Self::Ended(status) => match signal(*status) {
                Some(signal) => write!(f, "was killed or crashed (signal {signal})"),
                None => write!(f, "ended with {status}"),
            },
        }
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}

/// Runs a program until it ends, the limit is over or `stop` is set, so that it never outlives us; what it says is appended to the log, under a line with its command.
///
/// # Errors
/// [`Failure`]; also when the log cannot be written.
pub fn run(command: &mut Command, log: &Path, limit: Duration, stop: &AtomicBool) -> Result<(), Failure> {
    let open = || OpenOptions::new().create(true).append(true).open(log);
    let (mut out, err) = open().and_then(|out| Ok((out, open()?))).map_err(Failure::NotStarted)?;
    let _ = writeln!(out, "== {command:?}");
    let began = Instant::now();
    let child = command.stdin(Stdio::null()).stdout(out).stderr(err).spawn();
    let mut child = child.map_err(Failure::NotStarted)?;
    loop {
        match child.try_wait().map_err(Failure::NotStarted)? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(Failure::Ended(status)),
            None if stop.load(Ordering::Relaxed) || is_over(child.id(), began.elapsed(), limit) => {}
            None => {
                std::thread::sleep(LOOK);
                continue;
            }
        }
        let _ = child.kill();
        let _ = child.wait();
        let interrupted = stop.load(Ordering::Relaxed);
        return Err(if interrupted { Failure::Interrupted } else { Failure::TooLong(limit.as_secs_f64()) });
    }
}

/// Whether a program has had its time. What it waits for a busy machine counts by a quarter: else the mesh would depend on what else runs.
fn is_over(id: u32, elapsed: Duration, limit: Duration) -> bool {
    elapsed > limit && processor_time(id).is_none_or(|time| time.max(elapsed / WAITING) > limit)
}

/// A program that does nothing gets so many times its limit.
const WAITING: u32 = 4;

/// Processor time of a process so far, from Linux's /proc (proc(5): the times come 12 words behind the name, which is in parentheses, in
/// ticks of 1/100 s); none on other systems.
fn processor_time(id: u32) -> Option<Duration> {
    let text = fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    let mut words = text.rsplit_once(')')?.1.split_ascii_whitespace().skip(11);
    let mut ticks = || words.next()?.parse::<u64>().ok();
    Some(Duration::from_millis(10 * (ticks()? + ticks()?)))
}

/// Makes the log new.
pub fn begin(log: &Path) -> io::Result<()> {
    File::create(log).map(drop).map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", log.display())))
}

/// The last lines of the log that say something, errors before all else.
pub fn last_lines(log: &Path) -> String {
    let bytes = fs::read(log).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let from = text.rfind("== \"").unwrap_or(0);
    let says_something = |line: &&str| line.contains(char::is_alphanumeric) && !line.ends_with("---");
    let lines: Vec<&str> = text[from..].lines().skip(1).map(str::trim).filter(says_something).collect();
    // Behind its errors gmsh writes a summary, which tells their number.
    let is_error = |line: &&str| line.contains("rror") && !SUMMARY.iter().any(|word| line.contains(word));
    let errors: Vec<&str> = lines.iter().copied().filter(is_error).collect();
    let told = if errors.is_empty() { &lines } else { &errors };
    told[told.len().saturating_sub(LAST_LINES)..].join(" | ")
}

#[cfg(all(test, unix))]
mod tests {
    use super::super::super::workplace::Workplace;
    use super::*;

    fn shell(script: &str, limit: f64) -> (Result<(), Failure>, String) {
        let place = Workplace::new().unwrap();
        let log = place.file("log");
        begin(&log).unwrap();
        let done =
            run(Command::new("sh").args(["-c", script]), &log, Duration::from_secs_f64(limit), &AtomicBool::new(false));
        (done, last_lines(&log))
    }

    #[test]
    fn the_log_has_what_was_said_and_errors_come_first() {
        let (done, told) = shell("echo one; echo two >&2; echo three; echo four", 60.0);
        assert!(done.is_ok());
        assert_eq!(told, "two | three | four");
        let (done, told) =
            shell("echo Error: no room; echo 'Error : ---'; echo 'Error : 2 errors'; echo goodbye; exit 3", 60.0);
        assert_eq!(told, "Error: no room");
        assert!(done.unwrap_err().to_string().contains("exit status: 3"));
    }

    #[test]
    fn what_hangs_is_killed_and_what_crashes_is_told() {
        let began = Instant::now();
        let (done, _) = shell("exec sleep 60", 0.1);
        assert!(matches!(done, Err(Failure::TooLong(_))) && began.elapsed() < Duration::from_secs(30));
        let (done, _) = shell("kill -SEGV $$", 60.0);
        assert!(done.unwrap_err().to_string().contains("signal 11"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_waits_for_the_machine_has_more_time() {
        let own = || processor_time(std::process::id()).unwrap();
        let before = own();
        let began = Instant::now();
        while own() < before + Duration::from_millis(100) {
            std::hint::black_box((0..10_000).sum::<u64>());
        }
        assert!(began.elapsed() < Duration::from_secs(60));
        let second = Duration::from_secs(1);
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let is_over = |elapsed: Duration| is_over(child.id(), elapsed, second);
        assert!(!is_over(second / 2) && !is_over(3 * second) && is_over(5 * second));
        child.kill().unwrap();
        child.wait().unwrap();
    }

    #[test]
    fn what_runs_ends_with_an_interrupt() {
        let place = Workplace::new().unwrap();
        let mut command = Command::new("sleep");
        let done = run(command.arg("60"), &place.file("log"), Duration::MAX, &AtomicBool::new(true));
        assert!(matches!(done, Err(Failure::Interrupted)));
    }

    #[test]
    fn a_program_that_is_not_there_is_told_so() {
        let place = Workplace::new().unwrap();
        let done = run(
            &mut Command::new("/nowhere/mesher"),
            &place.file("log"),
            Duration::from_secs(1),
            &AtomicBool::new(false),
        );
        assert!(matches!(done, Err(Failure::NotStarted(_))));
    }
}
