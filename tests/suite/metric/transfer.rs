//! `geo-adapt transfer`: fields from one mesh to another, linear and conservative, by files.

use crate::common::adapting::{Workplace, complaint, cube, isotropic, stderr, text};
use crate::common::program;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::vector::{Vec3, norm, volume6};
use geo_adapt::mesh::{TetMesh, validity};
use serde_json::Value;
use std::path::Path;

/// A folder with two meshes.
struct Pair {
    work: Workplace,
    meshes: [TetMesh; 2],
}

impl Pair {
    fn new(old: TetMesh, new: TetMesh) -> Self {
        let work = Workplace::new();
        for (name, mesh) in [("old.meshb", &old), ("new.meshb", &new)] {
            assert!(validity::check(mesh).is_valid());
            io::write_mesh(&work.path(name), mesh).unwrap();
        }
        Self { work, meshes: [old, new] }
    }

    /// A cube and one with moved vertices.
    fn of_cubes() -> Self {
        Self::new(cube(6, |_| 1), moved(cube(7, |_| 1)))
    }

    fn path(&self, name: &str) -> String {
        text(&self.work.path(name))
    }

    /// A field at the vertices of the old mesh, as old.solb.
    fn field(&self, kind: FieldKind, at: impl Fn(Vec3) -> Vec<f64>) {
        let values = self.meshes[0].vertices.iter().flat_map(|&p| at(p)).collect();
        let solution =
            Solution { vertices: self.meshes[0].vertices.len(), fields: vec![SolutionField { kind, values }] };
        io::write_solution(&self.work.path("old.solb"), &solution).unwrap();
    }

    /// `geo-adapt transfer`, which must succeed, and the report.
    fn transfer(&self, [old, from, new, to]: [&str; 4], options: &[&str]) -> (Solution, Value) {
        let report = self.path("report.json");
        let mut command = program();
        command.arg("transfer").args([old, from, new].map(|name| self.path(name))).arg("-o").arg(self.path(to));
        let run = command.args(["--report", &report]).args(options).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        assert!(run.stdout.starts_with(b"method"), "{:?}", String::from_utf8(run.stdout));
        let report = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        (io::read_solution(&self.work.path(to)).unwrap().content, report)
    }

    /// One that must be refused; the message.
    fn refusal(&self, arguments: [&str; 3], options: &[&str]) -> String {
        let mut command = program();
        command.arg("transfer").args(arguments.map(|name| self.path(name))).args(options);
        if !options.contains(&"-o") {
            command.arg("-o").arg(self.path("refused.solb"));
        }
        let message = complaint(&command.output().unwrap());
        assert!(!self.work.path("refused.solb").exists());
        message
    }
}

const THERE: [&str; 4] = ["old.meshb", "old.solb", "new.meshb", "new.solb"];

/// Inner vertices moved by up to a fifth of a cell.
fn moved(mut mesh: TetMesh) -> TetMesh {
    let step = 0.2 / ((mesh.vertices.len() as f64).cbrt() - 1.0);
    for p in &mut mesh.vertices {
        let q = *p;
        for i in (0..3).filter(|&i| q[i] > 0.0 && q[i] < 1.0) {
            p[i] += step * (97.0 * q[(i + 1) % 3] + 31.0 * q[(i + 2) % 3] + 7.0 * q[i]).sin();
        }
    }
    mesh
}

/// A ball of radius 1: the cube blown up.
fn ball(n: u32) -> TetMesh {
    let mut mesh = cube(n, |_| 1);
    for p in &mut mesh.vertices {
        let q = p.map(|x| 2.0 * x - 1.0);
        let far = q.iter().fold(0.0f64, |far, x| far.max(x.abs()));
        *p = if far == 0.0 { q } else { q.map(|x| x * far / norm(q)) };
    }
    mesh
}

/// The integral of a scalar field.
fn mass(mesh: &TetMesh, values: &[f64]) -> f64 {
    let of_tet = |nodes: &[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        volume6(a, b, c, d) / 24.0 * nodes.iter().map(|&v| values[v as usize]).sum::<f64>()
    };
    mesh.tets.nodes.iter().map(of_tet).sum()
}

fn wavy(p: Vec3) -> Vec<f64> {
    vec![2.0 + (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + if p[2] > 0.4 { 1.0 } else { 0.0 }]
}

fn bounds(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)])
}

#[test]
fn linear_fields_of_all_kinds_are_exact() {
    let pair = Pair::of_cubes();
    let linear = |p: Vec3, k: usize| 1.0 + k as f64 + p[0] - 2.0 * p[1] * (k + 1) as f64 + 3.0 * p[2];
    let kinds = [FieldKind::Vector, FieldKind::Scalar, FieldKind::Tensor, FieldKind::SymmetricTensor];
    let old = &pair.meshes[0];
    let fields = kinds.map(|kind| {
        let row = |p: &Vec3| (0..kind.values()).map(|k| linear(*p, k)).collect::<Vec<_>>();
        SolutionField { kind, values: old.vertices.iter().flat_map(row).collect() }
    });
    let solution = Solution { vertices: old.vertices.len(), fields: fields.to_vec() };
    io::write_solution(&pair.work.path("old.solb"), &solution).unwrap();
    for options in [&[][..], &["--conservative"], &["--conservative=mass"]] {
        let (found, report) = pair.transfer(THERE, options);
        assert_eq!(found.fields.iter().map(|field| field.kind).collect::<Vec<_>>(), kinds);
        for (field, kind) in found.fields.iter().zip(kinds) {
            for (row, &p) in field.values.chunks(kind.values()).zip(&pair.meshes[1].vertices) {
                for (k, value) in row.iter().enumerate() {
                    assert!(
                        (value - linear(p, k)).abs() < 1e-12 * 30.0,
                        "{options:?} {kind:?} {value} {}",
                        linear(p, k)
                    );
                }
            }
        }
        assert_eq!((report["outside"].as_u64(), report["values"].as_array().unwrap().len()), (Some(0), 19));
    }
}

#[test]
fn five_times_forth_and_back_the_mass_stays_and_no_extremum_is_new() {
    let pair = Pair::of_cubes();
    pair.field(FieldKind::Scalar, wavy);
    let read = |name: &str| io::read_solution(&pair.work.path(name)).unwrap().content.fields[0].values.clone();
    let start = read("old.solb");
    let first = mass(&pair.meshes[0], &start);
    for _ in 0..5 {
        for (names, mesh) in [(THERE, 1), (["new.meshb", "new.solb", "old.meshb", "old.solb"], 0)] {
            let before = bounds(&read(names[1]));
            // To where it came from: the file that is written is no input.
            let (found, report) = pair.transfer([names[0], names[1], names[2], names[3]], &["--conservative"]);
            let values = &found.fields[0].values;
            let after = bounds(values);
            assert!(after[0] >= before[0] && after[1] <= before[1], "{before:?} {after:?}");
            assert!((mass(&pair.meshes[mesh], values) / first - 1.0).abs() < 1e-12);
            assert_eq!(report["overlap"]["outside"], 0);
        }
    }
    // Second order of accuracy, so what is left of the waves is not little.
    let [range, was] = [bounds(&read("old.solb")), bounds(&start)].map(|[low, high]| high - low);
    assert!(range > 0.5 * was, "{range} {was}");
}

#[test]
fn between_meshes_of_a_curved_body_too() {
    let pair = Pair::new(ball(8), ball(6));
    pair.field(FieldKind::Vector, |p| vec![101_325.0, 2.0 + p[0] * p[1], p[2]]);
    let masses = |report: &Value, at: &str| {
        report["values"].as_array().unwrap().iter().map(|value| value[at]["mass"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    let mut first = Vec::new();
    for round in 0..5 {
        let (there, report) = pair.transfer(THERE, &["--conservative"]);
        let [v, w] = [0, 1].map(|i| report["volumes"][i].as_f64().unwrap());
        assert!(w < 0.99 * v && report["overlap"]["partly_outside"].as_u64() > Some(0));
        for (before, after) in masses(&report, "before").iter().zip(masses(&report, "after")) {
            assert!((after / w - before / v).abs() < 1e-12 * (before / v).abs().max(1.0), "{before} {after}");
        }
        assert!(there.fields[0].values.chunks(3).all(|row| row[0] == 101_325.0));
        if round == 0 {
            first = masses(&report, "before");
        }
        let back = ["new.meshb", "new.solb", "old.meshb", "old.solb"];
        let (_, report) = pair.transfer(back, &["--conservative"]);
        assert!(report["overlap"]["partly_outside"].as_u64() > Some(0));
        for (last, first) in masses(&report, "after").iter().zip(&first) {
            assert!((last - first).abs() < 1e-12 * first.abs().max(1.0), "{last} {first}");
        }
    }
    // The mass itself, where a field has room for it.
    let (_, report) = pair.transfer(THERE, &["--conservative=mass"]);
    let (before, after) = (masses(&report, "before"), masses(&report, "after"));
    assert!((after[1] / before[1] - 1.0).abs() < 1e-12, "{before:?} {after:?}");
    assert!((after[0] / before[0] - 1.0).abs() > 0.01, "a constant stays one");
}

#[test]
fn a_metric_is_interpolated_as_metrics_are() {
    let pair = Pair::of_cubes();
    pair.field(FieldKind::SymmetricTensor, |p| isotropic(0.1 + p[0]).0.to_vec());
    let (found, _) = pair.transfer(THERE, &["--metric"]);
    let out = pair.path("out.solb");
    let mut command = program();
    command.args(["metric", "interpolate"]).args(["old.meshb", "old.solb", "new.meshb"].map(|name| pair.path(name)));
    assert!(command.args(["-o", &out]).output().unwrap().status.success());
    assert_eq!(found, io::read_solution(Path::new(&out)).unwrap().content);
    let (linear, _) = pair.transfer(THERE, &[]);
    assert!(linear != found);
}

#[test]
fn the_same_file_on_any_number_of_threads() {
    let pair = Pair::new(ball(9), ball(10));
    pair.field(FieldKind::Vector, |p| vec![p[0] * p[1], (9.0 * p[2]).sin(), 1.0]);
    for options in [&[][..], &["--conservative"]] {
        let files = ["1", "2", "3"].map(|threads| {
            pair.transfer(THERE, &[options, &["--threads", threads]].concat());
            std::fs::read(pair.work.path("new.solb")).unwrap()
        });
        assert!(files[0] == files[1] && files[1] == files[2]);
    }
}

#[test]
fn what_lies_outside_is_counted() {
    let mut far = cube(4, |_| 1);
    far.vertices.iter_mut().for_each(|p| p[0] *= 1.5);
    let pair = Pair::new(cube(4, |_| 1), far);
    pair.field(FieldKind::Scalar, |p| vec![p[0]]);
    for options in [&[][..], &["--conservative"]] {
        let (found, report) = pair.transfer(THERE, options);
        assert_eq!(report["outside"], 2 * 25);
        assert!((report["farthest"].as_f64().unwrap() - 0.5).abs() < 1e-14);
        assert!(bounds(&found.fields[0].values)[1] <= 1.0);
    }
}

#[test]
fn bad_input_is_told() {
    let pair = Pair::of_cubes();
    pair.field(FieldKind::Scalar, wavy);
    let good = ["old.meshb", "old.solb", "new.meshb"];
    let says = |message: String, parts: &[&str]| {
        parts.iter().for_each(|part| assert!(message.contains(part), "'{part}' is not in: {message}"));
    };
    says(pair.refusal(["old.meshb", "none.solb", "new.meshb"], &[]), &["none.solb"]);
    says(
        pair.refusal(["new.meshb", "old.solb", "old.meshb"], &[]),
        &["old.solb", "343 vertices", "512", "mesh they belong to"],
    );
    says(pair.refusal(["old.meshb", "new.meshb", "old.meshb"], &[]), &["new.meshb", "no field at the vertices"]);
    pair.field(FieldKind::Scalar, |p| vec![p[0]]);
    says(pair.refusal(good, &["--metric"]), &["old.solb", "the size of vertex 1 is 0"]);
    pair.field(FieldKind::Vector, |p| p.to_vec());
    says(pair.refusal(good, &["--metric"]), &["old.solb", "symmetric tensors"]);
    pair.field(FieldKind::Scalar, wavy);
    says(pair.refusal(good, &["--metric", "--conservative"]), &["--conservative"]);
    says(pair.refusal(good, &["-o", &pair.path("old.solb")]), &["old.solb", "is an input"]);
    says(pair.refusal(good, &["-o", &pair.path("out.meshb")]), &[".sol or .solb"]);
    says(pair.refusal(good, &["-o", &pair.path("none/out.solb")]), &["no folder"]);
    let mut surface = pair.meshes[1].clone();
    surface.tets = Default::default();
    io::write_mesh(&pair.work.path("surface.meshb"), &surface).unwrap();
    says(pair.refusal(["old.meshb", "old.solb", "surface.meshb"], &[]), &["surface.meshb", "no tetrahedra"]);
    let mut inverted = pair.meshes[1].clone();
    inverted.tets.nodes[4].swap(1, 2);
    io::write_mesh(&pair.work.path("inverted.meshb"), &inverted).unwrap();
    let message = pair.refusal(["old.meshb", "old.solb", "inverted.meshb"], &["--conservative"]);
    says(message, &["inverted.meshb", "tetrahedron 5", "inverted", "inspect"]);
    // It is no harm where only vertices are asked for.
    pair.transfer(["old.meshb", "old.solb", "inverted.meshb", "new.solb"], &[]);
    std::fs::write(pair.work.path("empty.sol"), "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n343\n0\nEnd\n")
        .unwrap();
    says(pair.refusal(["old.meshb", "empty.sol", "new.meshb"], &[]), &["empty.sol"]);
}

#[test]
fn sizes_are_interpolated_as_the_metric_that_they_are() {
    let pair = Pair::of_cubes();
    let size = |p: Vec3| (1.0 + p[0]).exp();
    pair.field(FieldKind::Scalar, |p| vec![size(p)]);
    let (found, _) = pair.transfer(THERE, &["--metric"]);
    assert_eq!((found.fields.len(), found.fields[0].kind), (1, FieldKind::SymmetricTensor));
    // Their logarithm is linear, so it comes out exactly.
    for (terms, &p) in found.fields[0].values.chunks(6).zip(&pair.meshes[1].vertices) {
        let wanted = size(p).powi(-2);
        for (term, wanted) in terms.iter().zip([wanted, 0.0, wanted, 0.0, 0.0, wanted]) {
            assert!((term - wanted).abs() < 1e-12, "{terms:?} at {p:?}");
        }
    }
}
