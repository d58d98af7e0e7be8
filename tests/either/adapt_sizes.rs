//! Bounds of the sizes that `adapt` takes: local ones, limits, and what the geometry asks for.

use crate::common::adapting::{Workplace, cube, isotropic, stderr, text};
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
    // On a mesh that resolves it, the metric of 60 segments has a complexity of 1290, on this one of 1563: that of 55 is less than half of 3000 here too.
    let (_, note) = around(&["--segments", "55"]);
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

/// Scalars at the vertices, as mmg3d's users have them.
fn scalars(work: &Workplace, name: &str, mesh: &TetMesh, at: impl Fn([f64; 3]) -> f64) -> String {
    let values = mesh.vertices.iter().map(|&p| at(p)).collect();
    let fields = vec![SolutionField { kind: FieldKind::Scalar, values }];
    io::write_solution(&work.path(name), &Solution { vertices: mesh.vertices.len(), fields }).unwrap();
    text(&work.path(name))
}

#[test]
fn scalars_of_a_metric_file_and_a_size_give_the_mesh_of_the_same_tensors() {
    let work = Workplace::new();
    let input = cube(4, |_| 1);
    let path = work.mesh(&input);
    let size = |p: [f64; 3]| 0.1 + 0.2 * p[0];
    let tensors = work.metric(&input, |p| isotropic(size(p)));
    let expected = work.adapt(&path, &["--metric", &tensors]).mesh;
    let sizes = scalars(&work, "sizes.sol", &input, size);
    assert_eq!(work.adapt(&path, &["--metric", &sizes]).mesh, expected);
    // The same by way of a file of tensors.
    let made = text(&work.path("made.solb"));
    let run =
        crate::common::program().args(["metric", "isotropic", &text(&path), &sizes, "-o", &made]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(stderr(&run).contains("isotropic sizes, from 0.1000 to 0.3000"), "{}", stderr(&run));
    let found = geo_adapt::metric::Field::read(&work.path("made.solb"), input.vertices.len()).unwrap().content.metrics;
    for (metric, &p) in found.iter().zip(&input.vertices) {
        assert!(metric.sizes().iter().all(|h| (h / size(p) - 1.0).abs() < 1e-12), "{metric:?} at {p:?}");
    }
    // One size everywhere.
    let tensors = work.metric(&input, |_| isotropic(0.2));
    let expected = work.adapt(&path, &["--metric", &tensors]).mesh;
    assert_eq!(work.adapt(&path, &["--size", "0.2"]).mesh, expected);
    let refused = work.command(&path, &["--size", "0.2", "--complexity", "100"]).output().unwrap();
    assert!(stderr(&refused).contains("--size") && stderr(&refused).contains("cannot be used with"));
}

#[test]
fn of_anisotropic_tensors_isotropic_takes_the_least_size() {
    let work = Workplace::new();
    let input = cube(1, |_| 1);
    let tensors = work.metric(&input, |_| geo_adapt::metric::Sym3::diagonal(1.0, 100.0, 4.0));
    let (path, made) = (text(&work.mesh(&input)), work.path("made.solb"));
    let run =
        crate::common::program().args(["metric", "isotropic", &path, &tensors, "-o", &text(&made)]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    for metric in geo_adapt::metric::Field::read(&made, input.vertices.len()).unwrap().content.metrics {
        assert!(metric.sizes().iter().all(|h| (h / 0.1 - 1.0).abs() < 1e-12), "{metric:?}");
    }
}

#[test]
fn a_number_of_vertices_is_met() {
    let work = Workplace::new();
    let input = cube(4, |_| 1);
    let path = work.mesh(&input);
    let tensors = work.metric(&input, |p| isotropic(0.1 + 0.4 * p[2]));
    // So few that the boundary is much of the mesh: half of them for the complexity is far off.
    for (arguments, wanted) in [
        (vec!["--metric", &tensors, "--vertices", "300"], 300.0),
        (vec!["--metric", &tensors, "--vertices", "3000", "--local", "6:h=0.1"], 3000.0),
        (vec!["--analytic", "polar-1", "--vertices", "4000"], 4000.0),
        (vec!["--field", &field(&work, &input), "--vertices", "1000"], 1000.0),
    ] {
        let found = work.adapt(&path, &arguments);
        let vertices = found.mesh.vertices.len() as f64;
        assert!((vertices / wanted - 1.0).abs() <= 0.1, "{vertices}, not {wanted}: {arguments:?}");
        assert_eq!(found.report["vertices_wanted"]["is_met"], true);
        assert_eq!(found.report["vertices_wanted"]["wanted"], wanted);
    }
}

#[test]
fn a_number_of_vertices_that_cannot_be_met_is_told() {
    let work = Workplace::new();
    let path = work.mesh(&cube(6, |_| 1));
    let report = text(&work.path("report.json"));
    let arguments = ["--metric", &work.metric(&cube(6, |_| 1), |_| isotropic(0.2)), "--vertices", "60"];
    let frozen = [&arguments[..], &["--freeze", "1,2,3,4,5,6", "--report", &report]].concat();
    let run = work.command(&path, &frozen).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let out = String::from_utf8_lossy(&run.stdout).into_owned();
    assert!(out.contains("vertices wanted") && out.contains("not met"), "{out}");
    assert_eq!(work.result().report["vertices_wanted"]["is_met"], false);
}

#[test]
fn a_box_has_its_size_and_a_size_grows_with_the_distance_from_a_surface() {
    let work = Workplace::new();
    let input = cube(8, |_| 1);
    let path = work.mesh(&input);
    let found = work.adapt(&path, &["--size", "0.25", "--local", "box:0.3,0.3,0.3,0.45,0.45,0.45:h=0.04"]);
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for edge in geo_adapt::mesh::adjacency::unique_edges(&found.mesh.tets.nodes) {
        let [a, b] = edge.map(|v| found.mesh.vertices[v as usize]);
        let within = |low: f64, high: f64| [a, b].iter().flatten().all(|x| (low..high).contains(x));
        match () {
            () if within(0.3, 0.45) => inside.push(distance(a, b)),
            () if within(0.8, 1.1) => outside.push(distance(a, b)),
            () => {}
        }
    }
    let mean = |lengths: &[f64]| lengths.iter().sum::<f64>() / lengths.len() as f64;
    assert!((0.032..0.048).contains(&mean(&inside)), "{} of {}", mean(&inside), inside.len());
    assert!(mean(&outside) > 0.12, "{} of {}", mean(&outside), outside.len());
    // The metric written has the sizes that are asked for: least at the wall z = 1, a fifth of the distance more away from it. What gradation
    // or interpolation between the vertices takes off is little here.
    let found = work.adapt(&path, &["--size", "0.5", "--local", "6:h=0.05,growth=1.2"]);
    for (metric, p) in found.metrics.iter().zip(&found.mesh.vertices) {
        let wanted = 0.05 + 0.2 * (1.0 - p[2]);
        assert!(metric.sizes().iter().all(|h| (0.9..1.001).contains(&(h / wanted))), "{:?} at {p:?}", metric.sizes());
    }
    let says = work.command(&path, &["--size", "0.5", "--local", "box:2,2,2,3,3,3:h=0.1"]).output().unwrap();
    assert!(crate::common::adapting::complaint(&says).contains("reaches from (0.000000, 0.000000, 0.000000)"));
    let says = work.command(&path, &["--size", "0.5", "--local", "region:1:h=0.1,growth=1.2"]).output().unwrap();
    assert!(crate::common::adapting::complaint(&says).contains("of a region leave the growth out"));
}

#[cfg(feature = "occt")]
#[test]
fn a_size_grows_with_the_exact_distance_from_a_curved_face() {
    let work = Workplace::new();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let model = text(&root.join("geometry/cube-cylinder.step"));
    let start = root.join("cases/cube-cylinder/start.meshb");
    let mesh = io::read_mesh(&start).unwrap().content;
    let on_wall = |p: &[f64; 3]| (p[0].hypot(p[1]) - 0.5).abs() < 1e-3;
    let round = mesh.triangles.iter().find(|(nodes, _)| nodes.iter().all(|&v| on_wall(&mesh.vertices[v as usize])));
    let local = format!("{}:h=0.03,growth=1.3", round.unwrap().1);
    let first = work.adapt(&start, &["--cad", &model, "--size", "0.3", "--local", &local]);
    // The first mesh is coarse; on its result the sizes are what the distance asks for.
    let input = work.path("second.meshb");
    std::fs::rename(&first.path, &input).unwrap();
    let found = work.adapt(&input, &["--cad", &model, "--size", "0.3", "--local", &local]);
    let mut farthest: f64 = 0.0;
    for (metric, p) in found.metrics.iter().zip(&found.mesh.vertices) {
        let away = (p[0].hypot(p[1]) - 0.5).abs();
        farthest = farthest.max(away);
        let wanted = (0.03 + 0.3 * away).min(0.3);
        assert!(metric.sizes().iter().all(|h| (0.85..1.01).contains(&(h / wanted))), "{:?} at {p:?}", metric.sizes());
    }
    assert!(farthest > 0.3, "{farthest}");
}
