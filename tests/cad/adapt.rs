//! `geo-adapt adapt --cad`: the adapted mesh lies on the model, entity by entity.

use crate::common::adapting::{Adapted, Workplace, areas, isotropic, stderr, text};
use crate::common::program;
use geo_adapt::geometry::classify::{Options, classify};
use geo_adapt::geometry::{Evaluate, Geometry, Model, fidelity};
use geo_adapt::mesh::{TetMesh, io};
use geo_adapt::metric::Sym3;
use geo_adapt::tasks::Team;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A model of geometry/ and a start mesh on it.
struct Case {
    model_path: PathBuf,
    mesh_path: PathBuf,
    model: Model,
    mesh: TetMesh,
}

fn case(model: &str, mesh: &str) -> Case {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (model_path, mesh_path) = (root.join("geometry").join(model), root.join(mesh));
    let mesh = io::read_mesh(&mesh_path).unwrap().content;
    let model = Model::read(&model_path).unwrap();
    Case { model_path, mesh_path, model, mesh }
}

fn cube_cylinder() -> Case {
    case("cube-cylinder.step", "cases/cube-cylinder/start.meshb")
}

impl Case {
    fn adapt(&self, work: &Workplace, arguments: &[&str]) -> Adapted {
        let found = work.adapt(&self.mesh_path, &[&["--cad", &text(&self.model_path)], arguments].concat());
        self.check(&found);
        found
    }

    /// Everything that a mesh on a model promises.
    fn check(&self, found: &Adapted) {
        let mesh = &found.mesh;
        let (place, report) = classify(Team::alone(), mesh, &self.model, &Options::default()).unwrap();
        assert!(report.notices.is_empty(), "{:?}", report.notices);
        for dimension in &report.dimensions {
            assert_eq!(dimension.from_file, dimension.count, "the file's association is the model's: {report:?}");
        }
        assert_eq!(report.faces_from_file, mesh.triangles.len());
        let fidelity = fidelity::measure(Team::alone(), mesh, &self.model, &place);
        for farthest in [fidelity.from_model, fidelity.from_entity] {
            assert!(farthest.unwrap().distance < 1e-9, "{farthest:?}");
        }
        assert_eq!(found.report["off_model"], serde_json::json!([]));
        self.check_entities(mesh);
        assert_eq!(regions(mesh), regions(&self.mesh));
        self.check_areas(mesh);
    }

    /// All vertices, edges and faces of the model are there under their numbers.
    fn check_entities(&self, mesh: &TetMesh) {
        let topology = self.model.topology();
        let ends = |edge: &geo_adapt::geometry::EdgeEntity| edge.vertices.into_iter().flatten();
        let ridges = || (0..topology.edges.len() as u32).filter(|&edge| topology.is_ridge(edge));
        let corners: BTreeSet<i32> =
            ridges().flat_map(|edge| ends(&topology.edges[edge as usize])).map(|v| v as i32 + 1).collect();
        assert_eq!(mesh.association.vertices.iter().map(|on| on.id).collect::<BTreeSet<_>>(), corners);
        assert_eq!(mesh.corners.len(), corners.len());
        let edges: BTreeSet<i32> = ridges().map(|edge| edge as i32 + 1).collect();
        assert_eq!(mesh.edges.refs.iter().copied().collect::<BTreeSet<_>>(), edges);
        assert_eq!(mesh.ridges.len(), mesh.edges.len());
        let faces: BTreeSet<i32> = (1..=topology.faces.len() as i32).collect();
        assert_eq!(mesh.triangles.refs.iter().copied().collect::<BTreeSet<_>>(), faces);
    }

    /// Each face is covered once: its triangles have about its area.
    fn check_areas(&self, mesh: &TetMesh) {
        for (reference, area) in areas(mesh) {
            let truth = self.model.face_area(reference as u32 - 1).unwrap();
            assert!((area / truth - 1.0).abs() < 0.25, "face {reference}: {area} of {truth}");
        }
    }
}

fn regions(mesh: &TetMesh) -> BTreeSet<i32> {
    mesh.tets.refs.iter().copied().collect()
}

#[test]
fn the_cube_cylinder_in_the_linear_field() {
    let found = cube_cylinder().adapt(&Workplace::new(), &["--analytic", "linear", "--complexity", "600"]);
    assert!(unit_edges(&found) > 0.9, "{}", unit_edges(&found));
}

#[test]
fn the_cube_cylinder_in_the_field_polar_1() {
    let found = cube_cylinder().adapt(&Workplace::new(), &["--analytic", "polar-1", "--complexity", "500"]);
    assert!(unit_edges(&found) > 0.7, "{}", unit_edges(&found));
}

#[test]
fn the_cube_cylinder_in_the_field_polar_2() {
    let found = cube_cylinder().adapt(&Workplace::new(), &["--analytic", "polar-2", "--complexity", "600"]);
    assert!(unit_edges(&found) > 0.8, "{}", unit_edges(&found));
}

fn unit_edges(found: &Adapted) -> f64 {
    found.report["statistics"]["metric"]["unit_edges"].as_f64().unwrap()
}

/// Edges where faces meet smoothly, eighths of spheres, a bore with a seam.
#[test]
fn the_filleted_block_refined_and_coarsened() {
    let case = case("filleted-block.step", "tests/data/filleted-block.meshb");
    for (size, least, most) in [(0.15, 2500, 8000), (0.9, 60, 300)] {
        let work = Workplace::new();
        let metric = work.metric(&case.mesh, |_| isotropic(size));
        let found = case.adapt(&work, &["--metric", &metric]);
        let vertices = found.mesh.vertices.len();
        assert!((least..most).contains(&vertices), "{vertices} vertices at size {size}");
    }
}

/// A second shell, whose sphere has a seam and two poles: no mesh edge need follow them.
#[test]
fn the_sphere_in_its_box_refined_and_coarsened() {
    let case = case("sphere-in-box.step", "tests/data/sphere-in-box.meshb");
    for (size, least, most) in [(0.12, 2000, 8000), (0.7, 40, 250)] {
        let work = Workplace::new();
        let metric = work.metric(&case.mesh, |_| isotropic(size));
        let found = case.adapt(&work, &["--metric", &metric]);
        let vertices = found.mesh.vertices.len();
        assert!((least..most).contains(&vertices), "{vertices} vertices at size {size}");
    }
}

/// Greatest distance from the model of the triangles' centroids and of the middles of their edges.
fn chord_error(case: &Case, found: &Adapted) -> f64 {
    let mesh = &found.mesh;
    let (place, _) = classify(Team::alone(), mesh, &case.model, &Options::default()).unwrap();
    let mut evaluator = case.model.evaluator();
    let triangles = mesh.triangles.nodes.iter().zip(&place.faces);
    triangles.fold(0.0, |most, (nodes, &face)| {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        let third = 1.0 / 3.0;
        let weights = [[third; 3], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];
        weights.iter().fold(most, |most, w| {
            let p = std::array::from_fn(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k]);
            evaluator.closest_on_face(face, p, None).distance.max(most)
        })
    })
}

#[test]
fn triangles_stray_from_a_coarse_sphere_as_far_as_is_allowed() {
    let case = case("sphere-in-box.step", "tests/data/sphere-in-box.meshb");
    let runs = [&[][..], &["--hausdorff", "0.002"], &["--normal-deviation", "8"]].map(|bounds| {
        let work = Workplace::new();
        let metric = work.metric(&case.mesh, |_| isotropic(0.7));
        let found = case.adapt(&work, &[&["--metric", &metric], bounds].concat());
        assert_eq!(found.report["deviating"], 0, "{bounds:?}");
        let normal = found.report["fidelity"]["worst_normal"]["degrees"].as_f64().unwrap();
        (chord_error(&case, &found), normal)
    });
    let [free, chord, normal] = runs;
    let bound = 8.0;
    assert!(free.0 > 0.01 && chord.0 <= 0.002 * (1.0 + 1e-9), "{runs:?}");
    assert!(free.1 > bound && normal.1 <= bound * (1.0 + 1e-9), "{runs:?}");
}

#[test]
fn an_anisotropic_metric_across_the_seam_of_the_sphere() {
    let case = case("sphere-in-box.step", "tests/data/sphere-in-box.meshb");
    let work = Workplace::new();
    let metric = work.metric(&case.mesh, |_| Sym3::diagonal(100.0, 16.0, 9.0));
    let found = case.adapt(&work, &["--metric", &metric, "--threads", "2"]);
    assert!(unit_edges(&found) > 0.8, "{}", unit_edges(&found));
}

#[test]
fn adapting_the_result_again_keeps_it_on_the_model() {
    let mut case = cube_cylinder();
    let first = Workplace::new();
    let arguments = ["--analytic", "linear", "--complexity", "300"];
    case.mesh_path = case.adapt(&first, &arguments).path;
    case.adapt(&Workplace::new(), &arguments);
}

/// Required edges that are no edges of the model stay too.
#[test]
fn what_is_required_on_a_model_stays() {
    let mut case = cube_cylinder();
    let work = Workplace::new();
    let on_ridge = |v: &u32| case.mesh.edges.nodes.iter().flatten().any(|w| w == v);
    let is_inner = |(nodes, face): ([u32; 3], i32)| face == 5 && !on_ridge(&nodes[0]);
    let triangle = case.mesh.triangles.iter().position(is_inner).unwrap();
    let [a, b, c] = case.mesh.triangles.nodes[triangle];
    case.mesh.required_triangles = vec![triangle as u32];
    case.mesh.edges.push([a, b], 77);
    case.mesh.required_edges = vec![case.mesh.edges.len() as u32 - 1];
    case.mesh_path = work.mesh(&case.mesh);
    let arguments = ["--analytic", "polar-2", "--complexity", "400", "--cad", &text(&case.model_path)];
    let mesh = work.adapt(&case.mesh_path, &arguments).mesh;
    let at = |mesh: &TetMesh, v: u32| mesh.vertices[v as usize].map(|x| (1e9 * x).round());
    let expected = [a, b, c].map(|v| at(&case.mesh, v));
    let [kept] = mesh.required_triangles[..] else { panic!("{:?}", mesh.required_triangles) };
    let nodes = mesh.triangles.nodes[kept as usize];
    assert!(expected.iter().all(|p| nodes.iter().any(|&v| at(&mesh, v) == *p)));
    let [kept] = mesh.required_edges[..] else { panic!("{:?}", mesh.required_edges) };
    let edge = mesh.edges.nodes[kept as usize];
    assert!(expected[..2].iter().all(|p| edge.iter().any(|&v| at(&mesh, v) == *p)));
    assert_eq!(mesh.edges.refs[kept as usize], 77);
    assert!(!mesh.ridges.contains(&kept));
}

#[test]
fn a_mesh_in_millimetres_on_a_model_in_metres_is_told_so() {
    let mut case = cube_cylinder();
    let work = Workplace::new();
    case.mesh.vertices.iter_mut().for_each(|p| *p = p.map(|x| 1000.0 * x));
    let input = work.mesh(&case.mesh);
    let message = work.refusal(&input, &["--cad", &text(&case.model_path), "--analytic", "linear"]);
    for part in ["in.meshb", "cube-cylinder.step", "in millimetres, the model in metres", "multiply"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_model_that_is_none_is_named() {
    let case = cube_cylinder();
    let work = Workplace::new();
    let broken = work.path("broken.step");
    std::fs::write(&broken, "ISO-10303-21;\nthis is no model\n").unwrap();
    let message = work.refusal(&case.mesh_path, &["--cad", &text(&broken), "--analytic", "linear"]);
    assert!(message.contains("broken.step"), "{message}");
    let model = text(&case.model_path);
    let over = program()
        .arg("adapt")
        .arg(&case.mesh_path)
        .args(["-o", &text(&work.path("out.meshb")), "--analytic", "linear", "--cad", &model, "--report", &model])
        .output()
        .unwrap();
    assert!(over.status.code() == Some(2) && stderr(&over).contains("would be overwritten"), "{}", stderr(&over));
}
