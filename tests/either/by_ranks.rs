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
    use crate::mpirun::{is_there, mpirun};
    use geo_adapt::mesh::io::read_mesh;
    use serde_json::Value;
    use std::fs;
    use std::process::{Command, Output};

    /// `mpirun` with a command on so many processes.
    fn launched(ranks: usize, alone: &Command) -> Command {
        let mut command = mpirun(ranks);
        command.arg(alone.get_program()).args(alone.get_args());
        command
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
        if !is_there() {
            return;
        }
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
            let run = launched(ranks, &work.command(&mesh, &words)).output().unwrap();
            ended_well(&run);
            let report: Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
            figures.push([report["statistics"].clone(), report["parts"]["near_cuts"].clone()]);
            assert_eq!(report["parts"]["processes"].as_array().unwrap().len(), ranks);
            assert_eq!(String::from_utf8_lossy(&run.stdout).matches("unit edges").count(), 1, "one of them speaks");
            assert!(written(&work) == bytes, "{ranks} processes");
        }
        // All processes measure, and the sums are the same to the last bit.
        assert!(figures.iter().all(|of| of == &figures[0] && of[0]["metric"]["unit_edges"].as_f64().unwrap() > 0.5));
        // What is no .meshb is made in the memory of one of them.
        let [vtu, back] = ["out.vtu", "back.meshb"].map(|name| text(&work.path(name)));
        let mut to_vtu = program();
        to_vtu.args(["adapt", &text(&mesh), "-o", &vtu]).args(FIELD);
        ended_well(&launched(2, &to_vtu).output().unwrap());
        ended_well(&program().args(["convert", &vtu, &back]).output().unwrap());
        let [known, back] = [work.path("known.meshb"), work.path("back.meshb")];
        fs::write(&known, &bytes[0]).unwrap();
        let [known, back] = [known, back].map(|path| read_mesh(&path).unwrap().content);
        assert_eq!((back.vertices, back.tets), (known.vertices, known.tets));
    }

    /// Each process reads some of a mesh of several slices, and has some blocks of its metric.
    #[test]
    fn the_same_bytes_of_a_mesh_that_is_read_by_slices() {
        if !is_there() {
            return;
        }
        let work = Workplace::new();
        let mesh = work.mesh(&cube(3, |p| if p[0] < 0.6 { 1 } else { 2 }));
        ended_well(&work.command(&mesh, &[&FIELD[..], &["--memory", "4GiB"]].concat()).output().unwrap());
        let [input, metric] = written(&work);
        fs::write(&mesh, input).unwrap();
        fs::write(work.path("in.solb"), metric).unwrap();
        let metric = text(&work.path("in.solb"));
        let field = ["--metric", &metric, "--complexity", "6000", "--part-vertices", "600"];
        ended_well(&work.command(&mesh, &[&field[..], &["--memory", "4GiB"]].concat()).output().unwrap());
        let bytes = written(&work);
        for (ranks, more) in [(2, &["--threads", "1"][..]), (4, &["--threads", "2", "--memory", "1MB"])] {
            ended_well(&launched(ranks, &work.command(&mesh, &[&field[..], more].concat())).output().unwrap());
            assert!(written(&work) == bytes, "{ranks} processes");
        }
    }
}
