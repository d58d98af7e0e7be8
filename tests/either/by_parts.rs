//! `adapt --memory`: part by part, in memory or by a scratch folder, on any number of threads, killed or not: the same files.
#![cfg(target_os = "linux")]
use crate::common::adapting::{Adapted, Workplace, areas, complaint, cube, stderr, text, volumes};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::{read_mesh, write_mesh};
use geo_adapt::mesh::vector::{Vec3, norm, sub};
use geo_adapt::metric::Sym3;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Little enough for a scratch folder.
const LITTLE: [&str; 2] = ["--memory", "1MB"];
const MUCH: [&str; 2] = ["--memory", "4GiB"];
/// Of so few vertices that a small mesh has several parts.
const PARTS: [&str; 2] = ["--part-vertices", "600"];
const FIELD: [&str; 4] = ["--analytic", "polar-1", "--complexity", "2500"];

/// What a run wrote: mesh and metric.
fn written(work: &Workplace, mesh: &Path, arguments: &[&[&str]]) -> [Vec<u8>; 2] {
    let run = work.command(mesh, &arguments.concat()).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(!work.path("out.meshb.scratch").exists(), "the scratch folder goes with the run");
    ["out.meshb", "out.solb"].map(|name| std::fs::read(work.path(name)).unwrap())
}

#[test]
fn the_same_bytes_in_memory_and_by_a_scratch_folder_and_on_any_threads() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |p| if p[0] < 0.6 { 1 } else { 2 }));
    let known = written(&work, &mesh, &[&FIELD, &PARTS, &MUCH, &["--threads", "1"]]);
    assert!(known[0].len() > 200_000, "large enough to be cut");
    for (memory, threads) in [(MUCH, "2"), (MUCH, "5"), (LITTLE, "1"), (LITTLE, "3")] {
        let now = written(&work, &mesh, &[&FIELD, &PARTS, &memory, &["--threads", threads]]);
        assert!(now == known, "{memory:?}, {threads} threads");
    }
    let in_one = written(&work, &mesh, &[&FIELD, &MUCH]);
    assert!(in_one != known, "it was cut");
}

/// The report of a run.
fn reported(work: &Workplace, mesh: &Path, arguments: &[&[&str]]) -> Value {
    let report = text(&work.path("report.json"));
    written(work, mesh, &[arguments, &[&["--report", &report]]].concat());
    serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap()
}

#[test]
fn what_is_near_former_cuts_is_reported_apart() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let parts = ["--part-vertices", "2000"];
    let known = reported(&work, &mesh, &[&FIELD, &parts, &MUCH, &["--threads", "2"]]);
    let near = &known["parts"]["near_cuts"];
    let number = |of: &Value| of.as_f64().unwrap();
    let [untouched, around, at_cuts] = ["untouched", "around", "at_cuts"].map(|place| &near[place]);
    let tets = [untouched, around, at_cuts].map(|of| number(&of["tets"]));
    assert!(tets[0] > 500.0 && tets[2] > 500.0 && tets[2] < tets[1], "{near}");
    // Both together are the mesh.
    let statistics = &known["statistics"];
    assert_eq!(tets[0] + tets[1], number(&statistics["tets"]));
    assert_eq!(number(&untouched["edges"]) + number(&around["edges"]), number(&statistics["edge_lengths"]["count"]));
    let joined = |count: &str, of: &str| {
        let [a, b] = [untouched, around].map(|place| (number(&place[count]), number(&place[of])));
        (a.0 * a.1 + b.0 * b.1) / (a.0 + b.0)
    };
    assert!((joined("tets", "mean_ratio") - number(&statistics["mean_ratios"]["mean"])).abs() < 1e-9);
    assert!((joined("edges", "unit_edges") - number(&statistics["metric"]["unit_edges"])).abs() < 1e-9);
    let least = [untouched, around].map(|place| number(&place["least_ratio"]));
    assert_eq!(least[0].min(least[1]), number(&statistics["mean_ratios"]["min"]));
    // What was at a cut is about as good as the rest.
    assert!(number(&at_cuts["mean_ratio"]) > number(&untouched["mean_ratio"]) - 0.02, "{near}");
    assert!(number(&at_cuts["unit_edges"]) > number(&untouched["unit_edges"]) - 0.03, "{near}");
    assert_eq!(&reported(&work, &mesh, &[&FIELD, &parts, &LITTLE, &["--threads", "1"]])["parts"]["near_cuts"], near);
    // In one part there is no cut.
    let near = &reported(&work, &mesh, &[&FIELD, &MUCH])["parts"]["near_cuts"];
    assert!(near["around"].is_null() && number(&near["untouched"]["tets"]) > 1e3, "{near}");
}

/// A mesh of some thousand vertices with its metric in a file.
fn adapted_once(work: &Workplace) -> (PathBuf, String) {
    let mesh = work.mesh(&cube(3, |p| if p[0] < 0.6 { 1 } else { 2 }));
    written(work, &mesh, &[&FIELD, &["--threads", "1"]]);
    for name in ["meshb", "solb"] {
        std::fs::rename(work.path(&format!("out.{name}")), work.path(&format!("in.{name}"))).unwrap();
    }
    (work.path("in.meshb"), text(&work.path("in.solb")))
}

/// Also where the metric of the input is cut into blocks, and with one that is the same everywhere.
#[test]
fn a_mesh_that_is_larger_than_memory_is_read_by_slices_and_adapted_to_the_same_bytes() {
    let work = Workplace::new();
    let (mesh, metric) = adapted_once(&work);
    for field in
        [&["--metric", &metric, "--complexity", "6000"][..], &["--metric", &metric], &["--size", "0.06"], &FIELD]
    {
        let known = written(&work, &mesh, &[field, &PARTS, &MUCH, &["--threads", "2"]]);
        for threads in ["1", "3"] {
            let now = written(&work, &mesh, &[field, &PARTS, &LITTLE, &["--threads", threads]]);
            assert!(now == known, "{field:?}, {threads} threads");
        }
    }
    // The same mesh in a format that is read as a whole.
    let field = &["--metric", &metric, "--complexity", "6000"][..];
    let known = written(&work, &mesh, &[field, &PARTS, &MUCH]);
    let whole = work.path("whole.mesh");
    write_mesh(&whole, &read_mesh(&mesh).unwrap().content).unwrap();
    assert!(written(&work, &whole, &[field, &PARTS, &MUCH]) == known);
    let run =
        work.command(&mesh, &[&FIELD[..], &PARTS, &LITTLE].concat()).env("GEO_ADAPT_STAGES", "1").output().unwrap();
    assert!(stderr(&run).contains("stage files opened"), "it was read by slices: {}", stderr(&run));
}

#[test]
fn a_mesh_by_slices_without_all_triangles_is_refused() {
    let work = Workplace::new();
    let (mesh, metric) = adapted_once(&work);
    let mut open = read_mesh(&mesh).unwrap().content;
    open.triangles.nodes.pop();
    open.triangles.refs.pop();
    let mesh = work.mesh(&open);
    let run = work.command(&mesh, &[&["--metric", &metric][..], &PARTS, &LITTLE].concat()).output().unwrap();
    assert!(complaint(&run).contains("triangles are missing on its boundary"), "{}", stderr(&run));
    written(&work, &mesh, &[&["--metric", &metric], &PARTS, &MUCH]);
}

#[test]
fn a_killed_run_goes_on_and_ends_with_the_same_bytes() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let report = text(&work.path("report.json"));
    let arguments = [&FIELD[..], &PARTS, &LITTLE, &["--threads", "1", "--report", &report]];
    let near = || -> Value {
        serde_json::from_slice::<Value>(&std::fs::read(&report).unwrap()).unwrap()["parts"]["near_cuts"].take()
    };
    let began = Instant::now();
    let known = written(&work, &mesh, &arguments);
    let (took, known_near) = (began.elapsed(), near());
    ["out.meshb", "out.solb"].iter().for_each(|name| std::fs::remove_file(work.path(name)).unwrap());
    let start = |command: &mut Command| command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let mut is_gone_on = false;
    for share in 1..20 {
        let mut child = start(&mut work.command(&mesh, &arguments.concat()));
        // On a busy machine all takes longer.
        std::thread::sleep(took * share / 20);
        let was_running = child.try_wait().unwrap().is_none();
        child.kill().ok();
        child.wait().unwrap();
        if !was_running {
            break;
        }
        let journal = std::fs::read_to_string(work.path("out.meshb.scratch").join("journal.json")).unwrap_or_default();
        is_gone_on |= journal.contains("\"round\":") && !journal.contains("\"round\":0,");
    }
    assert!(is_gone_on, "it was killed after a round");
    let now = written(&work, &mesh, &arguments);
    assert!(now == known);
    assert_eq!(near(), known_near);
}

/// A piece of another run is not taken for one's own.
#[test]
fn the_scratch_folder_of_another_run_is_begun_anew() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let arguments = [&FIELD[..], &PARTS, &LITTLE, &["--threads", "1"]];
    let known = written(&work, &mesh, &arguments);
    let other = [&["--analytic", "polar-1", "--complexity", "3000"][..], &PARTS, &LITTLE, &["--threads", "1"]].concat();
    let mut child = work.command(&mesh, &other).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let journal = work.path("out.meshb.scratch").join("journal.json");
    while !std::fs::read_to_string(&journal).unwrap_or_default().contains("\"round\":1") {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(written(&work, &mesh, &arguments) == known);
}

fn checked(work: &Workplace, mesh: &TetMesh, arguments: &[&[&str]]) -> Adapted {
    work.adapt(&work.mesh(mesh), &arguments.concat())
}

/// Regions, references, ridges and the sizes are as those of a run without parts.
#[test]
fn regions_and_references_are_kept() {
    let input = cube(4, |p| if p[0] + p[1] < 0.9 { 3 } else { 5 });
    for memory in [MUCH, LITTLE] {
        let work = Workplace::new();
        let metric = work.metric(&input, |p| Sym3::diagonal(150.0, 400.0, 150.0).times(0.4 + p[0]));
        let size = ["--metric", &metric];
        let whole = checked(&work, &input, &[&size]);
        let parts = checked(&work, &input, &[&size, &PARTS, &memory]);
        assert_eq!(areas(&parts.mesh).keys().collect::<Vec<_>>(), areas(&input).keys().collect::<Vec<_>>());
        for (now, before) in [(volumes(&parts.mesh), volumes(&input)), (areas(&parts.mesh), areas(&input))] {
            for (reference, value) in before {
                assert!((now[&reference] - value).abs() < 1e-9, "{reference}: {} and {value}", now[&reference]);
            }
        }
        assert!(whole.report.get("parts").is_none());
        assert!(parts.report["parts"]["rounds"][0]["parts"].as_u64().unwrap() > 1, "{}", parts.report["parts"]);
        let figures = |run: &Adapted| {
            let statistics = &run.report["statistics"];
            let [least, mean] = ["min", "mean"].map(|name| statistics["mean_ratios"][name].as_f64().unwrap());
            (
                statistics["vertices"].as_f64().unwrap(),
                statistics["metric"]["unit_edges"].as_f64().unwrap(),
                least,
                mean,
            )
        };
        let (whole, parts) = (figures(&whole), figures(&parts));
        // In parts there are rather fewer, of better lengths.
        assert!((0.9..1.05).contains(&(parts.0 / whole.0)), "{whole:?} {parts:?}");
        assert!(parts.1 > whole.1 - 0.01 && parts.2 > 0.8 * whole.2 && parts.3 > whole.3 - 0.01, "{whole:?} {parts:?}");
    }
}

#[test]
fn what_is_required_and_frozen_stays_in_every_part() {
    let mut input = cube(6, |p| if p[2] > 0.5 { 2 } else { 1 });
    input.required_vertices = (0..input.vertices.len() as u32).step_by(17).collect();
    let bits = |p: Vec3| p.map(f64::to_bits);
    let wanted: BTreeSet<_> = input.required_vertices.iter().map(|&v| bits(input.vertices[v as usize])).collect();
    let frozen = |mesh: &TetMesh| -> BTreeSet<Vec<[u64; 3]>> {
        let of_side = mesh.triangles.iter().filter(|(_, reference)| *reference == 3);
        let points = of_side.map(|(nodes, _)| {
            let mut points: Vec<_> = nodes.iter().map(|&v| bits(mesh.vertices[v as usize])).collect();
            points.sort_unstable();
            points
        });
        points.collect()
    };
    let work = Workplace::new();
    let metric = work.metric(&input, |_| Sym3::IDENTITY.times(180.0));
    let run = checked(&work, &input, &[&["--metric", &metric, "--freeze", "surface:3"], &PARTS, &LITTLE]);
    let required: BTreeSet<_> =
        run.mesh.required_vertices.iter().map(|&v| bits(run.mesh.vertices[v as usize])).collect();
    assert_eq!(required, wanted);
    assert_eq!(frozen(&run.mesh), frozen(&input));
}

/// A mesh that is much too fine becomes coarse, across the cuts too.
#[test]
fn a_fine_mesh_is_coarsened_part_by_part() {
    let input = cube(16, |_| 1);
    let work = Workplace::new();
    let metric = work.metric(&input, |_| Sym3::IDENTITY.times(9.0));
    let run = checked(&work, &input, &[&["--metric", &metric], &PARTS, &LITTLE]);
    let longest = |mesh: &TetMesh| {
        let edge = |a: u32, b: u32| norm(sub(mesh.vertices[a as usize], mesh.vertices[b as usize]));
        mesh.tets.nodes.iter().map(|n| edge(n[0], n[1]).max(edge(n[2], n[3]))).fold(0.0, f64::max)
    };
    assert!(run.mesh.vertices.len() < 250, "{}", run.mesh.vertices.len());
    assert!(longest(&run.mesh) > 0.25);
    assert!(run.report["statistics"]["mean_ratios"]["min"].as_f64().unwrap() > 0.3);
}

#[test]
fn what_cannot_be_done_part_by_part_is_told() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let refused = |more: &[&str], said: &str| {
        let message = work.refusal(&mesh, &[&FIELD[..], &LITTLE, more].concat());
        assert!(message.contains(said), "{message}");
    };
    refused(&["--cycles", "2"], "--cycles");
    refused(&["--max-vertices", "1000"], "--max-vertices");
    let foreign = work.path("foreign");
    std::fs::create_dir(&foreign).unwrap();
    std::fs::write(foreign.join("thesis.tex"), "mine").unwrap();
    refused(&["--scratch", &text(&foreign)], "is not empty, and no scratch folder");
    assert_eq!(std::fs::read_to_string(foreign.join("thesis.tex")).unwrap(), "mine");
    let vtu = Command::new(env!("CARGO_BIN_EXE_geo-adapt"))
        .args(["adapt", &text(&mesh), "-o", &text(&work.path("out.vtu"))])
        .args(FIELD)
        .args(LITTLE)
        .output()
        .unwrap();
    assert_eq!(vtu.status.code(), Some(2));
    assert!(stderr(&vtu).contains("written as .meshb alone"), "{}", stderr(&vtu));
}

/// An interrupt writes what there is, and leaves no scratch folder.
#[test]
fn an_interrupt_writes_a_valid_mesh() {
    let work = Workplace::new();
    let mesh = work.mesh(&cube(3, |_| 1));
    let report = text(&work.path("report.json"));
    let more = ["--complexity", "20000", "--report", &report];
    let mut child = work
        .command(&mesh, &[&["--analytic", "polar-1"][..], &more, &PARTS, &LITTLE].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let journal = work.path("out.meshb.scratch").join("journal.json");
    while !std::fs::read_to_string(&journal).unwrap_or_default().contains("\"round\":1") {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(5));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let run = work.result();
    assert!(run.mesh.vertices.len() > 100);
    assert!(!work.path("out.meshb.scratch").exists());
}

/// On a model every vertex of the boundary lies on it, and its association is whole.
#[cfg(feature = "occt")]
#[test]
fn on_a_model_every_boundary_vertex_lies_on_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (model, mesh) = (text(&root.join("geometry/cube-cylinder.step")), root.join("cases/cube-cylinder/start.meshb"));
    let work = Workplace::new();
    let arguments = [&["--cad", &model, "--analytic", "polar-2", "--complexity", "4000"][..], &PARTS];
    let run = work.adapt(&mesh, &[arguments[0], arguments[1], &MUCH].concat());
    assert!(run.report["fidelity"]["from_model"]["distance"].as_f64().unwrap() < 1e-9, "{}", run.report["fidelity"]);
    let known = std::fs::read(work.path("out.meshb")).unwrap();
    let run = work.adapt(&mesh, &[arguments[0], arguments[1], &LITTLE].concat());
    assert!(std::fs::read(work.path("out.meshb")).unwrap() == known);
    assert!(run.report["statistics"]["mean_ratios"]["min"].as_f64().unwrap() > 0.2);
    let on_model: usize =
        [run.mesh.association.vertices.len(), run.mesh.association.edges.len(), run.mesh.association.faces.len()]
            .iter()
            .sum();
    assert_eq!(on_model, run.report["fidelity"]["vertices"].as_u64().unwrap() as usize);
}
