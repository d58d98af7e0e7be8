//! Runs that are killed at any moment leave whole files, old or new, and nothing that the next run does not clear.
#![cfg(target_os = "linux")]
use crate::common::adapting::{stderr, text};
use crate::common::program;
use geo_adapt::mesh::io::{read_mesh, write_mesh};
use geo_adapt::mesh::samples::cube;
use std::collections::BTreeMap;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How often a command is killed.
fn kills() -> u32 {
    if std::env::var_os("GEO_ADAPT_LONG").is_some() { 200 } else { 6 }
}

/// A file that is being written may be so young that the next run does not know yet that it is left.
const AGE: Duration = Duration::from_millis(2100);

/// A folder of results, and one for temporary files.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        ["out", "tmp"].iter().for_each(|name| std::fs::create_dir(place.path(name)).unwrap());
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = program();
        command.args(words).env("TMPDIR", self.path("tmp")).process_group(0);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    /// A run that must come to its end; how long it took.
    fn run(&self, words: &[&str]) -> Duration {
        let began = Instant::now();
        let run = self.command(words).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        began.elapsed()
    }

    /// Every file of the results by its place, but those that tell times.
    fn results(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        files(&self.path("out"), &mut |path| {
            let is_told = path
                .extension()
                .is_some_and(|ending| ["json", "html", "txt", "log"].iter().any(|told| ending == *told));
            let bytes = if is_told { Vec::new() } else { std::fs::read(path).unwrap() };
            found.insert(path.strip_prefix(self.path("out")).unwrap().to_owned(), bytes);
        });
        found
    }

    /// Kills a run after a part of the time that a whole one takes, and all that it has started by its own exit.
    fn kill(&self, words: &[&str], after: Duration) {
        let mut child = self.command(words).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(after);
        child.kill().unwrap();
        child.wait().unwrap();
    }

    fn left(&self) -> usize {
        std::fs::read_dir(self.path("tmp")).unwrap().count()
    }
}

fn files(folder: &Path, each: &mut impl FnMut(&Path)) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { files(&path, each) } else { each(&path) }
    }
}

/// The parts of a whole after which runs are killed: a golden-ratio sequence, which spreads evenly however long it is.
fn moments(whole: Duration) -> impl Iterator<Item = Duration> {
    (1..=kills()).map(move |kill| whole.mul_f64(f64::from(kill) * 0.618_033_988_749 % 1.0))
}

#[test]
fn adapt_killed_at_any_moment_leaves_whole_files() {
    let place = Place::new();
    let (input, output) = (text(&place.path("in.meshb")), text(&place.path("out/mesh.meshb")));
    write_mesh(&place.path("in.meshb"), &cube(4)).unwrap();
    let to = |complexity| {
        ["adapt", &input, "-o", &output, "--analytic", "linear", "--threads", "2", "--complexity", complexity]
    };
    place.run(&to("300"));
    let old = place.results();
    let whole = place.run(&to("600"));
    let new = place.results();
    assert!(new.len() >= 2 && old != new);
    let mesh = Path::new("mesh.meshb");
    for after in moments(whole) {
        place.run(&to("300"));
        assert_eq!(place.results(), old);
        place.kill(&to("600"), after);
        let found = place.results();
        let names: Vec<&PathBuf> = old.keys().chain(new.keys()).collect();
        for (name, bytes) in found.iter().filter(|(name, _)| names.contains(name)) {
            assert!(old.get(name) == Some(bytes) || new.get(name) == Some(bytes), "{} is torn", name.display());
        }
        assert!(found.contains_key(mesh));
        read_mesh(&place.path("out/mesh.meshb")).unwrap();
        std::thread::sleep(if found.len() == new.len() { Duration::ZERO } else { AGE });
        place.run(&to("600"));
        assert_eq!(place.results(), new, "something was left");
    }
    assert_eq!(place.left(), 0);
}

#[cfg(feature = "occt")]
#[test]
fn bootstrap_killed_at_any_moment_leaves_whole_files() {
    if !Command::new("gmsh").arg("--version").output().is_ok_and(|run| run.status.success()) {
        eprintln!("not run: there is no gmsh");
        return;
    }
    let place = Place::new();
    let model = text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cube-cylinder.step"));
    let output = text(&place.path("out/mesh.meshb"));
    let words = ["bootstrap", &model, "-o", &output, "--far-field", "box:2", "--complexity", "300", "--threads", "1"];
    let whole = place.run(&words);
    let new = place.results();
    for after in moments(whole) {
        files(&place.path("out"), &mut |path| std::fs::remove_file(path).unwrap());
        place.kill(&words, after);
        for (name, bytes) in place.results().iter().filter(|(name, _)| new.contains_key(*name)) {
            assert!(new[name] == *bytes, "{} is torn", name.display());
        }
    }
    std::thread::sleep(AGE);
    place.run(&words);
    assert_eq!(place.results(), new, "something was left");
    assert_eq!(place.left(), 0);
}

#[test]
fn cycle_killed_at_any_moment_goes_on_to_the_same_end() {
    let config = "threads = 1\n[mesh]\ncube = 3\n[solver.analytic]\nfunction = \"sinfun3\"\n[metric]\nfields = [\"u\"]\n[schedule]\n\
        complexity = 100\ncycles = 2\n[output]\nfolder = \"out\"\n";
    let [whole, killed] = [Place::new(), Place::new()];
    for place in [&whole, &killed] {
        std::fs::write(place.path("loop.toml"), config).unwrap();
    }
    let words = |place: &Place| text(&place.path("loop.toml"));
    let (first, second) = (words(&whole), words(&killed));
    let time = whole.run(&["cycle", &first, "--quiet"]);
    // The loop goes on from kill to kill: parts of it, so that it is not at its end with the first ones.
    for after in moments(time / 3) {
        killed.kill(&["cycle", &second, "--quiet"], after);
    }
    std::thread::sleep(AGE);
    killed.run(&["cycle", &second, "--quiet"]);
    assert_eq!(killed.results(), whole.results(), "something was left, or differs");
    assert_eq!(killed.left(), 0);
}
