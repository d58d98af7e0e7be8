//! A CAD model is read by a child process: however that ends, the user is told the true cause, and nothing is left behind.
#![cfg(target_os = "linux")]
use crate::common::adapting::{stderr, text};
use crate::common::program;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A folder with a model that takes minutes to read, and one for temporary files.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::create_dir(place.path("tmp")).unwrap();
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cube-cylinder.step");
        std::fs::write(place.path("many.step"), in_place(&std::fs::read_to_string(model).unwrap(), 60)).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// `geo-adapt model many.step`, not yet started, in a group of its own as at a terminal.
    fn command(&self) -> Command {
        let mut command = program();
        command.arg("model").arg(self.path("many.step")).env("TMPDIR", self.path("tmp")).process_group(0);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn left(&self) -> Vec<std::ffi::OsString> {
        std::fs::read_dir(self.path("tmp")).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }
}

/// A STEP file with all its entities so many times over, in one place: it takes long to find out what the solids share.
fn in_place(step: &str, copies: usize) -> String {
    let (head, rest) = step.split_once("DATA;\n").unwrap();
    let (data, tail) = rest.split_once("ENDSEC;").unwrap();
    let numbers = || data.split('#').skip(1);
    let digits = |text: &str| text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let most = numbers().filter_map(|text| text[..digits(text)].parse::<usize>().ok()).max().unwrap();
    let mut all = format!("{head}DATA;\n");
    for copy in 0..copies {
        all += data.split('#').next().unwrap();
        for text in numbers() {
            let (number, rest) = text.split_at(digits(text));
            all += &format!("#{}{rest}", number.parse::<usize>().unwrap() + copy * (most + 1));
        }
    }
    all + "ENDSEC;" + tail
}

/// The state and the parent of a process; none where it is gone.
fn process(id: u32) -> Option<(String, u32)> {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    let mut words = stat.rsplit_once(')')?.1.split_whitespace();
    Some((words.next()?.into(), words.next()?.parse().ok()?))
}

fn is_alive(id: u32) -> bool {
    process(id).is_some_and(|(state, _)| state != "Z")
}

/// The child that reads, once it does.
fn reader(of: &Child) -> u32 {
    let began = Instant::now();
    loop {
        let all = std::fs::read_dir("/proc").unwrap().flatten();
        let mut ids = all.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
        let is_ours = |id: &u32| process(*id).is_some_and(|(_, parent)| parent == of.id());
        if let Some(found) = ids.find(is_ours) {
            return found;
        }
        assert!(began.elapsed() < Duration::from_secs(60), "there is no child");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits for what must end soon by itself.
fn ends(child: Child) -> Output {
    let (id, began) = (child.id(), Instant::now());
    let watch = std::thread::spawn(move || {
        while is_alive(id) {
            if began.elapsed() > Duration::from_secs(60) {
                signal("-KILL", &id.to_string());
                return false;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        true
    });
    let output = child.wait_with_output().unwrap();
    assert!(watch.join().unwrap(), "it did not end: {}", stderr(&output));
    output
}

fn signal(signal: &str, to: &str) {
    assert!(Command::new("kill").args([signal, "--", to]).status().unwrap().success());
}

fn goes(id: u32) {
    let began = Instant::now();
    while is_alive(id) {
        assert!(began.elapsed() < Duration::from_secs(20), "the child is still there");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The code, and what was said, of a run whose child gets a signal.
fn with_signal_to_child(name: &str) -> (Option<i32>, String) {
    let place = Place::new();
    let child = place.command().spawn().unwrap();
    signal(name, &reader(&child).to_string());
    let output = ends(child);
    assert!(place.left().is_empty(), "{:?}", place.left());
    (output.status.code(), stderr(&output))
}

#[test]
fn an_interrupt_while_a_model_is_read_is_told_as_one() {
    let place = Place::new();
    let child = place.command().spawn().unwrap();
    let reader = reader(&child);
    // As a terminal does it: to the whole group. Whether the model is named depends on the clock: the program may not wait for it yet.
    signal("-INT", &format!("-{}", child.id()));
    let output = ends(child);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(130), "{told}");
    assert!(told.contains("interrupted") && told.contains("nothing was written") && !told.contains("crash"), "{told}");
    goes(reader);
    assert!(place.left().is_empty(), "{:?}", place.left());
    // To the child alone.
    let (code, told) = with_signal_to_child("-TERM");
    assert!(code == Some(130) && told.contains("many.step") && !told.contains("crash"), "{told}");
}

#[test]
fn a_child_that_the_system_kills_is_told_as_the_end_of_memory() {
    let (code, told) = with_signal_to_child("-KILL");
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("many.step") && told.contains("memory ends") && !told.contains("crash"), "{told}");
}

#[test]
fn a_crash_is_still_told_as_one() {
    let (code, told) = with_signal_to_child("-ILL");
    assert!(code == Some(2) && told.contains("many.step: is damaged: OpenCASCADE crashes on it"), "{told}");
}

#[test]
fn a_limit_of_time_is_told_with_the_way_to_raise_it() {
    let place = Place::new();
    let child = place.command().env("GEO_ADAPT_CAD_TIME_LIMIT", "0.3").spawn().unwrap();
    let reader = reader(&child);
    let output = ends(child);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("0.3 s of processor time") && told.contains("GEO_ADAPT_CAD_TIME_LIMIT"), "{told}");
    goes(reader);
    // The system's own: the one that warns. (Which of two signals comes first at the other depends on the clock.)
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -c 0; ulimit -S -t 1; exec \"$@\"", "sh"]).arg(env!("CARGO_BIN_EXE_geo-adapt"));
    command.arg("model").arg(place.path("many.step")).env("TMPDIR", place.path("tmp"));
    let output = ends(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
    let told = stderr(&output);
    assert!(output.status.code() == Some(2) && told.contains("ulimit -t") && !told.contains("crash"), "{told}");
    assert!(place.left().is_empty(), "{:?}", place.left());
    let output = place.command().env("GEO_ADAPT_CAD_TIME_LIMIT", "soon").output().unwrap();
    assert!(stderr(&output).contains("GEO_ADAPT_CAD_TIME_LIMIT=soon: give a positive number"), "{}", stderr(&output));
}

#[test]
fn a_model_that_nobody_asks_for_is_read_no_further() {
    let place = Place::new();
    let mut command = program();
    command.arg("adapt").arg(place.path("none.mesh")).arg("--cad").arg(place.path("many.step"));
    command.args(["--analytic", "polar-1", "-o"]).arg(place.path("out.mesh")).env("TMPDIR", place.path("tmp"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let output = ends(child);
    let told = stderr(&output);
    assert!(output.status.code() == Some(2) && told.contains("none.mesh") && !told.contains("many.step"), "{told}");
    assert!(place.left().is_empty(), "{:?}", place.left());
}

#[test]
fn a_killed_run_leaves_no_child_and_the_next_one_clears_its_files() {
    let place = Place::new();
    let mut child = place.command().spawn().unwrap();
    let reader = reader(&child);
    child.kill().unwrap();
    child.wait().unwrap();
    goes(reader);
    assert_eq!(place.left().len(), 1, "{:?}", place.left());
    let cube = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cube-cylinder.step");
    let output = program().args(["model", &text(&cube)]).env("TMPDIR", place.path("tmp")).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(place.left().is_empty(), "{:?}", place.left());
}
