//! Meshes that hang together in edges or vertices alone are taken apart there, and each side comes out right.

use crate::common::adapting::{Workplace, areas, complaint, cube, isotropic, stderr, text};
use crate::common::shared_case;
use geo_adapt::api::{Adapter, MeshView, Settings};
use geo_adapt::mesh::vector::{Vec3, volume6};
use geo_adapt::mesh::{Elements, TetMesh, io, validity};
use geo_adapt::metric::Sym3;
use std::collections::BTreeMap;
use std::path::Path;

/// The cells of a cube of n³ that are meant, with the triangles of their boundary: the reference is that of the plane.
fn cells(n: u32, is_meant: impl Fn([u32; 3]) -> bool) -> TetMesh {
    let all = cube(n, |p| i32::from(is_meant(p.map(|x| (f64::from(n) * x) as u32))));
    let mut mesh = TetMesh { vertices: all.vertices, ..TetMesh::default() };
    all.tets.iter().filter(|tet| tet.1 == 1).for_each(|(nodes, _)| mesh.tets.push(nodes, 1));
    let mut used = vec![u32::MAX; mesh.vertices.len()];
    mesh.tets.nodes.iter().flatten().for_each(|&v| used[v as usize] = 0);
    let kept: Vec<u32> = (0..used.len() as u32).filter(|&v| used[v as usize] == 0).collect();
    kept.iter().zip(0..).for_each(|(&v, new)| used[v as usize] = new);
    mesh.vertices = kept.iter().map(|&v| mesh.vertices[v as usize]).collect();
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    mesh.tets.nodes.iter_mut().flatten().for_each(|v| *v = used[*v as usize]);
    let mut planes: BTreeMap<(usize, u64), i32> = BTreeMap::new();
    let mut triangles = Elements::default();
    for (_, (nodes, regions)) in crate::common::adapting::faces(&mesh) {
        if regions.len() == 1 {
            let corners = nodes.map(|v| mesh.vertices[v as usize]);
            let axis = (0..3).find(|&k| corners.iter().all(|p| p[k] == corners[0][k])).unwrap();
            let next = planes.len() as i32 + 1;
            triangles.push(nodes, *planes.entry((axis, corners[0][axis].to_bits())).or_insert(next));
        }
    }
    mesh.triangles = triangles;
    mesh
}

fn volume(mesh: &TetMesh) -> f64 {
    let of = |nodes: &[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        volume6(a, b, c, d) / 6.0
    };
    mesh.tets.nodes.iter().map(of).sum()
}

/// The same domain in a valid mesh: volume, areas of all planes, and no vertex beside them.
fn check(work: &Workplace, input: &TetMesh) -> TetMesh {
    let mesh = io::read_mesh(&work.path("out.meshb")).unwrap().content;
    assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(work.path("report.json")).unwrap()).unwrap();
    assert!((volume(&mesh) - volume(input)).abs() < 1e-12, "{}", volume(&mesh));
    let [areas, expected] = [areas(&mesh), areas(input)];
    assert_eq!(areas.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (reference, area) in areas {
        assert!((area - expected[&reference]).abs() < 1e-12, "face {reference}: {area} for {}", expected[&reference]);
    }
    assert_eq!(report["fidelity"]["from_entity"]["distance"].as_f64().map(|d| d < 1e-12), Some(true));
    assert_eq!(report["off_model"], serde_json::json!([]));
    mesh
}

/// Adapts on one thread; what it noted.
fn adapt(work: &Workplace, path: &Path, arguments: &[&str]) -> String {
    let report = text(&work.path("report.json"));
    let run = work.command(path, &[arguments, &["--threads", "1", "--report", &report]].concat()).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    stderr(&run)
}

/// Stretched by so much along a slanted direction.
fn stretched(size: f64, ratio: f64) -> impl Fn(Vec3) -> Sym3 {
    let direction = [0.6, 0.0, 0.8];
    let (wide, narrow) = (1.0 / (size * size), ratio * ratio / (size * size));
    move |_| Sym3::diagonal(wide, wide, wide).plus(Sym3::outer(direction, narrow - wide))
}

#[test]
fn bodies_that_touch_in_edges_or_vertices_alone_come_out_right() {
    // Four columns of a chess board that share edges; two cells at one vertex; both, with an edge that ends at a vertex inside the solid.
    let column = |[x, y, _]: [u32; 3]| x == y;
    let corner = |[x, y, z]: [u32; 3]| x == y && y == z;
    let ends = |[x, y, z]: [u32; 3]| z == 0 || x == y;
    let shapes: [&dyn Fn([u32; 3]) -> bool; 3] = [&column, &corner, &ends];
    for (number, shape) in shapes.into_iter().enumerate() {
        let input = cells(3, shape);
        for metric in [
            Box::new(|_| isotropic(0.11)) as Box<dyn Fn(Vec3) -> Sym3>,
            Box::new(|_| isotropic(0.8)),
            Box::new(stretched(0.5, 20.0)),
        ] {
            let work = Workplace::new();
            let metric = work.metric(&input, metric);
            let notes = adapt(&work, &work.mesh(&input), &["--metric", &metric]);
            assert!(notes.contains("hangs together in edges or vertices alone"), "{number}: {notes}");
            check(&work, &input);
        }
    }
}

#[test]
fn boxes_that_touch_along_an_edge_come_out_right() {
    let Some(path) = shared_case("hard/touch-edge.meshb") else { return };
    let input = io::read_mesh(&path).unwrap().content;
    for metric in ["hard/touch-edge-fine.solb", "hard/touch-edge-aniso1e6.solb"] {
        let Some(metric) = shared_case(metric) else { return };
        let work = Workplace::new();
        adapt(&work, &path, &["--metric", metric.to_str().unwrap()]);
        let mesh = check(&work, &input);
        // All of the input's edges were listed, with one reference: so are those of either side.
        assert!(mesh.edges.refs.iter().all(|&reference| reference == 50));
    }
}

#[test]
fn a_field_on_a_mesh_that_is_taken_apart_has_its_values_on_both_sides() {
    let work = Workplace::new();
    let input = cells(4, |[x, y, z]| (x < 2) == (y < 2) && (y < 2) == (z < 2));
    let path = work.mesh(&input);
    let field = work.path("field.solb");
    let values: Vec<f64> = input.vertices.iter().map(|p| (4.0 * (p[0] - 0.4)).tanh() + p[1] * p[1]).collect();
    io::write_solution(
        &field,
        &io::Solution {
            vertices: values.len(),
            fields: vec![io::SolutionField { kind: io::FieldKind::Scalar, values }],
        },
    )
    .unwrap();
    adapt(&work, &path, &["--field", field.to_str().unwrap(), "--complexity", "100"]);
    check(&work, &input);
}

#[test]
fn an_edge_of_two_voids_that_nothing_takes_apart_is_refused() {
    let work = Workplace::new();
    // The voids share one edge of the mesh, about whose ends all else hangs together.
    let input = cells(4, |cell| cell != [1, 1, 1] && cell != [2, 2, 1]);
    let metric = work.metric(&input, |_| isotropic(0.2));
    let message = complaint(&work.command(&work.mesh(&input), &["--metric", &metric]).output().unwrap());
    assert!(message.contains("the boundary touches itself along the edge of nodes"), "{message}");
}

#[test]
fn in_memory_too_a_mesh_is_taken_apart_and_its_doubled_vertices_are_told() {
    let input = cells(2, |[x, y, z]| x == y && y == z);
    let metric = vec![isotropic(0.3); input.vertices.len()];
    let mut adapter = Adapter::discrete(Settings { threads: 1, ..Settings::default() }).unwrap();
    let adapted = adapter.adapt(&MeshView::of(&input), &metric).unwrap();
    assert_eq!(adapted.doubled.iter().map(|&v| input.vertices[v as usize]).collect::<Vec<_>>(), [[0.5; 3]]);
    assert!((volume(&adapted.mesh) - 0.25).abs() < 1e-12 && validity::check(&adapted.mesh).is_valid());
    let again = adapter.adapt(&adapted.view(), &adapted.metric).unwrap();
    assert!(again.doubled.is_empty());
}
