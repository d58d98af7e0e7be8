//! `mpirun -n N geo-adapt adapt` where something fails: a process that is killed, an input that one of them does not see, a full disk, an interrupt. All
//! processes end, no file is torn, and the next run goes on.
#![cfg(target_os = "linux")]
use crate::common::adapting::{Workplace, cube, stderr, text};
use crate::mpirun::{PATIENCE, children, end, is_there, mpirun, names, signal, until, works};
use geo_adapt::mesh::io::read_mesh;
use geo_adapt::mesh::validity;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Of many small parts, and so little memory that they lie in the scratch folder.
const ARGUMENTS: [&str; 10] =
    ["--analytic", "polar-1", "--complexity", "2500", "--part-vertices", "600", "--memory", "1MB", "--threads", "1"];

const OUTPUTS: [&str; 2] = ["out.meshb", "out.solb"];

/// What a run wrote, which is removed.
fn taken(work: &Workplace) -> [Vec<u8>; 2] {
    OUTPUTS.map(|name| {
        let bytes = fs::read(work.path(name)).unwrap();
        fs::remove_file(work.path(name)).unwrap();
        bytes
    })
}

fn launched(ranks: usize, alone: &Command) -> Command {
    let mut command = mpirun(ranks);
    command.arg(alone.get_program()).args(alone.get_args());
    command
}

/// A run that must come to its end; how long it took.
fn run(command: &mut Command) -> Duration {
    let began = Instant::now();
    let run = command.output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    began.elapsed()
}

/// What a run says that must fail within some seconds: one error.
fn complaint(run: &mut Command) -> String {
    let began = Instant::now();
    let run: Output = run.output().unwrap();
    let said = stderr(&run);
    assert!(run.status.code() == Some(2) && began.elapsed() < PATIENCE, "{:?} {said}", run.status);
    assert!(said.matches("geo-adapt: error:").count() == 1 && !said.contains("panicked"), "{said}");
    said
}

/// The parts of a whole: a golden-ratio sequence, which spreads evenly however long it is.
fn moments(whole: Duration, count: u32) -> impl Iterator<Item = Duration> {
    (1..=count).map(move |at| whole.mul_f64(f64::from(at) * 0.618_033_988_749 % 1.0))
}

#[test]
fn an_error_is_told_once() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    let said = complaint(&mut launched(3, &work.command(&work.path("no such mesh.meshb"), &ARGUMENTS)));
    assert!(said.contains("no such mesh.meshb"), "{said}");
    assert!(names(&work.path("")).is_empty());
}

#[test]
fn a_killed_process_ends_all_and_the_run_goes_on_from_there() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    run(&mut work.command(&mesh, &ARGUMENTS));
    let known = taken(&work);
    let whole = run(&mut launched(3, &work.command(&mesh, &ARGUMENTS)));
    assert!(taken(&work) == known);
    let kills = if std::env::var_os("GEO_ADAPT_LONG").is_some() { 30 } else { 3 };
    let (mut killed, mut ended) = (0, 0);
    for (after, kill) in moments(whole, kills).zip(0..) {
        let mut command = launched(3, &work.command(&mesh, &ARGUMENTS));
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(after);
        let ranks = children(run.id());
        if let Some(&rank) = ranks.get(kill % ranks.len().max(1)) {
            signal("KILL", rank);
            killed += 1;
        }
        let ends_well = end(&mut run).success();
        ended += u32::from(ends_well);
        until("no rank is left", PATIENCE, || !ranks.iter().any(|&rank| works(rank)));
        // Both files are there, and whole, or none.
        let there = OUTPUTS.map(|name| work.path(name).exists());
        assert!(there[0] == there[1] && there[0] >= ends_well, "{there:?}");
        if there[0] {
            assert!(taken(&work) == known);
        }
    }
    assert!(killed > 0 && ended < kills, "{killed} killed, {ended} ended well");
    run(&mut launched(2, &work.command(&mesh, &ARGUMENTS)));
    assert!(taken(&work) == known);
    assert_eq!(names(&work.path("")), ["in.meshb"], "something is left");
}

/// A run on the mesh of the folder, each rank of which is started by a script that leads rank 1 into another folder.
fn astray(work: &Workplace) -> Command {
    let script = r#"cd "$1"; shift; [ "$OMPI_COMM_WORLD_RANK" = 1 ] && cd elsewhere; exec "$@""#;
    let alone = work.command(Path::new("in.meshb"), &ARGUMENTS);
    let mut command = mpirun(3);
    command.args(["sh", "-c", script, "sh", &text(&work.path(""))]).arg(alone.get_program()).args(alone.get_args());
    command
}

#[test]
fn an_input_that_one_rank_does_not_see_is_told() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    work.mesh(&cube(3, |_| 1));
    fs::create_dir(work.path("elsewhere")).unwrap();
    let said = complaint(&mut astray(&work));
    assert!(said.contains("rank 1: in.meshb: "), "{said}");
    assert_eq!(names(&work.path("")), ["elsewhere", "in.meshb"]);
}

/// A disk of its own, which fills up while the run works on it.
fn on_a_small_disk(work: &Workplace, mount: &str, fill: &str, alone: &Command) -> Option<Command> {
    let disk = work.path("disk");
    fs::create_dir_all(&disk).unwrap();
    let unshared = |script: &str| {
        let mut command = Command::new("unshare");
        command.args(["--mount", "--map-root-user", "sh", "-c", script, "sh", &text(&disk)]);
        command
    };
    let can = unshared(r#"mount -t tmpfs -o size=1m none "$1""#).output().is_ok_and(|run| run.status.success());
    if !can {
        eprintln!("skipped: this system lets nobody but root mount a disk");
        return None;
    }
    let script = format!(
        r#"disk=$1; shift; mount -t tmpfs -o size={mount} none "$disk" || exit 99
        "$@" & run=$!
        {fill}
        wait $run; code=$?
        rm -f "$disk/fill"; ls -A "$disk" > "$disk.left"; exit $code"#
    );
    let mut command = unshared(&script);
    let run = launched(3, alone);
    command.arg(run.get_program()).args(run.get_args()).stdin(Stdio::null());
    command.envs(run.get_envs().filter_map(|(name, value)| Some((name, value?))));
    Some(command)
}

#[test]
fn a_disk_that_fills_up_is_told() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let disk = work.path("disk");
    let scratch = text(&disk.join("parts"));
    let left = || fs::read_to_string(work.path("disk.left")).unwrap();
    // The scratch folder: too small from the start, and filled after the first round.
    let to_scratch = work.command(&mesh, &[&ARGUMENTS[..], &["--scratch", &scratch]].concat());
    let Some(mut command) = on_a_small_disk(&work, "1m", "", &to_scratch) else { return };
    let said = complaint(&mut command);
    assert!(said.contains("MB free") && said.contains("--scratch chooses") && left().is_empty(), "{said} {}", left());
    let fill = r#"while [ ! -e "$disk/parts/journal.json" ]; do sleep 0.01; done; head -c 64M /dev/zero > "$disk/fill" 2> "$disk.said""#;
    let said = complaint(&mut on_a_small_disk(&work, "8m", fill, &to_scratch).unwrap());
    assert!(said.contains(&scratch) && said.contains("--scratch chooses another disk"), "{said}");
}

/// What a run waits for in sh: a round of the journal of its scratch folder.
const FIRST_ROUND: &str = r#"while ! grep -qs '"steps":[1-9]' "${disk%/*}/parts/journal.json"; do sleep 0.01; done"#;
const BEFORE_ROUNDS: &str = r#"while [ ! -e "${disk%/*}/parts/journal.json" ]; do sleep 0.01; done"#;

#[test]
fn a_full_disk_for_the_output_loses_no_work() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    run(&mut work.command(&mesh, &ARGUMENTS));
    let known = taken(&work);
    let (disk, scratch) = (work.path("disk"), text(&work.path("parts")));
    let mut to_disk = crate::common::program();
    to_disk.arg("adapt").arg(&mesh).arg("-o").arg(disk.join("out.meshb")).args(ARGUMENTS);
    to_disk.args(["--scratch", &scratch]);
    let fill = r#"head -c 64M /dev/zero > "$disk/fill" 2> "$disk.said""#;
    let ranks = "$(cat /proc/$run/task/*/children)";
    let at_the_end = format!("{FIRST_ROUND}; {fill}");
    // What one rank leaves half done counts for nothing, and what the others make of it.
    let interrupted = format!("{BEFORE_ROUNDS}; {fill}; for rank in {ranks}; do kill -USR1 $rank; break; done");
    for (fill, goes_on) in [(at_the_end, true), (interrupted, false)] {
        let Some(mut command) = on_a_small_disk(&work, "8m", &fill, &to_disk) else { return };
        let said = complaint(&mut command);
        let left = fs::read_to_string(work.path("disk.left")).unwrap();
        assert!(said.contains("out.meshb") && left.is_empty(), "{said} {left}");
        // With room there it goes on.
        let run = work.command(&mesh, &[&ARGUMENTS[..], &["--scratch", &scratch]].concat()).output().unwrap();
        assert!(run.status.success(), "{}", stderr(&run));
        assert!(!goes_on || stderr(&run).contains("goes on after round"), "{}", stderr(&run));
        assert!(taken(&work) == known && !work.path("parts").exists());
    }
}

/// mpirun hands SIGUSR1 on, and waits; after SIGTERM and SIGINT it leaves a rank one second.
#[test]
fn an_interrupt_writes_the_last_mesh_or_leaves_the_scratch_folder() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    run(&mut work.command(&mesh, &ARGUMENTS));
    let known = taken(&work);
    let journal = work.path("out.meshb.scratch").join("journal.json");
    for name in ["USR1", "TERM", "INT"] {
        let mut command = launched(2, &work.command(&mesh, &ARGUMENTS));
        let mut interrupted = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        until("the first round is done", PATIENCE, || journal.exists());
        let ranks = children(interrupted.id());
        signal(name, interrupted.id());
        let code = end(&mut interrupted).code();
        until("no rank is left", PATIENCE, || !ranks.iter().any(|&rank| works(rank)));
        let there = OUTPUTS.map(|name| work.path(name).exists());
        assert!(there[0] == there[1] && (there[0] || journal.exists()), "{name}: {there:?}");
        if there[0] {
            assert!(validity::check(&read_mesh(&work.path("out.meshb")).unwrap().content).is_valid());
            assert!(taken(&work) != known, "{name}: it was interrupted");
        }
        if name == "USR1" {
            assert!(code == Some(130) && there[0], "{code:?}");
        }
        run(&mut launched(2, &work.command(&mesh, &ARGUMENTS)));
        assert!(taken(&work) == known, "{name}");
        assert_eq!(names(&work.path("")), ["in.meshb"], "{name}");
    }
}

/// A file of the same name that is another one, on the disk of one machine.
#[test]
fn an_input_that_is_another_one_on_one_rank_is_told() {
    if !is_there() {
        return;
    }
    let work = Workplace::new();
    work.mesh(&cube(3, |_| 1));
    fs::create_dir(work.path("elsewhere")).unwrap();
    geo_adapt::mesh::io::write_mesh(&work.path("elsewhere/in.meshb"), &cube(4, |_| 1)).unwrap();
    let said = complaint(&mut astray(&work));
    assert!(said.contains("rank 1: ") && said.contains("let all processes see the same files"), "{said}");
    assert_eq!(names(&work.path("")), ["elsewhere", "in.meshb"]);
}
