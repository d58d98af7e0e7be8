//! `geo-adapt adapt` on bad input: one error that names the file, the place and the remedy; code 2; nothing is written.

use crate::common::adapting::{Workplace, complaint, cube, isotropic, stderr, text, write_tensors};
use crate::common::program;
use geo_adapt::mesh::{Elements, TetMesh, io};
use geo_adapt::metric::{Field, Sym3};
use std::path::{Path, PathBuf};

/// A cube with a metric, in a folder of its own.
fn prepared() -> (Workplace, TetMesh, PathBuf, String) {
    let (work, mesh) = (Workplace::new(), cube(3, |_| 1));
    let (input, metric) = (work.mesh(&mesh), work.metric(&mesh, |_| isotropic(0.3)));
    (work, mesh, input, metric)
}

fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

/// Runs with this output; it must be refused.
fn refused_output(input: &Path, output: &Path, arguments: &[&str]) -> String {
    let run = program().arg("adapt").arg(input).arg("-o").arg(output).args(arguments).output().unwrap();
    complaint(&run)
}

#[test]
fn an_output_over_an_input_is_refused_and_the_input_untouched() {
    let (work, mesh, input, metric) = prepared();
    let before = std::fs::read(&input).unwrap();
    let field = ["--metric", &metric];
    assert_says(&refused_output(&input, &input, &field), &["in.meshb", "would be overwritten", "another output"]);
    // By another name for the same file.
    let roundabout = work.path(".").join("in.meshb");
    assert_says(&refused_output(&input, &roundabout, &field), &["in.meshb", "would be overwritten"]);
    #[cfg(unix)]
    {
        let link = work.path("link.meshb");
        std::os::unix::fs::symlink(&input, &link).unwrap();
        assert_says(&refused_output(&input, &link, &field), &["link.meshb", "would be overwritten"]);
    }
    // The metric that is written beside the output would be the one that is read.
    assert_says(&refused_output(&input, &work.path("size.meshb"), &field), &["size.solb", "would be overwritten"]);
    let report = text(&input);
    assert_says(
        &work.refusal(&input, &["--metric", &metric, "--report", &report]),
        &["in.meshb", "would be overwritten"],
    );
    assert_eq!(std::fs::read(&input).unwrap(), before);
    assert_eq!(Field::read(Path::new(&metric), mesh.vertices.len()).unwrap().content.metrics.len(), 64);
}

#[test]
fn two_outputs_in_one_file_are_refused() {
    let (work, _, input, metric) = prepared();
    for name in ["out.meshb", "out.solb"] {
        let report = text(&work.path(name));
        assert_says(&work.refusal(&input, &["--metric", &metric, "--report", &report]), &[name, "--report"]);
    }
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let (work, _, input, metric) = prepared();
    let field = ["--metric", metric.as_str()];
    let missing = work.path("no/where/out.meshb");
    assert_says(&refused_output(&input, &missing, &field), &["out.meshb", "no/where", "make it first"]);
    let report = text(&work.path("no/report.json"));
    assert_says(&work.refusal(&input, &["--metric", &metric, "--report", &report]), &["report.json", "make it first"]);
    for name in ["out.xyz", "out"] {
        assert_says(&refused_output(&input, &work.path(name), &field), &[name, "these are: .mesh, .meshb"]);
    }
    assert_says(&refused_output(&input, &work.path("out.sol"), &field), &["out.sol", "holds fields and no mesh"]);
    let folder = work.path("folder.meshb");
    std::fs::create_dir(&folder).unwrap();
    assert_says(&refused_output(&input, &folder, &field), &["folder.meshb", "folder"]);
}

#[test]
fn missing_and_foreign_files_are_named() {
    let (work, _, input, metric) = prepared();
    assert_says(&work.refusal(&work.path("none.meshb"), &["--metric", &metric]), &["none.meshb", "No such file"]);
    assert_says(&work.refusal(&input, &["--metric", &text(&work.path("none.solb"))]), &["none.solb", "No such file"]);
    let foreign = work.path("mesh.xyz");
    std::fs::write(&foreign, "# a file of some other program\n").unwrap();
    assert_says(&work.refusal(&foreign, &["--metric", &metric]), &["mesh.xyz", "the format is not known"]);
    assert_says(&work.refusal(&input, &["--metric", &text(&foreign)]), &["mesh.xyz", "the format is not known"]);
    let cad = text(&work.path("none.step"));
    assert_says(&work.refusal(&input, &["--metric", &metric, "--cad", &cad]), &["none.step"]);
    let cad = text(&foreign);
    assert_says(&work.refusal(&input, &["--metric", &metric, "--cad", &cad]), &["mesh.xyz"]);
    // A mesh where the metric should be, and the other way round.
    assert_says(&work.refusal(&input, &["--metric", &text(&input)]), &["in.meshb"]);
    assert_says(&work.refusal(Path::new(&metric), &["--metric", &metric]), &["size.solb"]);
    let cut = work.path("cut.meshb");
    let bytes = std::fs::read(&input).unwrap();
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    assert_says(&work.refusal(&cut, &["--metric", &metric]), &["cut.meshb"]);
}

#[test]
fn a_metric_that_is_none_is_named_with_its_vertex() {
    let (work, mesh, input, metric) = prepared();
    let write = |metrics: Vec<Sym3>| write_tensors(Path::new(&metric), metrics.into_iter());
    let field = ["--metric", metric.as_str()];
    write(vec![Sym3::IDENTITY; 63]);
    assert_says(&work.refusal(&input, &field), &["size.solb", "63 vertices", "64", "made for this mesh"]);
    for bad in [Sym3::diagonal(1.0, -2.0, 1.0), Sym3::diagonal(1.0, 0.0, 1.0)] {
        let mut metrics = vec![Sym3::IDENTITY; mesh.vertices.len()];
        metrics[41] = bad;
        write(metrics);
        assert_says(&work.refusal(&input, &field), &["size.solb", "vertex 42", "not positive definite"]);
    }
}

#[test]
fn a_mesh_that_is_none_is_named_with_its_tetrahedron() {
    let (work, mesh, input, metric) = prepared();
    let field = ["--metric", metric.as_str()];
    let refused = |change: &dyn Fn(&mut TetMesh)| {
        let mut mesh = mesh.clone();
        change(&mut mesh);
        io::write_mesh(&input, &mesh).unwrap();
        work.refusal(&input, &field)
    };
    let inverted = refused(&|mesh| mesh.tets.nodes[7].swap(1, 2));
    assert_says(&inverted, &["in.meshb", "tetrahedron 8", "inverted", "geo-adapt inspect"]);
    let flat = refused(&|mesh| {
        let [a, b, _, _] = mesh.tets.nodes[7];
        mesh.vertices[a as usize] = mesh.vertices[b as usize];
    });
    assert_says(&flat, &["in.meshb", "flat", "geo-adapt inspect"]);
    let surface = refused(&|mesh| mesh.tets = Elements::default());
    assert_says(&surface, &["in.meshb", "no tetrahedra", "volume mesh"]);
    let twice = refused(&|mesh| mesh.tets.push(mesh.tets.nodes[9], 1));
    assert_says(&twice, &["in.meshb", "tetrahedra share the face", "geo-adapt inspect"]);
}

#[test]
fn texts_with_holes_are_named_with_the_line() {
    let (work, _, input, metric) = prepared();
    let refused = |name: &str, text: &str| {
        let path = work.path(name);
        std::fs::write(&path, text).unwrap();
        match name.ends_with(".mesh") {
            true => work.refusal(&path, &["--metric", &metric]),
            false => work.refusal(&input, &["--metric", path.to_str().unwrap()]),
        }
    };
    let head = "MeshVersionFormatted 2\nDimension 3\n";
    assert_says(&refused("empty.mesh", &format!("{head}Vertices\n0\nEnd\n")), &["empty.mesh", "Vertices"]);
    assert_says(&refused("nan.mesh", &format!("{head}Vertices\n1\n0 nan 0 1\nEnd\n")), &["nan.mesh", "line 5"]);
    assert_says(
        &refused("flat.mesh", "MeshVersionFormatted 2\nDimension 2\nVertices\n1\n0 0 1\nEnd\n"),
        &["flat.mesh", "dimension"],
    );
    let sol = |row: &str| format!("{head}SolAtVertices\n64\n1 3\n{}End\n", format!("{row}\n").repeat(64));
    assert_says(&refused("nan.sol", &sol("1 0 nan 0 0 1")), &["nan.sol", "line 6"]);
    assert_says(&refused("short.sol", &sol("1 0 1 0 0")), &["short.sol"]);
    let vector = format!("{head}SolAtVertices\n64\n1 2\n{}End\n", "1 0 0\n".repeat(64));
    assert_says(&refused("vector.sol", &vector), &["vector.sol", "vector", "symmetric tensors", "isotropic sizes"]);
    let sizes = format!("{head}SolAtVertices\n64\n1 1\n{}-1\nEnd\n", "0.1\n".repeat(63));
    assert_says(&refused("sizes.sol", &sizes), &["sizes.sol", "the size of vertex 64 is -1", "--field"]);
}

#[test]
fn the_metric_is_given_once_and_by_a_known_name() {
    let (work, _, input, metric) = prepared();
    assert_says(&work.refusal(&input, &[]), &["--metric", "--analytic"]);
    let both = work.refusal(&input, &["--metric", &metric, "--analytic", "linear"]);
    assert_says(&both, &["--metric", "--analytic", "cannot be used with"]);
    assert_says(&work.refusal(&input, &["--analytic", "polar-3"]), &["polar-3", "linear", "polar-1", "polar-2"]);
}

#[test]
fn numbers_out_of_range_are_refused_with_the_range() {
    let (work, _, input, metric) = prepared();
    let with = |arguments: &[&str]| work.refusal(&input, &[&["--metric", metric.as_str()], arguments].concat());
    for option in ["--complexity", "--tolerance"] {
        for value in ["0", "-1", "nan", "inf", "many", "1e999"] {
            assert_says(&with(&[option, value]), &[option, value, "positive number"]);
        }
    }
    for value in ["0", "-1", "1025", "two"] {
        assert_says(&with(&["--threads", value]), &["--threads", value]);
    }
    assert_says(&with(&["--criterion", "luck"]), &["--criterion", "luck", "possible values"]);
}

#[test]
fn a_metric_of_more_vertices_than_a_mesh_can_number_is_refused_at_once() {
    let (work, mesh, input, metric) = prepared();
    let wanted = ["1e12 vertices", "smaller --complexity"];
    assert_says(&work.refusal(&input, &["--metric", &metric, "--complexity", "5e11"]), &wanted);
    assert_says(&work.refusal(&input, &["--analytic", "linear", "--complexity", "5e11"]), &wanted);
    // A size in millimetres for a mesh in metres.
    let metric = work.metric(&mesh, |_| isotropic(1e-4));
    assert_says(&work.refusal(&input, &["--metric", &metric]), &["2e12 vertices", "units", "--complexity"]);
}

/// Bytes that may be written to the disk of a folder.
#[cfg(target_os = "linux")]
fn free_bytes(folder: &str) -> f64 {
    let df = std::process::Command::new("df").args(["--output=avail", "-B1", folder]).output().unwrap();
    String::from_utf8(df.stdout)
        .unwrap()
        .lines()
        .last()
        .and_then(|free| free.trim().parse().ok())
        .unwrap_or(f64::INFINITY)
}

/// It was found after the whole adaptation.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_without_room_for_the_mesh_is_told_before_the_work() {
    // It takes 34 GB; this disk is half of the memory.
    let free = free_bytes("/dev/shm");
    let folder = tempfile::tempdir_in("/dev/shm");
    let (Ok(folder), true) = (folder, free < 30e9) else {
        eprintln!("/dev/shm cannot be written, or has {free} bytes free: not tried");
        return;
    };
    let (_work, _, input, _) = prepared();
    let output = folder.path().join("out.meshb");
    let arguments = ["--analytic", "linear", "--complexity", "2e8", "--max-vertices", "400000000"];
    assert_says(&refused_output(&input, &output, &arguments), &["out.meshb", "MB free", "vertices", "make room"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn an_error_is_all_that_quiet_lets_through() {
    let (work, _, input, _) = prepared();
    let run = work.command(&input, &["--quiet", "--metric", "none.solb"]).output().unwrap();
    assert_says(&complaint(&run), &["none.solb"]);
    assert_eq!(stderr(&run).lines().count(), 1);
}

/// They came out as a metric file of zeros, or as an error about the output.
#[test]
fn sizes_that_cannot_be_computed_with_are_refused_with_the_vertex() {
    let (work, mesh) = (Workplace::new(), cube(2, |_| 1));
    let input = work.mesh(&mesh);
    for eigenvalue in [1e-308, 1e308, 1e-250, 1e250] {
        let metric = work.metric(&mesh, |p| Sym3::IDENTITY.times(if p == [1.0; 3] { eigenvalue } else { 1.0 }));
        for more in [&[][..], &["--complexity", "100"]] {
            let message = work.refusal(&input, &[&["--metric", &metric], more].concat());
            assert_says(&message, &["in.meshb", "vertex 27", "sizes", "1e-100", "--hmin"]);
        }
        work.adapt(&input, &["--metric", &metric, "--hmin", "0.5", "--hmax", "2"]);
        ["out.meshb", "out.solb"].iter().for_each(|name| std::fs::remove_file(work.path(name)).unwrap());
    }
}

#[test]
fn what_cannot_be_frozen_is_refused() {
    let (work, _, input, metric) = prepared();
    let refused =
        |freeze: &str| complaint(&work.command(&input, &["--metric", &metric, "--freeze", freeze]).output().unwrap());
    assert_says(&refused("77"), &["in.meshb", "no surface with reference 77", "1"]);
    assert_says(&refused("region:5"), &["in.meshb", "no region with reference 5"]);
    assert_says(&refused("wing"), &["in.meshb", "no surface or region called wing", "give a reference"]);
}
