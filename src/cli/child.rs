//! Work of OpenCASCADE in a child process, which is this same program. On a damaged file OpenCASCADE can crash, or never come back, and
//! neither can be caught within a process.
//!
//! It is started anew, or forked where the work begins before there is a second thread: that saves the time that OpenCASCADE takes to load.
//!
//! The child writes what is wrong with its input, if anything, into a file. How it ended tells the rest ([`Outcome`]): an interrupt, the end
//! of memory, a limit of time, or else a crash.
use super::interrupt::{self, Interrupted};
use super::workplace::Workplace;
use crate::memory::end;
use crate::process::{Outcome, Program, Runner, Tie, is_exhausted, own};
use std::error::Error;
use std::ffi::{OsStr, OsString};
use std::io;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Names the processor time, in seconds, that reading a CAD model may take.
const LIMIT: &str = "GEO_ADAPT_CAD_TIME_LIMIT";

/// Where it says nothing: many times what the largest models take.
const USUAL_LIMIT: f64 = 600.0;

/// The file that a child leaves its answer in.
const ANSWER: &str = "answer.txt";

/// Exit code of the system's loader where the program cannot be loaded. Ours was loaded once already.
const NOT_LOADED: i32 = 127;

/// What a child does with its arguments; an error tells what is wrong with the input.
pub type Work = fn(&[OsString]) -> Result<(), String>;

/// What there is to do.
pub struct Task<'a> {
    /// First argument of the child.
    pub name: &'static str,
    /// Its others.
    pub arguments: &'a [&'a OsStr],
    /// The file that the work is on.
    pub file: &'a Path,
    /// What it does with the file, as `reading it`.
    pub doing: &'static str,
    /// What a crash tells of the file, and the remedy.
    pub crash: &'static str,
}

/// What a child answers.
pub enum Answer {
    /// The work is done.
    Done,
    /// What is wrong with the input.
    Refused(String),
    /// No child could be started, which tells nothing of the input.
    NotStarted,
}

/// A child ended because the machine has no more memory.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct OutOfMemory(pub String);

impl Task<'_> {
    /// Has a child do the work; its files go into `place`.
    ///
    /// # Errors
    /// When the child came to no end of its own: why, and the remedy.
    pub fn run(&self, place: &Workplace) -> Result<Answer, Box<dyn Error>> {
        let Ok(program) = own() else { return Ok(Answer::NotStarted) };
        let mut command = Command::new(program);
        command.arg(self.name).arg(place.file(ANSWER)).args(self.arguments);
        self.end_of(place, |runner| runner.run(&mut command, |_| ()))
    }

    /// Has a child begin with the work, and does not wait for it. It is forked, so there must be one thread ([`may_fork`]).
    ///
    /// # Errors
    /// When there can be no child.
    ///
    /// [`may_fork`]: crate::process::may_fork
    pub fn begin(&self, place: &Workplace, work: Work) -> io::Result<Program> {
        let (answer, arguments) = (place.file(ANSWER), self.arguments.iter().map(OsString::from).collect::<Vec<_>>());
        Program::fork(Tie::Bound, move || code_of(work, &answer, &arguments))
    }

    /// Waits for a child that has begun.
    ///
    /// # Errors
    /// As [`Task::run`].
    pub fn finish(&self, place: &Workplace, program: Program) -> Result<Answer, Box<dyn Error>> {
        self.end_of(place, |runner| runner.wait_for(program))
    }

    /// What comes of a child that `run` waits for.
    fn end_of(
        &self,
        place: &Workplace,
        run: impl FnOnce(&Runner<'_>) -> io::Result<Outcome>,
    ) -> Result<Answer, Box<dyn Error>> {
        let stop = interrupt::end_at_once();
        let runner = Runner { tie: Tie::Bound, limit: Some(limit()?), stop, log: None };
        let outcome = match run(&runner) {
            Ok(_) if stop.load(Ordering::SeqCst) => Outcome::Interrupted,
            Ok(outcome) => outcome,
            Err(error) if is_exhausted(&error) => {
                return Err(
                    self.named(&format!("no process could be started for {} ({error})", self.doing), OutOfMemory)
                );
            }
            Err(_) => return Ok(Answer::NotStarted),
        };
        if outcome == Outcome::Code(i32::from(super::BAD_INPUT))
            && let Ok(text) = std::fs::read_to_string(place.file(ANSWER))
        {
            return Ok(Answer::Refused(text));
        }
        self.judge(outcome)
    }

    /// What the end of the child means.
    fn judge(&self, outcome: Outcome) -> Result<Answer, Box<dyn Error>> {
        let doing = self.doing;
        let remedy = "a damaged file can keep OpenCASCADE for ever";
        Err(match outcome {
            Outcome::Done => return Ok(Answer::Done),
            Outcome::Interrupted => self.named(&format!("{doing} was interrupted; nothing was written"), Interrupted),
            Outcome::Code(code) if code == i32::from(end::EXIT_CODE) || code == NOT_LOADED => {
                let text =
                    format!("{doing} takes more memory than there is: free some, or raise its limit (ulimit -v)");
                self.named(&text, OutOfMemory)
            }
            Outcome::Killed => {
                let text = format!("{doing} {outcome}: free some memory, or raise the limit that this runs under");
                self.named(&text, OutOfMemory)
            }
            Outcome::TooLong(limit) => {
                let seconds = limit.as_secs_f64();
                let text = format!(
                    "{doing} took more than {seconds} s of processor time and was ended: {remedy}; if it is just large, set {LIMIT} to more seconds"
                );
                self.named(&text, |text| text)
            }
            Outcome::OutOfTime => {
                self.named(&format!("{doing} {outcome}: {remedy}; if it is just large, raise that"), |text| text)
            }
            Outcome::Crashed(_) | Outcome::Code(_) => self.named(self.crash, |text| text),
        })
    }

    /// An error with the name of the file.
    fn named<E: Into<Box<dyn Error>>>(&self, text: &str, make: impl FnOnce(String) -> E) -> Box<dyn Error> {
        make(format!("{}: {text}", self.file.display())).into()
    }
}

/// The processor time that a child may take.
fn limit() -> Result<Duration, String> {
    let Some(text) = std::env::var_os(LIMIT).filter(|text| !text.is_empty()) else {
        return Ok(Duration::from_secs_f64(USUAL_LIMIT));
    };
    let seconds = text.to_str().and_then(|text| super::positive(text).ok());
    let seconds = seconds.ok_or_else(|| format!("{LIMIT}={}: give a positive number of seconds", text.display()))?;
    Ok(Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX))
}

/// If this process is a child for the work of this name: does it with the arguments, leaves the answer, and tells the exit code.
pub fn answer(name: &str, work: Work) -> Option<ExitCode> {
    let mut arguments = std::env::args_os().skip(1);
    if arguments.next()? != name {
        return None;
    }
    let answer = arguments.next()?;
    Some(ExitCode::from(code_of(work, Path::new(&answer), &arguments.collect::<Vec<_>>())))
}

/// Does the work of a child, leaves the answer in a file, and returns the exit code.
fn code_of(work: Work, answer: &Path, arguments: &[OsString]) -> u8 {
    let Err(refusal) = work(arguments) else { return 0 };
    // OpenCASCADE answers an allocation that failed by an error like any other, or leaves something out.
    if end::has_been_short() {
        end::leave(None);
    }
    // Without the answer the exit code says that there is something wrong all the same.
    let _ = std::fs::write(answer, refusal);
    super::BAD_INPUT
}
