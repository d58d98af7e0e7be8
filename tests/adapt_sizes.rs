//! Bounds of the sizes that `adapt` takes: local ones, limits, and what the geometry asks for.
#![cfg(feature = "cli")]
mod common;

use common::adapting::{Workplace, cube, isotropic, stderr, text};
use geo_adapt::mesh::vector::distance;
use geo_adapt::mesh::{TetMesh, io};
use io::{FieldKind, Solution, SolutionField};

/// Mean length of the sides of the triangles of a reference.
fn mean_side(mesh: &TetMesh, wanted: i32) -> f64 {
    let sides = mesh.triangles.iter().filter(|&(_, reference)| reference == wanted).flat_map(|(nodes, _)| {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        [distance(a, b), distance(b, c), distance(c, a)]
    });
    let (sum, count) = sides.fold((0.0, 0), |(sum, count), side| (sum + side, count + 1));
    assert!(count > 0, "no triangle of reference {wanted}");
    sum / f64::from(count)
}

/// A function at the vertices that is curved alike in all directions.
fn field(work: &Workplace, mesh: &TetMesh) -> String {
    let values = mesh.vertices.iter().map(|p| p.iter().map(|x| x * x).sum()).collect();
    let path = work.path("field.solb");
    let solution =
        Solution { vertices: mesh.vertices.len(), fields: vec![SolutionField { kind: FieldKind::Scalar, values }] };
    io::write_solution(&path, &solution).unwrap();
    text(&path)
}

#[test]
fn a_local_size_holds_where_it_is_asked_for_and_grows_away_from_there() {
    let work = Workplace::new();
    let input = cube(6, |p| 1 + i32::from(p[0] > 0.5));
    let metric = work.metric(&input, |_| isotropic(0.3));
    let path = work.mesh(&input);
    let mesh = work.adapt(&path, &["--metric", &metric, "--local", "6:h=0.05"]).mesh;
    let [near, far] = [6, 5].map(|side| mean_side(&mesh, side));
    assert!(near < 0.06 && far > 0.15, "{near} on the side, {far} opposite");
    let of = |mesh: &TetMesh, region: i32| mesh.tets.refs.iter().filter(|&&r| r == region).count();
    let mesh = work.adapt(&path, &["--metric", &metric, "--local", "region:2:h=0.1"]).mesh;
    assert!(of(&mesh, 2) > 2 * of(&mesh, 1), "{} and {}", of(&mesh, 2), of(&mesh, 1));
    // The complexity that is asked for is met with it.
    let found = work.adapt(&path, &["--metric", &metric, "--local", "6:h=0.05", "--complexity", "4000"]);
    let reached = found.report["statistics"]["metric"]["complexity"].as_f64().unwrap();
    assert!((reached / 4000.0 - 1.0).abs() < 0.1, "{reached}");
    assert!(mean_side(&found.mesh, 6) < 0.06);
}

#[test]
fn limits_hold_for_the_metric_of_a_file_too() {
    let work = Workplace::new();
    let input = cube(4, |_| 1);
    let metric = work.metric(&input, |_| isotropic(0.05));
    let path = work.mesh(&input);
    let mesh = work.adapt(&path, &["--metric", &metric, "--hmin", "0.25"]).mesh;
    let side = mean_side(&mesh, 1);
    assert!((0.2..0.32).contains(&side), "{side}");
    let mesh = work.adapt(&path, &["--metric", &work.metric(&input, |_| isotropic(0.6)), "--hmax", "0.15"]).mesh;
    let side = mean_side(&mesh, 1);
    assert!((0.12..0.18).contains(&side), "{side}");
}

#[cfg(feature = "occt")]
#[test]
fn the_geometry_is_resolved_beside_a_field() {
    let work = Workplace::new();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let model = text(&root.join("geometry/cube-cylinder.step"));
    let start = root.join("cases/cube-cylinder/start.meshb");
    let mesh = io::read_mesh(&start).unwrap().content;
    let field = field(&work, &mesh);
    // The field asks for the same size everywhere.
    let around = |arguments: &[&str]| {
        let all = [&["--cad", &model, "--field", &field, "--complexity", "3000"], arguments].concat();
        let run = work.command(&start, &all).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        let mesh = io::read_mesh(&work.path("out.meshb")).unwrap().content;
        let is_round = |v: u32| (mesh.vertices[v as usize][0].hypot(mesh.vertices[v as usize][1]) - 0.5).abs() < 1e-9;
        let on_wall = (0..mesh.vertices.len() as u32).filter(|&v| is_round(v)).count();
        (on_wall, stderr(&run))
    };
    let (without, _) = around(&["--no-geometry"]);
    let (with, note) = around(&["--segments", "16"]);
    assert!(2 * with > 3 * without, "{with} vertices on the wall with the geometry, {without} without");
    assert!(!note.contains("enlarged"), "{note}");
    // On a mesh that resolves it, the metric of 60 segments has a complexity of 1290: less than half of 3000, and not only there.
    let (_, note) = around(&["--segments", "60"]);
    assert!(!note.contains("enlarged"), "{note}");
    let (_, note) = around(&["--segments", "240"]);
    assert!(note.contains("the geometry alone asks for") && note.contains("--no-geometry"), "{note}");
}

#[test]
fn sizes_that_cannot_be_are_refused() {
    let work = Workplace::new();
    let input = cube(3, |_| 1);
    let (path, metric) = (work.mesh(&input), work.metric(&input, |_| isotropic(0.3)));
    let refused = |arguments: &[&str], parts: &[&str]| {
        let run = work.command(&path, arguments).output().unwrap();
        assert_eq!(run.status.code(), Some(2), "{arguments:?}");
        parts.iter().for_each(|part| assert!(stderr(&run).contains(part), "'{part}' is not in: {}", stderr(&run)));
    };
    refused(&["--metric", &metric, "--local", "77:h=0.1"], &["in.meshb", "no surface with reference 77"]);
    refused(&["--metric", &metric, "--local", "1:0.1"], &["write 3:h=0.01"]);
    refused(&["--metric", &metric, "--local", "1:h=-2"], &["--local"]);
    refused(&["--analytic", "linear", "--local", "1:h=0.1"], &["--analytic", "--local"]);
    refused(&["--metric", &metric, "--hmin", "1", "--hmax", "0.5"], &["--hmin", "--hmax"]);
    refused(&["--metric", &metric, "--segments", "3"], &["--field"]);
    let field = field(&work, &input);
    refused(&["--field", &field, "--complexity", "500", "--cycles", "2"], &["--cycles", "--field"]);
}
