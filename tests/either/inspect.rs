//! `geo-adapt inspect` tells a good mesh from a bad one, measures it, and ends with 0, 1 or 2.
use crate::common::{program, shared_case};
use geo_adapt::mesh::io::{FieldKind, Solution, SolutionField, write_mesh, write_solution};
use geo_adapt::mesh::{Elements, TetMesh};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

/// An octahedron as four tetrahedra around its axis: two sizes, so that the figures can be done by hand.
fn octahedron() -> TetMesh {
    let vertices =
        vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
    let (mut tets, mut triangles) = (Elements::default(), Elements::default());
    for i in 0..4 {
        let j = (i + 1) % 4;
        tets.push([i, j, 5, 4], 1);
        triangles.push([i, j, 5], 10);
        triangles.push([j, i, 4], 20);
    }
    for nodes in &mut tets.nodes {
        // The axis runs down: (i, j, top) sees the bottom from behind.
        nodes.swap(0, 1);
    }
    TetMesh { vertex_refs: vec![0; 6], vertices, tets, triangles, ..TetMesh::default() }
}

fn save(folder: &Path, mesh: &TetMesh) -> PathBuf {
    let path = folder.join("mesh.meshb");
    write_mesh(&path, mesh).unwrap();
    path
}

fn save_metric(folder: &Path, values: Vec<f64>) -> PathBuf {
    let path = folder.join("metric.solb");
    let field = SolutionField { kind: FieldKind::SymmetricTensor, values };
    write_solution(&path, &Solution { vertices: field.values.len() / 6, fields: vec![field] }).unwrap();
    path
}

fn inspect(mesh: &Path, arguments: &[&str]) -> Output {
    program().arg("inspect").arg(mesh).args(arguments).output().unwrap()
}

/// Runs with --json and checks the exit code.
fn inspect_json(mesh: &Path, arguments: &[&str], code: i32) -> Value {
    let output = inspect(mesh, &[arguments, &["--json"]].concat());
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Runs on bad input: code 2, and one message on stderr.
fn refusal(mesh: &Path, arguments: &[&str]) -> String {
    let output = inspect(mesh, arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

fn close(value: &Value, expected: f64) {
    let found = value.as_f64().unwrap();
    assert!((found - expected).abs() <= 1e-10 * expected.abs().max(1.0), "{found} {expected}");
}

#[test]
fn figures_in_space() {
    let folder = tempfile::tempdir().unwrap();
    let path = save(folder.path(), &octahedron());
    let found = inspect_json(&path, &[], 0);
    assert_eq!(found["valid"], true);
    assert_eq!(found["flaws"].as_array().unwrap().len(), 0);
    assert_eq!((&found["vertices"], &found["tets"], &found["triangles"]), (&6.into(), &4.into(), &8.into()));
    close(&found["volume"], 4.0 / 3.0);
    assert_eq!(found["patches"]["10"], 4);
    // Twelve sides of √2 and the axis of 2.
    let lengths = &found["edge_lengths"];
    assert_eq!(lengths["count"], 13);
    close(&lengths["min"], 2f64.sqrt());
    close(&lengths["mean"], (12.0 * 2f64.sqrt() + 2.0) / 13.0);
    // Volume 1/3, edges² 5·2 + 4.
    close(&found["mean_ratios"]["mean"], 36.0 / 3f64.cbrt() * (1.0f64 / 3.0).powf(2.0 / 3.0) / 14.0);
    assert!(found["metric"].is_null());
}

#[test]
fn figures_in_a_metric() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = save(folder.path(), &octahedron());
    // Size 1 across, 2 along the axis: the sides become √1.25 (to the poles) and √2, the axis 1.
    let metric = save_metric(folder.path(), [1.0, 0.0, 1.0, 0.0, 0.0, 0.25].repeat(6));
    let found = inspect_json(&mesh, &["--metric", metric.to_str().unwrap()], 0);
    let lengths = &found["edge_lengths"];
    close(&lengths["min"], 1.0);
    close(&lengths["max"], 2f64.sqrt());
    close(&lengths["mean"], (8.0 * 1.25f64.sqrt() + 4.0 * 2f64.sqrt() + 1.0) / 13.0);
    close(&found["metric"]["complexity"], 2.0 / 3.0);
    close(&found["metric"]["vertices_per_complexity"], 9.0);
    let classes: u64 = lengths["classes"].as_array().unwrap().iter().map(|c| c["count"].as_u64().unwrap()).sum();
    assert_eq!(classes, 13);
    // Volume 1/6, edges² 4·1.25 + 2 + 1.
    close(&found["mean_ratios"]["min"], 36.0 / 3f64.cbrt() * (1.0f64 / 6.0).powf(2.0 / 3.0) / 8.0);
    let text = String::from_utf8(inspect(&mesh, &["--metric", metric.to_str().unwrap()]).stdout).unwrap();
    for expected in ["validity                   valid", "complexity                 0.6667", "unit edges"] {
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn analytic_fields_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = save(folder.path(), &octahedron());
    for name in ["linear", "polar-1", "polar-2"] {
        let found = inspect_json(&mesh, &["--analytic", name], 0);
        assert!(found["metric"]["complexity"].as_f64().unwrap() > 0.0);
    }
    assert!(refusal(&mesh, &["--analytic", "polar-3"]).contains("polar-2"));
}

#[test]
fn invalid_meshes_end_with_1() {
    let folder = tempfile::tempdir().unwrap();
    let good = octahedron();
    let kind_of = |change: &dyn Fn(&mut TetMesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        let found = inspect_json(&save(folder.path(), &mesh), &[], 1);
        assert_eq!(found["valid"], false);
        found["flaws"].as_array().unwrap().iter().map(|f| f["kind"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert!(kind_of(&|mesh| mesh.tets.nodes[2].swap(1, 2)).contains(&"inverted-tet".into()));
    assert!(kind_of(&|mesh| mesh.vertices[0] = [0.0; 3]).contains(&"flat-tet".into()));
    let pop = |mesh: &mut TetMesh| {
        mesh.triangles.nodes.pop();
        mesh.triangles.refs.pop();
    };
    assert_eq!(kind_of(&pop), ["open-boundary"]);
    // What is wrong where counts from 1.
    let mut flat = good.clone();
    flat.tets.nodes[2].swap(1, 2);
    let found = inspect_json(&save(folder.path(), &flat), &[], 1);
    let first = &found["flaws"].as_array().unwrap().iter().find(|f| f["kind"] == "inverted-tet").unwrap()["first"][0];
    assert_eq!((&first["index"], first["nodes"].as_array().unwrap().len()), (&3.into(), 4));
    let nodes: Vec<u64> = flat.tets.nodes[2].iter().map(|&v| u64::from(v) + 1).collect();
    assert_eq!(first["nodes"], serde_json::json!(nodes));
    assert_eq!(found["worst_tet"]["index"], 3);
    assert_eq!(kind_of(&|mesh| mesh.triangles.push(mesh.triangles.nodes[0], 1)), ["duplicate-triangle"]);
    let hang = |mesh: &mut TetMesh| {
        mesh.vertices.push([5.0; 3]);
        mesh.vertex_refs.push(0);
    };
    assert_eq!(kind_of(&hang), ["unused-vertex"]);
    let mut mesh = good.clone();
    hang(&mut mesh);
    let text = String::from_utf8(inspect(&save(folder.path(), &mesh), &[]).stdout).unwrap();
    assert!(text.contains("INVALID") && text.contains("no. 7, nodes [7] at (5.000000"), "{text}");
}

#[test]
fn bad_input_ends_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let path = save(folder.path(), &octahedron());
    assert!(refusal(&folder.path().join("none.mesh"), &[]).contains("none.mesh"));
    let metric = save_metric(folder.path(), [1.0, 0.0, 1.0, 0.0, 0.0, 1.0].repeat(5));
    let metric = metric.to_str().unwrap();
    assert!(refusal(&path, &["--metric", metric]).contains("metric at 5 vertices, but the mesh has 6"));
    refusal(&path, &["--metric", metric, "--analytic", "linear"]);
    let mut values = [1.0, 0.0, 1.0, 0.0, 0.0, 1.0].repeat(6);
    values[6 * 3 + 2] = -4.0;
    save_metric(folder.path(), values);
    let message = refusal(&path, &["--metric", metric]);
    assert!(message.contains("metric of vertex 4 is not positive definite"), "{message}");
    let surface = TetMesh { tets: Elements::default(), ..octahedron() };
    assert!(refusal(&save(folder.path(), &surface), &[]).contains("no tetrahedra"));
}

#[test]
fn ugawg_meshes_are_valid() {
    let cases = [
        ("cube/cube-linear-00.meshb", "cube/cube-linear-00.solb"),
        ("onera-m6/onera_curvAdapt.meshb", "onera-m6/onera_curvAdapt-metric.solb"),
        ("hemisphere-cylinder/hsc-gmsh-26-adapt.meshb", "hemisphere-cylinder/hsc-gmsh-26-adapt-metric.solb"),
    ];
    for (mesh, metric) in cases {
        let (Some(mesh), Some(metric)) = (shared_case(mesh), shared_case(metric)) else { continue };
        let found = inspect_json(&mesh, &["--metric", metric.to_str().unwrap()], 0);
        let ratios = &found["mean_ratios"];
        assert!(ratios["min"].as_f64().unwrap() > 0.0 && ratios["max"].as_f64().unwrap() <= 1.0);
    }
}

#[cfg(feature = "occt")]
#[test]
fn on_the_model() {
    let step = "cube-cylinder/cube-cylinder.step";
    let (Some(mesh), Some(step)) = (shared_case("cube-cylinder/cube-cylinder.meshb"), shared_case(step)) else {
        return;
    };
    let step = step.to_str().unwrap();
    let found = inspect_json(&mesh, &["--cad", step], 0);
    let cad = &found["cad"];
    for key in ["from_model", "from_entity"] {
        assert!(cad[key]["distance"].as_f64().unwrap() < 1e-12, "{cad}");
    }
    // Chords of the cylinder, eight or so a quarter: between nothing and a right angle.
    let degrees = cad["worst_normal"]["degrees"].as_f64().unwrap();
    assert!(degrees > 0.9 && degrees < 8.0, "{degrees}");

    // Millimetres against metres: the mesh is good, but not on this model.
    let folder = tempfile::tempdir().unwrap();
    let mut scaled = geo_adapt::mesh::io::read_mesh(&mesh).unwrap().content;
    for x in scaled.vertices.iter_mut().flatten() {
        *x *= 1000.0;
    }
    let found = inspect_json(&save(folder.path(), &scaled), &["--cad", step], 1);
    assert_eq!(found["flaws"].as_array().unwrap().len(), 0);
    assert!(found["cad"]["error"].as_str().unwrap().contains("1000"), "{}", found["cad"]);
    assert!(refusal(&mesh, &["--cad", mesh.to_str().unwrap()]).contains("cube-cylinder.meshb"));
}

/// A mesh in pieces is the mesh: the same answer but for the rounding of sums, and the same exit code.
#[test]
fn within_some_memory_it_says_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let alike = |path: &Path, arguments: &[&str], code: i32| {
        let whole = inspect_json(path, arguments, code);
        let pieces = inspect_json(path, &[arguments, &["--memory", "300MB"]].concat(), code);
        assert_alike(&whole, &pieces);
        pieces
    };
    let mut mesh = octahedron();
    let path = save(folder.path(), &mesh);
    let metric = save_metric(folder.path(), [4.0, 0.0, 4.0, 0.0, 0.0, 16.0].repeat(6));
    let metric = metric.to_str().unwrap();
    for arguments in [&[][..], &["--metric", metric], &["--analytic", "linear"]] {
        assert_eq!(alike(&path, arguments, 0)["valid"], true);
    }
    mesh.tets.nodes[1].swap(0, 1);
    mesh.triangles.nodes.pop();
    mesh.triangles.refs.pop();
    let path = save(folder.path(), &mesh);
    let found = alike(&path, &["--metric", metric], 1);
    let kinds: Vec<&Value> = found["flaws"].as_array().unwrap().iter().map(|flaw| &flaw["kind"]).collect();
    assert_eq!(kinds, ["inverted-tet", "open-boundary", "folded-face"]);
    // What it cannot do it says.
    let text = folder.path().join("mesh.mesh");
    write_mesh(&text, &octahedron()).unwrap();
    assert!(refusal(&text, &["--memory", "300MB"]).contains("give .meshb or .solb"));
    let other = folder.path().join("mesh.su2");
    std::fs::write(&other, "NDIME= 3\n").unwrap();
    assert!(refusal(&other, &["--memory", "300MB"]).contains("with --memory only .meshb is read"));
    assert!(refusal(&path, &["--memory", "300MB", "--cad", "a.step"]).contains("cannot be used with"));
    assert!(refusal(&path, &["--memory", "20MB"]).contains("give --memory"));
    assert!(refusal(&path, &["--memory", "lots"]).contains("an amount like 4GiB"));
}

/// Equal, but for the last digits of numbers.
fn assert_alike(a: &Value, b: &Value) {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()));
            a.values().zip(b.values()).for_each(|(a, b)| assert_alike(a, b));
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len());
            a.iter().zip(b).for_each(|(a, b)| assert_alike(a, b));
        }
        (Value::Number(a), Value::Number(_)) if a.is_f64() => close(b, a.as_f64().unwrap()),
        _ => assert_eq!(a, b),
    }
}
