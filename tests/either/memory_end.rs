//! Where memory ends a run ends by itself: with the code of the end of memory and a line that says so, whatever it was doing.
#![cfg(target_os = "linux")]
use crate::common::adapting::text;
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use geo_adapt::mesh::samples::cube;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The exit code where memory ends.
const ENDED: i32 = 3;

/// That of the system's loader, where there is not even room for the program.
const NOT_LOADED: i32 = 127;

/// How long a run may take: what hangs, hangs for ever.
const PATIENCE: Duration = Duration::from_secs(100);

/// MB: enough for all that is tried here.
const MOST: u64 = 600;

/// The MB from which on the program begins at all: with OpenCASCADE's libraries several times what it is without.
fn least(place: &Place) -> u64 {
    let (mut not, mut does) = (10, MOST);
    assert!(begins(does, place), "the program does not begin with {does} MB");
    while does - not > 4 {
        let middle = (not + does) / 2;
        if begins(middle, place) { does = middle } else { not = middle }
    }
    does
}

/// From less than the program needs to begin. All limits are tried where GEO_ADAPT_LONG is set, and few of them else, other ones for
/// each command.
fn limits(command: usize, least: u64) -> impl Iterator<Item = u64> {
    let count = 20;
    let every = if std::env::var_os("GEO_ADAPT_LONG").is_some() { 1 } else { 5 };
    // More of them near the least, where most ends are.
    let first = 0.9 * least as f64;
    let at = move |k: usize| first * (MOST as f64 / first).powf((k as f64 / (count - 1) as f64).powi(2));
    (0..count).filter(move |k| k % every == command % every).map(move |k| at(k) as u64)
}

/// A folder with inputs for all commands.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        let mesh = cube(8);
        write_mesh(&place.path("cube.meshb"), &mesh).unwrap();
        let values = mesh.vertices.iter().map(|p| (20.0 * p[0]).tanh() * p[1]).collect();
        let fields = vec![SolutionField { kind: FieldKind::Scalar, values }];
        write_solution(&place.path("u.solb"), &Solution { vertices: mesh.vertices.len(), fields }).unwrap();
        let mut image = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 20 20 20\nencoding: raw\n\n".as_bytes().to_vec();
        let inside = |k: usize| [k % 20, k / 20 % 20, k / 400].iter().all(|x| (4..16).contains(x));
        image.extend((0..8000).map(|k| u8::from(inside(k))));
        std::fs::write(place.path("box.nrrd"), image).unwrap();
        let config = "[mesh]\ncube = 3\n[solver.analytic]\nfunction = \"sinfun3\"\n[metric]\nfields = [\"u\"]\n[schedule]\ncomplexity = 100\n\
            cycles = 1\n[output]\nfolder = \"loop\"\n";
        std::fs::write(place.path("loop.toml"), config).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn commands(&self) -> Vec<Vec<String>> {
        let project = |name: &str| text(&Path::new(env!("CARGO_MANIFEST_DIR")).join(name));
        let (mesh, cad) = (project("cases/cube-cylinder/start.meshb"), project("geometry/cube-cylinder.step"));
        let [cube, field, image, config] =
            ["cube.meshb", "u.solb", "box.nrrd", "loop.toml"].map(|name| text(&self.path(name)));
        let out = |name: &str| text(&self.path(name));
        let mut all = vec![
            format!("adapt {mesh} -o {} --analytic polar-2 --complexity 1000 --threads 1", out("a.meshb")),
            format!("adapt {cube} -o {} --field {field} --complexity 2000 --threads 4", out("b.meshb")),
            format!(
                "adapt {cube} -o {} --analytic linear --complexity 2000 --threads 3 --scheduler speculative --backend rayon",
                out("c.meshb")
            ),
            format!("convert {cube} {}", out("e.vtu")),
            format!("cycle {config} --restart"),
            format!("field evaluate {cube} --function sinfun3 -o {}", out("f.solb")),
            format!("image-mesh {image} -o {} --size 2", out("g.meshb")),
            format!("inspect {cube}"),
            format!("metric multiscale {cube} {field} --complexity 2000 -o {}", out("h.solb")),
            format!("transfer {cube} {field} {mesh} -o {} --conservative", out("i.solb")),
            format!(
                "tune {cube} --analytic linear --complexity 200 --grains 128 --backends stealing --strategies flat"
            ),
            format!("view {cube} -o {}", out("j.html")),
        ];
        if cfg!(feature = "occt") {
            all.push(format!(
                "adapt {mesh} --cad {cad} -o {} --analytic polar-2 --complexity 500 --threads 2",
                out("k.meshb")
            ));
            all.push(format!("classify {mesh} --cad {cad} -o {}", out("d.meshb")));
            all.push(format!("model {cad}"));
            all.push(format!("metric geometry {mesh} --cad {cad} -o {}", out("l.solb")));
            all.push(format!("bootstrap {cad} -o {} --far-field box:2 --mesher gmsh", out("m.meshb")));
        }
        all.iter().map(|line| line.split(' ').map(str::to_owned).collect()).collect()
    }
}

/// How a run with so many MB of address space ends: its code, and what it says. None where it does not.
fn run(words: &[String], megabytes: u64, place: &Place) -> Option<(Option<i32>, String)> {
    let said = place.path("said");
    let log = std::fs::File::create(&said).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_geo-adapt"));
    command.args(words).stdin(Stdio::null()).stdout(Stdio::null()).stderr(log).process_group(0);
    // Whether a mesher is there makes no difference to this.
    command.env("GEO_ADAPT_GMSH", "/nowhere/gmsh").env("TMPDIR", place.folder.path()).env_remove("RUST_BACKTRACE");
    let limit = libc::rlimit { rlim_cur: megabytes << 20, rlim_max: megabytes << 20 };
    // SAFETY: a system call that reads a record of this function's.
    let set = move || match unsafe { libc::setrlimit(libc::RLIMIT_AS, &limit) } {
        0 => Ok(()),
        _ => Err(std::io::Error::last_os_error()),
    };
    // SAFETY: it makes that system call alone.
    let mut child = unsafe { command.pre_exec(set) }.spawn().unwrap();
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return Some((status.code(), std::fs::read_to_string(&said).unwrap_or_default()));
        }
        if began.elapsed() > PATIENCE {
            // SAFETY: a system call without memory, on the group of our own child.
            unsafe { libc::kill(-libc::pid_t::try_from(child.id()).unwrap(), libc::SIGKILL) };
            child.wait().unwrap();
            return None;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Whether our main begins with so much: the version is told without further memory.
fn begins(megabytes: u64, place: &Place) -> bool {
    run(&["--version".to_owned()], megabytes, place).is_none_or(|(code, _)| code == Some(0))
}

/// Whether this is how a run may end.
fn is_well(words: &[String], (code, said): (Option<i32>, &str), begins: impl FnOnce() -> bool) -> bool {
    match code {
        Some(0) => true,
        Some(ENDED) => said.lines().any(|line| line.contains("memory") || line.contains("cannot start")),
        // The loader's own words; without memory for these it says less.
        Some(NOT_LOADED) => said.contains("error while loading shared libraries") || !begins(),
        // Those of Rust and of the libraries, before our main begins: libgomp ends with 1 where it finds no 8 bytes.
        None | Some(1) => !begins(),
        // There is no mesher.
        Some(2) => words[0] == "bootstrap" && said.contains("there is no mesher"),
        _ => false,
    }
}

#[test]
fn a_run_that_memory_ends_does_not_sleep_for_ever() {
    let place = Place::new();
    let least = least(&place);
    let (mut wrong, mut ended, mut done) = (Vec::new(), 0, 0);
    for (k, words) in place.commands().iter().enumerate() {
        for megabytes in limits(k, least) {
            match run(words, megabytes, &place) {
                None => wrong.push(format!("{megabytes} MB: {words:?} does not end")),
                Some((code, said)) if !is_well(words, (code, &said), || begins(megabytes, &place)) => {
                    wrong.push(format!("{megabytes} MB: {words:?} ends with {code:?}: {said}"));
                }
                Some((Some(ENDED), _)) => ended += 1,
                Some((Some(0 | 2), _)) => done += 1,
                Some(_) => {}
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(
        ended > 5 && done > 5,
        "{ended} runs found no memory, and {done} enough; the program begins with {least} MB"
    );
}

#[test]
fn more_threads_than_there_is_room_for_are_told() {
    let place = Place::new();
    let words: Vec<String> = [
        "adapt",
        &text(&place.path("cube.meshb")),
        "-o",
        &text(&place.path("out.meshb")),
        "--analytic",
        "linear",
        "--threads",
        "1000",
    ]
    .map(str::to_owned)
    .into();
    let (code, said) = run(&words, 600, &place).expect("it ends");
    assert!(
        code == Some(ENDED) && (said.contains("cannot start 1000 threads") || said.contains("out of memory")),
        "{code:?}: {said}"
    );
}
