//! A loop in a folder of its own.
use crate::common::adapting::{complaint, stderr};
use crate::common::program;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with a configuration.
pub struct Place {
    pub folder: tempfile::TempDir,
}

impl Place {
    pub fn new(config: &str) -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.write("loop.toml", config);
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn command(&self, words: &[&str]) -> Command {
        let mut command = program();
        command.arg("cycle").arg(self.path("loop.toml")).args(words);
        command
    }

    /// A run that must come to its end; what it printed.
    pub fn run(&self, words: &[&str]) -> String {
        let run = self.command(words).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        String::from_utf8(run.stdout).unwrap()
    }

    /// A run that must fail, and say why.
    pub fn refusal(&self, words: &[&str]) -> String {
        complaint(&self.command(words).output().unwrap())
    }

    pub fn report(&self) -> Value {
        serde_json::from_slice(&std::fs::read(self.path("out/report.json")).unwrap()).unwrap()
    }

    /// Every mesh, solution and metric by its place.
    pub fn products(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        files(&self.path("out"), &mut |path| {
            if path.extension().is_some_and(|ending| ["meshb", "solb", "png"].iter().any(|&known| ending == known)) {
                found.insert(path.strip_prefix(self.folder.path()).unwrap().to_owned(), std::fs::read(path).unwrap());
            }
        });
        found
    }
}

/// All files of a folder and of those in it.
pub fn files(folder: &Path, each: &mut impl FnMut(&Path)) {
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() { files(&path, each) } else { each(&path) }
    }
}
