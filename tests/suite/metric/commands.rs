//! `geo-adapt metric`: each command on a small mesh gives what it should, and bad input one error with code 2 and no file.

use crate::common::adapting::{Workplace, complaint, cube, isotropic, stderr, text, write_tensors};
use crate::common::program;
use geo_adapt::image::{Encoding, Frame, Image, Kind};
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::mesh::{TetMesh, io};
use geo_adapt::metric::{Field, Sym3, field};
use geo_adapt::tasks::Team;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// A cube with metrics, in a folder of its own.
struct Bench {
    work: Workplace,
    mesh: TetMesh,
    input: String,
}

impl Bench {
    fn new(n: u32) -> Self {
        let (work, mesh) = (Workplace::new(), cube(n, |_| 1));
        let input = text(&work.mesh(&mesh));
        Self { work, mesh, input }
    }

    fn path(&self, name: &str) -> String {
        text(&self.work.path(name))
    }

    fn metric(&self, name: &str, at: impl Fn(Vec3) -> Sym3) -> String {
        let path = self.path(name);
        write_tensors(Path::new(&path), self.mesh.vertices.iter().map(|&p| at(p)));
        path
    }

    /// Runs `geo-adapt metric` with these arguments and `-o out.solb`; it must succeed.
    fn make(&self, arguments: &[&str]) -> Vec<Sym3> {
        let out = self.path("out.solb");
        let run = metric(&[arguments, &["-o", &out]].concat());
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        io::read_solution(Path::new(&out)).unwrap().content.fields[0]
            .values
            .as_chunks()
            .0
            .iter()
            .map(|&terms| Sym3(terms))
            .collect()
    }

    /// Runs it on bad input; nothing may be written. The message.
    fn refusal(&self, arguments: &[&str]) -> String {
        let out = self.path("refused.solb");
        let run = metric(&[arguments, &["-o", &out]].concat());
        let message = complaint(&run);
        assert!(!Path::new(&out).exists(), "{message}");
        message
    }

    fn complexity(&self, metrics: &[Sym3]) -> f64 {
        field::complexity(Team::alone(), &self.mesh, metrics)
    }
}

fn metric(arguments: &[&str]) -> Output {
    program().arg("metric").args(arguments).output().unwrap()
}

fn close(found: &Sym3, expected: &Sym3, share: f64) -> bool {
    let size = expected.0.iter().fold(0.0f64, |a, x| a.max(x.abs()));
    (0..6).all(|i| (found.0[i] - expected.0[i]).abs() <= share * size)
}

fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

#[test]
fn intersect_asks_for_all_that_is_asked_for() {
    let bench = Bench::new(3);
    let a = bench.metric("a.solb", |p| Sym3::diagonal(1.0 + 99.0 * p[0], 4.0, 9.0));
    let b = bench.metric("b.sol", |_| Sym3::diagonal(16.0, 16.0, 1.0));
    let c = bench.metric("c.solb", |_| isotropic(0.5));
    let found = bench.make(&["intersect", &a, &b, &c]);
    for (m, p) in found.iter().zip(&bench.mesh.vertices) {
        let expected = Sym3::diagonal(f64::max(1.0 + 99.0 * p[0], 16.0), 16.0, 9.0);
        assert!(close(m, &expected, 1e-12), "{m:?} {expected:?}");
    }
    assert_eq!(bench.make(&["intersect", &b, &a, &c]), found);
    let out = bench.path("out.solb");
    let run = metric(&["intersect", &bench.input, &a, &b, "-o", &out]);
    says(&String::from_utf8(run.stdout).unwrap(), &["complexity", "intersection", "changes"]);
    let message = bench.refusal(&["intersect", &a]);
    says(&message, &["a.solb"]);
    let other = Bench::new(2);
    let d = other.metric("d.solb", |_| isotropic(1.0));
    says(&bench.refusal(&["intersect", &a, &d]), &["d.solb", "metric at 27 vertices", "64"]);
    says(&bench.refusal(&["intersect", &bench.input, &d, &d]), &["d.solb", "64"]);
    let run = metric(&["intersect", &a, &b, "-o", &b]);
    says(&complaint(&run), &["b.sol", "would be overwritten"]);
    says(&bench.refusal(&["intersect", &a, &bench.path("none.solb")]), &["none.solb"]);
}

#[test]
fn scale_reaches_its_complexity() {
    let bench = Bench::new(4);
    let a = bench.metric("a.solb", |p| Sym3([4.0 + p[0], 0.5, 9.0, 0.25, -1.0, 25.0 + 100.0 * p[2]]));
    let found = bench.make(&["scale", &bench.input, &a, "--complexity", "5000"]);
    assert!((bench.complexity(&found) / 5000.0 - 1.0).abs() < 1e-10);
    let before = Field::read(Path::new(&a), found.len()).unwrap().content.metrics;
    let factor = found[0].0[0] / before[0].0[0];
    assert!(found.iter().zip(&before).all(|(m, b)| close(m, &b.times(factor), 1e-12)));
    for bad in ["-5", "0", "many"] {
        says(&bench.refusal(&["scale", &bench.input, &a, "--complexity", bad]), &["--complexity", "positive"]);
    }
    let indefinite = bench.metric("bad.solb", |p| Sym3::diagonal(1.0, p[0] - 0.5, 1.0));
    let message = bench.refusal(&["scale", &bench.input, &indefinite, "--complexity", "10"]);
    says(&message, &["bad.solb", "vertex 1", "not positive definite"]);
    says(&bench.refusal(&["scale", &bench.path("no.meshb"), &a, "--complexity", "10"]), &["no.meshb"]);
    // Tetrahedra inside out have no complexity.
    let mut mirrored = bench.mesh.clone();
    mirrored.vertices.iter_mut().for_each(|p| p[0] = -p[0]);
    let path = bench.path("mirrored.meshb");
    io::write_mesh(Path::new(&path), &mirrored).unwrap();
    says(&bench.refusal(&["scale", &path, &a, "--complexity", "10"]), &["mirrored.meshb", "complexity"]);
}

/// It wrote zeros on the diagonal and exited 0: the terms were too small for a double.
#[test]
fn a_metric_that_doubles_do_not_hold_is_not_written() {
    let bench = Bench::new(1);
    let scaled = |metric: &str| bench.refusal(&["scale", &bench.input, metric, "--complexity", "1e-120"]);
    let small = bench.metric("small.solb", |p| Sym3::IDENTITY.times(if p == [1.0; 3] { 1e-190 } else { 1.0 }));
    says(&scaled(&small), &["refused.solb", "vertex 8 cannot be written", "sizes would be", "metric limit", "--hmax"]);
    // Along no axis, the least of these eigenvalues is less than the rounding of the others.
    let tensor = Sym3::from_sizes([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], [1e6, 1.0, 1e-3]);
    let slanting = bench.metric("slanting.solb", |_| tensor);
    let straight = bench.metric("straight.solb", |_| Sym3::diagonal(1e-12, 1.0, 1e6));
    assert!(bench.make(&["scale", &bench.input, &straight, "--complexity", "10"]).iter().all(Sym3::is_spd));
    let message = metric(&["scale", &bench.input, &slanting, "--complexity", "10", "-o", &bench.path("some.solb")]);
    match message.status.code() {
        Some(0) => assert!(Field::read(Path::new(&bench.path("some.solb")), 8).is_ok()),
        _ => says(&complaint(&message), &["cannot be written"]),
    }
}

/// Sizes from 1e-160 to 1e160: what is written can be read, else there is an error that names the vertex, and the remedy helps.
#[test]
fn sizes_at_the_ends_of_what_doubles_hold() {
    let bench = Bench::new(1);
    for exponent in [-153, -101, -99, -50, 0, 50, 99, 101, 153] {
        let size = 10f64.powi(exponent);
        let eigenvalue = 1.0 / (size * size);
        let a = bench.metric("a.solb", |_| Sym3::IDENTITY.times(eigenvalue));
        let held = (-100..=100).contains(&exponent);
        let commands: [&[&str]; 4] = [
            &["grade", &bench.input, &a],
            &["scale", &bench.input, &a, "--complexity", "100"],
            &["intersect", &a, &a],
            &["limit", &a, "--aspect-ratio", "100"],
        ];
        for command in commands {
            if held {
                assert!(bench.make(command).iter().all(Sym3::is_spd), "{command:?} {size}");
            } else {
                says(&bench.refusal(command), &["vertex 1", "sizes", "metric limit", "--hm"]);
            }
        }
        let within = bench.make(&["limit", &a, "--hmin", "1e-3", "--hmax", "1e3"]);
        assert!(within.iter().all(|m| m.is_spd() && m.sizes().iter().all(|h| (0.9e-3..1.1e3).contains(h))), "{size}");
    }
    // A subnormal eigenvalue is none that can be computed with, and a zero none at all.
    let subnormal = bench.metric("subnormal.solb", |_| Sym3::diagonal(1.0, 1.0, 1e-310));
    says(&bench.refusal(&["grade", &bench.input, &subnormal]), &["vertex 1", "sizes"]);
    let zero = bench.metric("zero.solb", |_| Sym3::diagonal(1.0, 1.0, 0.0));
    says(&bench.refusal(&["grade", &bench.input, &zero]), &["vertex 1", "not positive definite"]);
}

#[test]
fn grade_bounds_the_growth_once() {
    let bench = Bench::new(6);
    let fine = |p: Vec3| p == [0.5; 3];
    let a = bench.metric("a.solb", |p| if fine(p) { isotropic(1e-2) } else { isotropic(1.0) });
    let found = bench.make(&["grade", &bench.input, &a, "--ratio", "1.3", "--threads", "1"]);
    for (m, p) in found.iter().zip(&bench.mesh.vertices) {
        // Sizes grow by ln r a length, along edges.
        let away = p.iter().map(|x| (x - 0.5).abs()).sum::<f64>();
        assert!(m.sizes()[0] <= 1e-2 + away * 1.3f64.ln() + 1e-3, "{:?} {p:?}", m.sizes());
    }
    let once = bench.path("once.solb");
    std::fs::rename(bench.path("out.solb"), &once).unwrap();
    let again = bench.make(&["grade", &bench.input, &once, "--ratio", "1.3", "--threads", "2"]);
    assert!(again.iter().zip(&found).all(|(a, b)| close(a, b, 1e-12)));
    for bad in ["1", "0.5", "-2", "nan"] {
        says(&bench.refusal(&["grade", &bench.input, &a, "--ratio", bad]), &["--ratio", "above 1"]);
    }
}

#[test]
fn limit_bounds_sizes_and_their_ratio() {
    let bench = Bench::new(2);
    let a = bench
        .metric("a.solb", |_| Sym3::from_sizes([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]], [1e-3, 0.1, 3.0]));
    for (arguments, expected) in [
        (vec!["--hmin", "0.01"], [3.0, 0.1, 0.01]),
        (vec!["--hmax", "1"], [1.0, 0.1, 1e-3]),
        (vec!["--aspect-ratio", "50"], [0.05, 0.05, 1e-3]),
        (vec!["--hmin", "0.01", "--hmax", "0.5", "--aspect-ratio", "20"], [0.2, 0.1, 0.01]),
    ] {
        let found = bench.make(&[&["limit", &a], &arguments[..]].concat());
        for m in &found {
            let sizes = m.sizes();
            assert!((0..3).all(|i| (sizes[i] / expected[i] - 1.0).abs() < 1e-8), "{sizes:?} {expected:?}");
        }
    }
    says(&bench.refusal(&["limit", &a]), &["--hmin"]);
    says(&bench.refusal(&["limit", &a, "--hmin", "-1"]), &["--hmin", "positive"]);
    says(&bench.refusal(&["limit", &a, "--hmin", "2", "--hmax", "1"]), &["--hmin 2", "--hmax 1"]);
    says(&bench.refusal(&["limit", &a, "--aspect-ratio", "0.5"]), &["--aspect-ratio", "1 or more"]);
    let wrong = bench.path("out.xyz");
    says(&complaint(&metric(&["limit", &a, "--hmin", "1", "-o", &wrong])), &["out.xyz", ".solb"]);
}

#[test]
fn implied_is_the_metric_of_the_mesh() {
    let bench = Bench::new(5);
    let found = bench.make(&["implied", &bench.input]);
    // Each tetrahedron has the volume √2/12 in its own metric, and all are alike.
    let expected = 2f64.sqrt() / 12.0 * bench.mesh.tets.len() as f64;
    assert!((bench.complexity(&found) / expected - 1.0).abs() < 1e-9);
    let out = bench.path("out.solb");
    let run = program().arg("inspect").arg(&bench.input).args(["--metric", &out, "--json"]).output().unwrap();
    let inspected: Value = serde_json::from_slice(&run.stdout).unwrap();
    let per = inspected["metric"]["vertices_per_complexity"].as_f64().unwrap();
    assert!((1.4..2.6).contains(&per), "{per}");
    let mean = inspected["edge_lengths"]["mean"].as_f64().unwrap();
    assert!((mean - 1.0).abs() < 0.1, "{mean}");
    let mut flat = bench.mesh.clone();
    flat.vertices.iter_mut().for_each(|p| p[1] = 0.0);
    let path = bench.path("flat.meshb");
    io::write_mesh(Path::new(&path), &flat).unwrap();
    says(&bench.refusal(&["implied", &path]), &["flat.meshb", "flat or inverted"]);
}

#[test]
fn interpolate_takes_a_metric_to_another_mesh() {
    let bench = Bench::new(3);
    // ln M is linear: so is its interpolant.
    let at = |p: Vec3| Sym3::diagonal(p[0].exp(), (2.0 * p[1]).exp(), (3.0 - p[2]).exp());
    let a = bench.metric("a.solb", at);
    let new = Bench::new(4);
    let found = bench.make(&["interpolate", &bench.input, &a, &new.input]);
    assert_eq!(found.len(), new.mesh.vertices.len());
    assert!(found.iter().zip(&new.mesh.vertices).all(|(m, &p)| close(m, &at(p), 1e-12)));
    let mut away = new.mesh.clone();
    away.vertices.iter_mut().for_each(|p| p[0] += 0.5);
    let path = bench.path("away.meshb");
    io::write_mesh(Path::new(&path), &away).unwrap();
    let run = metric(&["interpolate", &bench.input, &a, &path, "-o", &bench.path("out.solb")]);
    // Two of five planes of vertices are outside.
    says(&String::from_utf8(run.stdout).unwrap(), &["50, they", "0.5000"]);
    says(&bench.refusal(&["interpolate", &new.input, &a, &bench.input]), &["a.solb", "64", "125"]);
}

#[test]
fn from_points_follows_their_density() {
    let bench = Bench::new(3);
    let cloud = bench.path("cloud.csv");
    let mut lines = String::from("x,y,z\n");
    for i in 0..20 * 20 * 40 {
        let at = [i / 800, i / 40 % 20, i % 40].map(f64::from);
        lines += &format!("{},{},{}\n", (at[0] + 0.5) / 20.0, (at[1] + 0.5) / 20.0, (at[2] + 0.5) / 40.0);
    }
    std::fs::write(&cloud, &lines).unwrap();
    let found = bench.make(&["from-points", &bench.input, &cloud, "--neighbours", "40"]);
    let inside = bench.mesh.vertices.iter().position(|p| p.iter().all(|x| (0.3..0.4).contains(x))).unwrap();
    let sizes = found[inside].sizes();
    assert!(sizes[0] < 0.2 && sizes[2] > 0.05, "{sizes:?}");
    // The vertices of a mesh are points too.
    bench.make(&["from-points", &bench.input, &Bench::new(8).input]);
    std::fs::write(&cloud, "0 0 0\n1 0 0\n1 0 0\n0 1 0\n").unwrap();
    says(&bench.refusal(&["from-points", &bench.input, &cloud]), &["cloud.csv", "3 different points", "--neighbours"]);
    std::fs::write(&cloud, "0 0 0\n1 zero 0\n").unwrap();
    says(&bench.refusal(&["from-points", &bench.input, &cloud]), &["cloud.csv", "line 2", "three finite numbers"]);
    says(&bench.refusal(&["from-points", &bench.input, &cloud, "--neighbours", "2"]), &["--neighbours"]);
}

#[test]
fn show_measures_a_metric() {
    let bench = Bench::new(4);
    let a = bench.metric("a.solb", |_| Sym3::diagonal(4.0, 100.0, 10000.0));
    let json = bench.path("shown.json");
    let run = metric(&["show", &bench.input, &a, "--report", &json]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    says(&String::from_utf8(run.stdout).unwrap(), &["complexity", "aspect ratio", "gradation", "99 %"]);
    let shown: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let is = |value: &Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs() < 1e-9;
    assert!(is(&shown["complexity"], 2000.0) && is(&shown["complexity_between"], 2000.0), "{shown}");
    assert!(is(&shown["least_size"]["median"], 0.01) && is(&shown["greatest_size"]["p90"], 0.5), "{shown}");
    assert!(is(&shown["aspect_ratio"]["greatest"], 50.0) && is(&shown["anisotropic_quotient"]["least"], 250.0));
    assert!(is(&shown["gradation"]["greatest"], 1.0), "{shown}");
    says(&complaint(&metric(&["show", &bench.input, &a, "--report", &a])), &["a.solb", ".json"]);
    says(&complaint(&metric(&["show", &bench.input])), &["METRIC"]);
}

#[test]
fn a_metric_is_the_same_bit_for_bit_on_any_number_of_threads() {
    let bench = Bench::new(8);
    let a = bench.metric("a.solb", |p| {
        let (s, c) = (4.0 * p[0]).sin_cos();
        Sym3::from_sizes([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]], [10f64.powf(-3.0 * p[1]), 0.5, 1.0])
    });
    let other = Bench::new(5);
    let new = other.input.clone();
    for arguments in [
        vec!["grade", &bench.input, &a],
        vec!["scale", &bench.input, &a, "--complexity", "1e4"],
        vec!["implied", &bench.input],
        vec!["from-points", &bench.input, &new],
    ] {
        let one = bench.make(&[&arguments[..], &["--threads", "1"]].concat());
        assert_eq!(bench.make(&[&arguments[..], &["--threads", "4", "-q"]].concat()), one, "{arguments:?}");
    }
}

/// Writes an image of 24³ voxels over the unit cube.
fn image(bench: &Bench, name: &str, kind: Kind, value: impl Fn(Vec3) -> f64) -> String {
    let (n, path) = (24, bench.path(name));
    let h = 1.0 / n as f64;
    let frame = Frame::new([0.5 * h; 3], [[h, 0.0, 0.0], [0.0, h, 0.0], [0.0, 0.0, h]]).unwrap();
    let at = |voxel: usize| frame.point([voxel % n, voxel / n % n, voxel / (n * n)].map(|i| i as f64));
    let image = Image::new([n; 3], frame, kind, (0..n * n * n).map(|voxel| value(at(voxel))));
    geo_adapt::image::write(Path::new(&path), &image, Encoding::Gzip).unwrap();
    path
}

#[test]
fn from_image_is_fine_where_the_image_changes() {
    let bench = Bench::new(12);
    let size = |metrics: &[Sym3], at: Vec3| {
        let away = |p: &Vec3| (0..3).map(|i| (p[i] - at[i]).powi(2)).sum::<f64>();
        let nearest =
            (0..metrics.len()).min_by(|&a, &b| away(&bench.mesh.vertices[a]).total_cmp(&away(&bench.mesh.vertices[b])));
        metrics[nearest.unwrap()].sizes()
    };
    // A wall at x = 0.5 between labels 1 and 2.
    let labels = image(&bench, "labels.nrrd", Kind::Uint8, |p| if p[0] < 0.5 { 1.0 } else { 2.0 });
    let asked = ["--mesh", &bench.input, "--complexity", "3000"];
    let found = bench.make(&[&["from-image", &labels], &asked[..]].concat());
    assert!((bench.complexity(&found) / 3000.0 - 1.0).abs() < 1e-2);
    let (wall, inside) = (size(&found, [0.5; 3]), size(&found, [0.25, 0.5, 0.5]));
    assert!(inside[0] - wall[0] > 0.08 && wall[0] / wall[2] < 1.0 + 1e-9, "{wall:?} {inside:?}");
    // A grey layer: fine across it, but not below half a voxel.
    let grey = image(&bench, "grey.nrrd", Kind::Float, |p| (20.0 * (p[0] - 0.5)).tanh());
    let of_grey = ["--mesh", &bench.input, "--complexity", "300"];
    let found = bench.make(&[&["from-image", &grey], &of_grey[..]].concat());
    assert!((bench.complexity(&found) / 300.0 - 1.0).abs() < 1e-2);
    let bend = [7.0 / 12.0, 0.5, 0.5];
    let beside = size(&found, bend);
    assert!(beside[0] / beside[2] > 3.0 && beside[2] > 0.999 / 48.0, "{beside:?}");
    // Coarser far away, where the tails of tanh bend e⁻²⁰ times as much; between, the norm L² asks for its share.
    assert!(size(&found, [0.0, 0.5, 0.5])[2] > 2.0 * beside[2], "{beside:?}");
    // The same values as integers are grey when that is said.
    let integers = image(&bench, "integers.nrrd", Kind::Int16, |p| 1000.0 * (20.0 * (p[0] - 0.5)).tanh());
    let again = bench.make(&[&["from-image", &integers, "--grey"], &of_grey[..]].concat());
    assert!((size(&again, bend)[2] / beside[2] - 1.0).abs() < 0.05);
    says(
        &bench.refusal(&[&["from-image", &labels, "--hmin", "0.3"], &asked[..]].concat()),
        &["in.meshb", "cannot be reached"],
    );
    let empty = image(&bench, "empty.nrrd", Kind::Uint8, |_| 0.0);
    says(&bench.refusal(&[&["from-image", &empty], &asked[..]].concat()), &["empty.nrrd", "no border"]);
    let constant = image(&bench, "constant.nrrd", Kind::Float, |_| 7.0);
    says(&bench.refusal(&[&["from-image", &constant], &asked[..]].concat()), &["constant.nrrd", "second derivatives"]);
    says(&bench.refusal(&[&["from-image", &bench.path("no.nrrd")], &asked[..]].concat()), &["no.nrrd"]);
    says(&bench.refusal(&[&["from-image", &grey, "--smooth", "-1"], &asked[..]].concat()), &["--smooth", "0 to 100"]);
}
