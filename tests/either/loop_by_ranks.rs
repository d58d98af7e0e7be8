//! `geo-adapt cycle` whose meshes are adapted part by part, by mpirun: the same meshes on any number of processes, and what cannot be is refused
//! before the first step.
#![cfg(target_os = "linux")]
use crate::common::adapting::{complaint, stderr};
use crate::common::program;
use std::path::PathBuf;
use std::process::Command;

const CONFIG: &str = "threads = 1\n[mesh]\ncube = 3\n[solver.analytic]\nfunction = 'sinfun3'\n[metric]\nfields = ['u']\n[schedule]\n\
    complexity = 1000\ncycles = 2\n[output]\nfolder = 'out'\npictures = false\n[adapt]\noptions = ['--part-vertices', '400']\n";

/// A folder with a configuration.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new(adapt: &str) -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        place.configure(adapt);
        place
    }

    fn configure(&self, adapt: &str) {
        std::fs::write(self.path("loop.toml"), format!("{CONFIG}{adapt}\n")).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self) -> Command {
        let mut command = program();
        command.arg("cycle").arg(self.path("loop.toml"));
        // Open MPI keeps its files in a folder that all runs of a user share, and a run that ends may remove it while another one begins.
        command.env("OMPI_MCA_orte_tmpdir_base", self.folder.path());
        command
    }

    /// What a run says that must be refused before it writes anything; a dry run says the same.
    fn refusal(&self) -> String {
        let said = complaint(&self.command().output().unwrap());
        assert!(said.contains("loop.toml") && !self.path("out").exists(), "{said}");
        assert_eq!(said, complaint(&self.command().arg("--dry-run").output().unwrap()));
        said
    }

    fn run(&self) {
        let run = self.command().output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    fn meshes(&self) -> Vec<Vec<u8>> {
        let names = ["cycle-01/adapt/mesh.meshb", "cycle-02/adapt/mesh.meshb", "cycle-02/adapt/mesh.solb"];
        names.iter().map(|name| std::fs::read(self.path("out").join(name)).unwrap()).collect()
    }
}

#[test]
fn what_cannot_be_part_by_part_is_refused_before_the_first_step() {
    for (adapt, told) in [
        ("processes = 0", "[adapt] processes and threads: give 1 or more"),
        ("scratch = 'parts'", "[adapt] scratch belongs to memory"),
        ("memory = 'much'", "'much'"),
    ] {
        let said = Place::new(adapt).refusal();
        assert!(said.contains(told), "{adapt}: {said}");
    }
    for (option, told) in
        [("--max-vertices", "leave it out of the options"), ("--threads", "cannot be used multiple times")]
    {
        let place = Place::new("");
        let config = CONFIG.replace("['--part-vertices'", &format!("['{option}', '500', '--part-vertices'"));
        std::fs::write(place.path("loop.toml"), config + "memory = '1GiB'\n").unwrap();
        let said = place.refusal();
        assert!(said.contains(option) && said.contains("[adapt]") && said.contains(told), "{said}");
    }
}

/// With one process, too; and only the kind of the adaptation is a difference, not how many processes and how much memory.
#[test]
fn memory_adapts_part_by_part_and_may_change() {
    let place = Place::new("memory = '1MB'\nscratch = 'parts'");
    place.run();
    let command = place.read("out/cycle-02/adapt/command.txt");
    let scratch = place.path("parts").display().to_string();
    assert!(command.contains("--memory=1MB") && command.contains(&format!("--scratch={scratch}")), "{command}");
    assert!(!place.path("parts").exists() && place.read("out/report.html").contains("vertices, part by part<"));
    place.configure("memory = '4GiB'");
    place.run();
    place.configure("");
    let said = complaint(&place.command().output().unwrap());
    assert!(said.contains("adapt.memory was \"4GiB\" and is null"), "{said}");
    let other = Place::new("memory = '4GiB'");
    other.run();
    assert!(other.meshes() == place.meshes());
}

#[cfg(not(feature = "mpi"))]
#[test]
fn a_program_without_mpi_refuses_several_processes_at_the_start() {
    let said = Place::new("processes = 2").refusal();
    assert!(
        said.contains("[adapt] processes is above 1") && said.contains("cargo build --release --features mpi"),
        "{said}"
    );
}

#[cfg(feature = "mpi")]
mod with_mpi {
    use super::*;
    use crate::mpirun::{PATIENCE, children, end, is_there, names, signal, until, works};
    use std::process::Stdio;
    use std::time::Duration;

    #[test]
    fn without_mpirun_several_processes_are_refused_at_the_start() {
        let place = Place::new("processes = 2");
        let run = place.command().env("PATH", place.path("nowhere")).output().unwrap();
        let said = complaint(&run);
        assert!(said.contains("no mpirun on the PATH") && said.contains("openmpi-bin"), "{said}");
        assert!(!place.path("out").exists());
    }

    /// It starts processes that each believe to be alone.
    #[test]
    fn the_mpirun_of_another_mpi_is_told_at_the_start() {
        use std::os::unix::fs::PermissionsExt;
        if !is_there() {
            return;
        }
        let place = Place::new("processes = 2");
        std::fs::write(
            place.path("mpirun"),
            "#!/bin/sh\nshift 2\nexport PMI_SIZE=2\n\"$@\" & \"$@\"; code=$?; wait; exit $code\n",
        )
        .unwrap();
        std::fs::set_permissions(place.path("mpirun"), std::fs::Permissions::from_mode(0o755)).unwrap();
        let path = format!("{}:{}", place.path("").display(), std::env::var("PATH").unwrap());
        let run = place.command().env("PATH", path).output().unwrap();
        let said = stderr(&run);
        assert_eq!(run.status.code(), Some(2), "{said}");
        assert!(said.contains("[adapt] processes = 2: `mpirun -n 2 ") && said.contains("of another MPI"), "{said}");
        assert_eq!(said.matches("PMI_SIZE").count(), 2, "once, and once in the remedy: {said}");
        assert!(!place.path("out/start").exists());
        place.run();
        assert!(!place.path("out/mpirun.log").exists());
    }

    #[test]
    fn the_same_meshes_on_any_number_of_processes() {
        if !is_there() {
            return;
        }
        let alone = Place::new("memory = '4GiB'");
        alone.run();
        for (processes, more) in [(2, ""), (3, "threads = 2\nmemory = '1MB'")] {
            let place = Place::new(&format!("processes = {processes}\n{more}"));
            let plan = place.command().arg("--dry-run").output().unwrap();
            let plan = String::from_utf8(plan.stdout).unwrap();
            assert!(plan.contains(&format!("mpirun -n {processes} ")), "{plan}");
            place.run();
            assert!(place.meshes() == alone.meshes(), "{processes} processes");
            let command = place.read("out/cycle-01/adapt/command.txt");
            let threads = if more.is_empty() { "--threads 1" } else { "--threads 2" };
            assert!(plan.contains(command.trim()) && command.contains(threads), "{plan}\n{command}");
            let page = place.read("out/report.html");
            assert!(page.contains(&format!("part by part by {processes} processes")));
        }
    }

    /// A failure of the adaptation is told with what the processes said, not with what mpirun says of it.
    #[test]
    fn a_failure_is_told_with_its_cause() {
        if !is_there() {
            return;
        }
        let place = Place::new("processes = 2\nmemory = '1MB'\nscratch = 'parts'");
        std::fs::create_dir(place.path("parts")).unwrap();
        std::fs::write(place.path("parts/mine.txt"), "not of geo-adapt").unwrap();
        let said = stderr(&place.command().output().unwrap());
        assert!(
            said.contains("cycle-02/adapt: mpirun -n 2 ") && said.contains("adapt ended with exit code 2"),
            "{said}"
        );
        assert!(said.contains("this folder is not empty"), "{said}");
        assert_eq!(names(&place.path("parts")), ["mine.txt"]);
    }

    /// The processes of the adaptation that runs: mpirun's number, and those of its ranks.
    fn running(place: &Place) -> (u32, Vec<u32>) {
        let mut found = None;
        until("the adaptation runs", Duration::from_secs(120), || {
            let text = std::fs::read_to_string(place.path("out/cycle-02/adapt/pid")).unwrap_or_default();
            let mpirun = text.split(' ').next().and_then(|id| id.parse().ok());
            found = mpirun.map(|id| (id, children(id))).filter(|(_, ranks)| ranks.len() == 2);
            found.is_some()
        });
        found.unwrap()
    }

    #[test]
    fn neither_an_interrupted_nor_a_killed_loop_leaves_a_rank() {
        if !is_there() {
            return;
        }
        let large = |place: &Place| {
            let config = std::fs::read_to_string(place.path("loop.toml")).unwrap();
            let config = config.replace("complexity = 1000", "complexity = 4000\nfactor = 10");
            std::fs::write(place.path("loop.toml"), config.replace("cycles = 2", "cycles = 3")).unwrap();
        };
        let place = Place::new("processes = 2\nmemory = '1MB'\nscratch = 'parts'");
        large(&place);
        let start = || place.command().stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        // The first interrupt lets the step end, the second ends it.
        let mut run = start();
        let (mpirun, ranks) = running(&place);
        signal("INT", run.id());
        std::thread::sleep(Duration::from_millis(300));
        assert!(run.try_wait().unwrap().is_none() && works(mpirun));
        signal("INT", run.id());
        assert_eq!(end(&mut run).code(), Some(130));
        until("its ranks end", PATIENCE, || !ranks.iter().chain([&mpirun]).any(|&id| works(id)));
        assert!(!place.path("out/cycle-02/adapt/mesh.meshb").exists());
        // Killed, it leaves them; the next run ends them before it begins.
        let mut run = start();
        let (mpirun, ranks) = running(&place);
        signal("KILL", run.id());
        run.wait().unwrap();
        assert!(works(mpirun) && ranks.iter().all(|&id| works(id)));
        let mut next = start();
        until("the next run begins", PATIENCE, || {
            let text = std::fs::read_to_string(place.path("out/cycle-02/adapt/pid")).unwrap_or_default();
            !text.is_empty() && text.split(' ').next() != Some(&mpirun.to_string())
        });
        assert!(!ranks.iter().chain([&mpirun]).any(|&id| works(id)), "they work in the same folder");
        signal("INT", next.id());
        std::thread::sleep(Duration::from_millis(50));
        signal("INT", next.id());
        end(&mut next);
    }
}
