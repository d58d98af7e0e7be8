//! `mpirun -n N geo-adapt adapt`: the same files on any number of processes, and one clear end where one of them fails.
//! Without the feature `mpi` the program says how to get it.
use crate::common::adapting::{Workplace, complaint, cube, stderr, text};
use crate::common::program;

const FIELD: [&str; 6] = ["--analytic", "polar-1", "--complexity", "2500", "--part-vertices", "600"];

#[test]
fn other_commands_are_not_for_several_processes() {
    let work = Workplace::new();
    let mesh = text(&work.mesh(&cube(2, |_| 1)));
    let run = program().args(["inspect", &mesh]).env("OMPI_COMM_WORLD_SIZE", "4").output().unwrap();
    assert!(complaint(&run).contains("without mpirun"), "{}", stderr(&run));
}

#[cfg(not(feature = "mpi"))]
#[test]
fn a_program_without_mpi_says_how_to_get_it() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(2, |_| 1));
    let run = work.command(&mesh, &FIELD).env("OMPI_COMM_WORLD_SIZE", "4").output().unwrap();
    assert!(complaint(&run).contains("cargo build --release --features mpi"), "{}", stderr(&run));
}

#[cfg(feature = "mpi")]
mod with_mpi {
    use super::*;
    use geo_adapt::mesh::io::read_mesh;
    use serde_json::Value;
    use std::fs;
    use std::path::PathBuf;
    use std::process::{Child, Command, Output, Stdio};
    use std::time::{Duration, Instant};

    /// How long a run may take in which a process fails: what hangs, hangs for ever.
    const PATIENCE: Duration = Duration::from_secs(30);

    /// `mpirun` with a command on so many processes; none where there is no mpirun.
    fn launched(ranks: usize, alone: &Command) -> Option<Command> {
        let there =
            Command::new("mpirun").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
        assert!(there || std::env::var_os("GEO_ADAPT_SET_UP").is_none(), "tests/run has set up mpirun");
        if !there {
            eprintln!("skipped: mpirun is not there (apt-get install openmpi-bin)");
            return None;
        }
        let mut command = Command::new("mpirun");
        // More ranks than cores, and as root in CI.
        command.args(["--oversubscribe", "-n", &ranks.to_string()]);
        command.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")]);
        command.arg(alone.get_program()).args(alone.get_args()).stdin(Stdio::null());
        Some(command)
    }

    fn written(work: &Workplace) -> [Vec<u8>; 2] {
        let files = ["out.meshb", "out.solb"].map(|name| fs::read(work.path(name)).unwrap());
        ["out.meshb", "out.solb"].iter().for_each(|name| fs::remove_file(work.path(name)).unwrap());
        files
    }

    fn ended_well(run: &Output) {
        assert_eq!(run.status.code(), Some(0), "{}", stderr(run));
    }

    #[test]
    fn the_same_bytes_on_any_number_of_processes() {
        let work = Workplace::new();
        let mesh = work.mesh(&cube(3, |p| if p[0] < 0.6 { 1 } else { 2 }));
        let alone = [&FIELD[..], &["--memory", "4GiB", "--threads", "1"]].concat();
        ended_well(&work.command(&mesh, &alone).output().unwrap());
        let bytes = written(&work);
        let mut figures = Vec::new();
        for (ranks, more) in
            [(2, &["--threads", "1"][..]), (3, &["--threads", "2"]), (5, &["--threads", "1", "--memory", "1MB"])]
        {
            let report = text(&work.path("report.json"));
            let words = [&FIELD[..], more, &["--report", &report]].concat();
            let Some(mut run) = launched(ranks, &work.command(&mesh, &words)) else { return };
            let run = run.output().unwrap();
            ended_well(&run);
            let report: Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
            figures.push(report["statistics"].clone());
            assert_eq!(report["parts"]["processes"].as_array().unwrap().len(), ranks);
            assert_eq!(String::from_utf8_lossy(&run.stdout).matches("unit edges").count(), 1, "one of them speaks");
            assert!(written(&work) == bytes, "{ranks} processes");
        }
        // All processes measure, and the sums are the same to the last bit.
        assert!(figures.iter().all(|of| of == &figures[0] && of["metric"]["unit_edges"].as_f64().unwrap() > 0.5));
        // What is no .meshb is made in the memory of one of them.
        let [vtu, back] = ["out.vtu", "back.meshb"].map(|name| text(&work.path(name)));
        let mut to_vtu = program();
        to_vtu.args(["adapt", &text(&mesh), "-o", &vtu]).args(FIELD);
        let Some(mut run) = launched(2, &to_vtu) else { return };
        ended_well(&run.output().unwrap());
        ended_well(&program().args(["convert", &vtu, &back]).output().unwrap());
        let [known, back] = [work.path("known.meshb"), work.path("back.meshb")];
        fs::write(&known, &bytes[0]).unwrap();
        let [known, back] = [known, back].map(|path| read_mesh(&path).unwrap().content);
        assert_eq!((back.vertices, back.tets), (known.vertices, known.tets));
    }

    #[test]
    fn an_error_is_told_once() {
        let work = Workplace::new();
        let Some(mut run) = launched(3, &work.command(&work.path("no such mesh.meshb"), &FIELD)) else { return };
        let began = Instant::now();
        let run = run.output().unwrap();
        let said = stderr(&run);
        assert!(!run.status.success() && began.elapsed() < PATIENCE, "{said}");
        assert_eq!(said.matches("geo-adapt: error:").count(), 1, "{said}");
        assert!(said.contains("no such mesh.meshb") && !said.contains("panicked"), "{said}");
    }

    /// The processes that mpirun has started.
    fn processes(mpirun: &Child) -> Vec<PathBuf> {
        let is_ours = |path: &PathBuf| {
            let stat = fs::read_to_string(path.join("stat")).unwrap_or_default();
            let after = stat.rsplit(") ").next().unwrap_or_default();
            after.split(' ').nth(1) == Some(&mpirun.id().to_string())
        };
        fs::read_dir("/proc").unwrap().flatten().map(|entry| entry.path()).filter(is_ours).collect()
    }

    #[test]
    fn a_killed_process_ends_all_and_the_run_goes_on_from_there() {
        let work = Workplace::new();
        let mesh = work.mesh(&cube(3, |_| 1));
        let alone = [&FIELD[..], &["--memory", "1MB", "--threads", "1"]].concat();
        ended_well(&work.command(&mesh, &alone).output().unwrap());
        let known = written(&work);
        let kills = if std::env::var_os("GEO_ADAPT_LONG").is_some() { 30 } else { 3 };
        let mut is_killed = 0;
        for kill in 0..kills {
            let Some(mut run) = launched(3, &work.command(&mesh, &alone)) else { return };
            let mut run = run.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            std::thread::sleep(Duration::from_millis(700 + 150 * (kill % 7)));
            let ranks = processes(&run);
            if let Some(rank) = ranks.get(kill as usize % ranks.len().max(1)) {
                let pid = rank.file_name().unwrap().to_str().unwrap();
                is_killed += i32::from(Command::new("kill").args(["-9", pid]).status().unwrap().success());
            }
            let began = Instant::now();
            while run.try_wait().unwrap().is_none() {
                assert!(began.elapsed() < PATIENCE, "it hangs");
                std::thread::sleep(Duration::from_millis(10));
            }
            let [mesh, metric] = ["out.meshb", "out.solb"].map(|name| work.path(name));
            assert_eq!(mesh.exists(), metric.exists());
            if mesh.exists() {
                assert!(written(&work) == known);
            }
        }
        assert!(is_killed > 0);
        let Some(mut run) = launched(2, &work.command(&mesh, &alone)) else { return };
        ended_well(&run.output().unwrap());
        assert!(written(&work) == known && !work.path("out.meshb.scratch").exists());
    }
}
