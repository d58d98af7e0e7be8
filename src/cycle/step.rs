//! A step: a folder that is either done, or begun anew.
use super::Error;
use super::layout::Layout;
use super::process::{self, Log, Stop};
use super::run::Observer;
use super::solver::Call;
use crate::mesh::io::write_beside;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::{self, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What `done.json` says.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Done<T> {
    /// Seconds, of the attempt that came to its end.
    pub seconds: f64,
    /// What came of it.
    pub result: T,
}

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

/// What a finished step left, if it is finished.
pub fn finished<T: DeserializeOwned>(folder: &Path) -> Option<Done<T>> {
    serde_json::from_slice(&fs::read(folder.join("done.json")).ok()?).ok()
}

impl<'a> Steps<'a> {
    /// What a step gave: of the one that was done before, or else by doing it now, in an empty folder.
    pub fn step<T: Serialize + DeserializeOwned>(
        self,
        folder: PathBuf,
        work: impl FnOnce(&mut Running<'a>) -> Result<T, Error>,
    ) -> Result<Done<T>, Error> {
        let name = self.layout.name(&folder);
        if let Some(done) = finished(&folder) {
            return Ok(done);
        }
        if self.stop.asked.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        self.clear(&folder)?;
        let named = |error: io::Error| Error::Failed(format!("{}: {error}", folder.display()));
        fs::create_dir_all(&folder).map_err(named)?;
        let log = Log::create(&folder.join("log.txt")).map_err(named)?;
        self.observer.begin(&name, &folder.join("log.txt"));
        let start = Instant::now();
        let mut running = Running { folder: folder.clone(), steps: self, log };
        let result = work(&mut running).map_err(|error| match error {
            Error::Failed(message) => Error::Failed(format!("{name}: {message}")),
            Error::Interrupted => Error::Interrupted,
        })?;
        let done = Done { seconds: start.elapsed().as_secs_f64(), result };
        write_json(&folder.join("done.json"), &done)?;
        self.observer.end(&name, done.seconds);
        Ok(done)
    }

    /// Removes what an attempt left that did not come to its end, and ends what still works there.
    pub fn clear(self, folder: &Path) -> Result<(), Error> {
        if !folder.exists() {
            return Ok(());
        }
        if process::end_leftovers(folder, self.stop)? {
            self.observer
                .note(&format!("{}: ended what a killed run had left working there", self.layout.name(folder)));
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
        self.log.line(&format!("$ {line}")).map_err(failed)?;
        let status = process::run(call, &mut self.log, &self.folder, self.steps.stop)?;
        if status.success() {
            return Ok(());
        }
        let log = self.folder.join("log.txt");
        Err(Error::Failed(format!(
            "{} {}; the last lines of {}:\n{}\nits command is in {}; finished steps are kept: mend the cause and start the loop again",
            call.words.iter().take(2).cloned().collect::<Vec<_>>().join(" "),
            process::describe(status),
            log.display(),
            process::last_lines(&log),
            self.folder.join("command.txt").display()
        )))
    }

    /// Runs a subcommand of this program.
    pub fn geo_adapt(&mut self, words: Vec<String>) -> Result<(), Error> {
        let program =
            std::env::current_exe().map_err(|error| Error::Failed(format!("this program's own file: {error}")))?;
        let words = std::iter::once(text(&program)).chain(words).collect();
        self.call(&Call { words, env: Vec::new(), folder: self.folder.clone() })
    }
}

/// A path as a word of a command.
pub fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// Writes JSON beside, then renames.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Error> {
    let bytes =
        serde_json::to_vec_pretty(value).map_err(|error| Error::Failed(format!("{}: {error}", path.display())))?;
    Ok(write_beside(path, |file| file.write_all(&bytes).and_then(|()| file.write_all(b"\n")))?)
}
