//! A step: a folder that is either done, or begun anew.
use super::data::Call;
use super::done::{Done, read, write_json};
use super::error::Error;
use super::launch;
use super::layout::{DONE, Layout};
use super::leftovers;
use super::observer::Observer;
use crate::memory;
use crate::process::{Log, Outcome, Runner, Stop, Tie, is_exhausted, last_lines};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;

/// The loop as its steps see it.
#[derive(Clone, Copy)]
pub struct Steps<'a> {
    /// Where the folders are.
    pub layout: &'a Layout,
    /// Who is told.
    pub observer: &'a dyn Observer,
    /// Whether to end.
    pub stop: &'a Stop,
}

/// A step that is being done.
pub struct Running<'a> {
    /// Its folder.
    pub folder: PathBuf,
    steps: Steps<'a>,
    log: Log,
}

impl<'a> Steps<'a> {
    /// The result of a step. If the step was done before, it is that result; else the step is done now, in an empty folder, and whatever is
    /// there of later steps is removed first.
    pub fn step<T: Serialize + DeserializeOwned>(
        self,
        folder: PathBuf,
        work: impl FnOnce(&mut Running<'a>) -> Result<T, Error>,
    ) -> Result<Done<T>, Error> {
        let name = self.layout.name(&folder);
        match read(&folder) {
            Ok(Some(done)) => return Ok(done),
            Ok(None) => {}
            Err(error) => self.observer.note(&format!(
                "{}: cannot be read ({error}): this step is done again, and all that follow from it",
                folder.join(DONE).display()
            )),
        }
        if self.stop.asked.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        for later in self.layout.after(&folder) {
            self.clear(&later)?;
        }
        self.clear(&folder)?;
        let named = |error: io::Error| Error::Failed(format!("{}: {error}", folder.display()));
        fs::create_dir_all(&folder).map_err(named)?;
        let log = Log::open(&folder.join("log.txt")).map_err(named)?;
        self.observer.begin(&name, &folder.join("log.txt"));
        let start = Instant::now();
        let mut running = Running { folder: folder.clone(), steps: self, log };
        let result = work(&mut running).map_err(|error| match error {
            Error::Failed(message) => Error::Failed(format!("{name}: {message}")),
            Error::OutOfMemory(message) => Error::OutOfMemory(format!("{name}: {message}")),
            Error::Interrupted => Error::Interrupted,
        })?;
        let done = Done { seconds: start.elapsed().as_secs_f64(), result };
        write_json(&folder.join(DONE), &done)?;
        self.observer.end(&name, done.seconds);
        Ok(done)
    }

    /// Removes what an attempt left that did not come to its end, and ends what still works there.
    pub fn clear(self, folder: &Path) -> Result<(), Error> {
        if !folder.exists() {
            return Ok(());
        }
        let tell = |text: &str| self.observer.note(&format!("{}: {text}", self.layout.name(folder)));
        if leftovers::end(folder, self.stop, &tell)? {
            tell("ended what a killed run had left working there");
        }
        fs::remove_dir_all(folder).map_err(|error| Error::Failed(format!("{}: {error}", folder.display())))
    }
}

impl Running<'_> {
    /// A file of the step.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Runs a program; its command is in command.txt, so that it can be typed again.
    pub fn call(&mut self, call: &Call) -> Result<(), Error> {
        let line = call.line();
        let failed = |error: io::Error| Error::Failed(format!("{}: {error}", self.folder.display()));
        let open = OpenOptions::new().create(true).append(true).open(self.folder.join("command.txt"));
        open.and_then(|mut file| writeln!(file, "{line}")).map_err(failed)?;
        self.log.command(&line).map_err(failed)?;
        let outcome = self.start(call)?;
        if outcome == Outcome::Done {
            return Ok(());
        }
        if outcome == Outcome::Interrupted && self.steps.stop.now.load(Relaxed) {
            return Err(Error::Interrupted);
        }
        let log = self.folder.join("log.txt");
        let message = format!(
            "{} {outcome}; the last lines of {}:\n{}\nits command is in {}; finished steps are kept: mend the cause and start the loop again",
            call.words[..call.words.len().min(2 + own_place(call).unwrap_or(0))].join(" "),
            log.display(),
            last_lines(&log),
            self.folder.join("command.txt").display()
        );
        Err(if is_memory_end(call, outcome) { Error::OutOfMemory(message) } else { Error::Failed(message) })
    }

    /// Runs a program to its end, its output in the log, its process group in a file of the folder.
    fn start(&self, call: &Call) -> Result<Outcome, Error> {
        let [program, words @ ..] = &call.words[..] else { return Err(Error::Failed("no program is named".into())) };
        let mut command = Command::new(program);
        command.args(words).envs(call.env.iter().map(|(name, value)| (name, value))).current_dir(&call.folder);
        let runner = Runner { tie: Tie::Loose, limit: None, stop: &self.steps.stop.now, log: Some(&self.log) };
        let file = self.folder.join(leftovers::PID);
        // Whoever comes after a kill before this is written waits until the program has ended.
        let outcome = runner.run(&mut command, |group| drop(fs::write(&file, group.text())));
        let _ = fs::remove_file(&file);
        outcome.map_err(|error| {
            if is_exhausted(&error) {
                return Error::OutOfMemory(format!("{program} could not be started ({error}): free some memory"));
            }
            Error::Failed(format!("{program} could not be started ({error}): is it installed and on the PATH?"))
        })
    }

    /// Runs a subcommand of this program.
    pub fn geo_adapt(&mut self, words: Vec<String>) -> Result<(), Error> {
        let words = std::iter::once(launch::own()?).chain(words).collect();
        self.call(&Call { words, env: Vec::new(), folder: self.folder.clone() })
    }
}

/// Where in a command this program is named: at its beginning, or behind mpirun.
fn own_place(call: &Call) -> Option<usize> {
    let own = launch::own().ok()?;
    call.words.iter().position(|word| *word == own)
}

/// Whether a command has ended for want of memory. Of several processes the system kills one, and mpirun tells it by its exit code.
fn is_memory_end(call: &Call, outcome: Outcome) -> bool {
    let ends = [memory::end::EXIT_CODE.into(), launch::KILLED];
    let is_end = matches!(outcome, Outcome::Code(code) if ends.contains(&code));
    outcome == Outcome::Killed || is_end && own_place(call).is_some()
}
