//! Prisms stay as they are, and the tetrahedra beside them are adapted.
use crate::common::adapting::{Workplace, complaint, stderr};
use crate::common::program;
use geo_adapt::formats::{self, Dataset};
use geo_adapt::mesh::samples::on_prisms;
use geo_adapt::mesh::stack::Stack;
use geo_adapt::mesh::vector::volume6;
use serde_json::Value;
use std::path::Path;

/// A cube on a layer of prisms, as in.su2.
fn on_a_layer(work: &Workplace, n: u32, height: f64) -> Dataset {
    let (mut mesh, mut stack) = on_prisms(n, height);
    stack.join(&mut mesh).unwrap();
    let data = Dataset { mesh, stack, ..Dataset::default() };
    formats::write(&work.path("in.su2"), &data).unwrap();
    read(&work.path("in.su2"))
}

/// Runs `adapt`; the mesh and the report.
fn adapted(work: &Workplace, output: &str, arguments: &[&str]) -> (Dataset, Value) {
    let (input, output, report) = (work.path("in.su2"), work.path(output), work.path("report.json"));
    let mut command = program();
    command.arg("adapt").arg(&input).arg("-o").arg(&output).arg("--report").arg(&report).args(arguments);
    let run = command.args(["--threads", "1"]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    (read(&output), serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap())
}

fn read(path: &Path) -> Dataset {
    formats::read(path).unwrap().content
}

/// The cells and quadrilaterals with the coordinates of their nodes, to the bit.
fn bits(data: &Dataset) -> Vec<(i32, Vec<[u64; 3]>)> {
    let bits = |v: &u32| data.mesh.vertices[*v as usize].map(f64::to_bits);
    let Stack { cells, quads, .. } = &data.stack;
    let cells = cells.iter().map(|cell| (cell.reference, cell.nodes().iter().map(bits).collect()));
    cells.chain(quads.iter().map(|(nodes, reference)| (reference, nodes.iter().map(bits).collect()))).collect()
}

/// The whole domain is there, every tetrahedron positive.
fn check(before: &Dataset, after: &Dataset) {
    assert_eq!(bits(before), bits(after));
    let volume = |data: &Dataset| {
        let of = |nodes: &[u32; 4]| {
            let [a, b, c, d] = nodes.map(|v| data.mesh.vertices[v as usize]);
            volume6(a, b, c, d) / 6.0
        };
        assert!(data.mesh.tets.nodes.iter().all(|nodes| of(nodes) > 0.0));
        data.mesh.tets.nodes.iter().map(of).sum::<f64>()
    };
    assert!((volume(before) - volume(after)).abs() < 1e-12);
    // The stack's vertices come first, in the order in which they were.
    let mut used: Vec<u32> = after.stack.nodes().collect();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used, (0..used.len() as u32).collect::<Vec<_>>());
}

fn least(report: &Value) -> f64 {
    report["statistics"]["mean_ratios"]["min"].as_f64().unwrap()
}

#[test]
fn prisms_stay_to_the_bit_at_finer_and_at_coarser_sizes() {
    let work = Workplace::new();
    let before = on_a_layer(&work, 4, 0.05);
    for (size, output) in [("0.08", "out.su2"), ("0.6", "out.vtu"), ("0.15", "out.b8.ugrid"), ("0.15", "out.meshb")] {
        let (after, report) = adapted(&work, output, &["--size", size]);
        check(&before, &after);
        assert!(least(&report) >= 0.2, "{size}: {}", least(&report));
        let kept = &report["kept"];
        assert_eq!((kept["prisms"].as_u64(), kept["triangles"].as_u64()), (Some(32), Some(32)));
        let tets = after.stack.own()[0];
        // There were 384.
        assert!(if size == "0.6" { tets < 384 } else { tets > 2 * 384 }, "{size}: {tets}");
    }
}

#[test]
fn a_second_cycle_goes_on_from_the_first() {
    let work = Workplace::new();
    let before = on_a_layer(&work, 3, 0.1);
    let (after, report) = adapted(&work, "out.msh", &["--size", "0.2", "--cycles", "2"]);
    check(&before, &after);
    assert!(least(&report) >= 0.2, "{}", least(&report));
}

#[test]
fn a_file_of_mesh_and_fields_has_them_too() {
    let work = Workplace::new();
    let before = on_a_layer(&work, 3, 0.1);
    let (field, picked) = (work.path("field.vtu"), work.path("picked.vtu"));
    let run = |words: &[&str], files: [&Path; 2]| {
        let run = program().args(words).arg(files[0]).arg("-o").arg(files[1]).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        let found = read(files[1]);
        assert_eq!((bits(&found), found.fields.len()), (bits(&before), 1));
    };
    run(&["field", "evaluate", "--function", "tanh3"], [&work.path("in.su2"), &field]);
    run(&["field", "pick", "--take", "1"], [&field, &picked]);
}

#[test]
fn what_does_not_keep_them_says_so() {
    let work = Workplace::new();
    on_a_layer(&work, 2, 0.1);
    let refused = |output: &str, more: &[&str]| {
        let mut command = program();
        command.arg("adapt").arg(work.path("in.su2")).arg("-o").arg(work.path(output)).args(["--size", "0.2"]);
        complaint(&command.args(more).output().unwrap())
    };
    assert!(refused("out.vtk", &[]).contains("for which this format is not written: give .meshb"));
    assert!(refused("out.meshb", &["--memory", "1G"]).contains("split them by `geo-adapt convert --split`"));
}
