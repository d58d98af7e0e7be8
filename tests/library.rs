//! The adapter in memory: the same meshes as by the program, meshes that go in again, and an error for whatever is wrong with the slices.
#![cfg(feature = "cli")]
mod common;

use common::adapting::{Workplace, cube, isotropic, volumes};
use geo_adapt::api::{AdaptedMesh, Adapter, Error, MeshView, Settings};
use geo_adapt::geometry::Entity;
use geo_adapt::mesh::vector::{Vec3, add, distance, scale};
use geo_adapt::mesh::{TetMesh, io, validity};
use geo_adapt::metric::Sym3;
use nalgebra::{Matrix3, Point3};

fn settings() -> Settings {
    Settings { threads: 1, complexity: Some(300.0), ..Settings::default() }
}

/// Fine across x = at.
fn front(mesh: &TetMesh, at: f64) -> Vec<[f64; 6]> {
    let metric = |p: &Vec3| Sym3::diagonal((0.02 + 0.3 * (p[0] - at).abs()).powi(-2), 16.0, 16.0).0;
    mesh.vertices.iter().map(metric).collect()
}

fn adapt(adapter: &mut Adapter, view: &MeshView, metric: &[[f64; 6]]) -> AdaptedMesh {
    let adapted = adapter.adapt(view, metric).unwrap();
    assert!(validity::check(&adapted.mesh).is_valid());
    let vertices = adapted.mesh.vertices.len();
    assert!([adapted.metric.len(), adapted.parents.tets.len(), adapted.parents.weights.len()] == [vertices; 3]);
    assert!(adapted.metric.iter().all(|&terms| Sym3(terms).is_spd()));
    assert!(adapted.off_model.is_empty() && !adapted.overgrown);
    adapted
}

/// Each new vertex is where its parent says.
fn check_parents(old: &TetMesh, adapted: &AdaptedMesh) {
    let coordinates = adapted.parents.interpolate(&old.tets.nodes, 3, old.vertices.as_flattened());
    for ((p, at), (tet, weights)) in adapted
        .mesh
        .vertices
        .iter()
        .zip(coordinates.as_chunks::<3>().0)
        .zip(adapted.parents.tets.iter().zip(&adapted.parents.weights))
    {
        assert!(distance(*p, *at) <= adapted.parents.farthest + 1e-12);
        assert!(weights.iter().all(|&w| w >= 0.0) && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let nodes = old.tets.nodes[*tet as usize].map(|v| old.vertices[v as usize]);
        let sum = nodes.iter().zip(weights).fold([0.0; 3], |sum, (&x, &w)| add(sum, scale(x, w)));
        assert!(distance(sum, *at) < 1e-12);
    }
}

#[test]
fn three_calls_give_what_three_runs_of_the_program_give() {
    let work = Workplace::new();
    let mut input = cube(4, |p| if p[2] < 0.5 { 1 } else { 2 });
    let mut adapter = Adapter::discrete(settings()).unwrap();
    for at in [0.3, 0.5, 0.7] {
        let metric = front(&input, at);
        let path = work.mesh(&input);
        let size = work.path("size.solb");
        io::write_solution(&size, &io::Solution::metric(&metric)).unwrap();
        let expected = work.adapt(&path, &["--metric", size.to_str().unwrap(), "--complexity", "300"]);
        let found = adapt(&mut adapter, &MeshView::of(&input), &metric);
        check_parents(&input, &found);
        assert_eq!(found.mesh, expected.mesh);
        assert!(found.metric.iter().zip(&expected.metrics).all(|(a, b)| *a == b.0));
        input = found.mesh;
    }
}

#[test]
fn a_mesh_goes_in_again_with_its_place() {
    let input = cube(4, |p| if p[2] < 0.5 { 1 } else { 2 });
    let mut adapter = Adapter::discrete(settings()).unwrap();
    let mut adapted = adapt(&mut adapter, &MeshView::of(&input), &front(&input, 0.2));
    for at in [0.5, 0.8] {
        let metric = front(&adapted.mesh, at);
        let next = adapt(&mut adapter, &adapted.view(), &metric);
        check_parents(&adapted.mesh, &next);
        assert_eq!(next.parents.outside, 0);
        // Another adapter that knows nothing finds as good a mesh.
        let anew = adapt(&mut Adapter::discrete(settings()).unwrap(), &MeshView::of(&adapted.mesh), &metric);
        let [a, b] = [&next, &anew].map(|found| found.mesh.vertices.len() as f64);
        assert!((a / b - 1.0).abs() < 0.05, "{a} {b}");
        for (region, volume) in volumes(&next.mesh) {
            assert!((volume - 0.5).abs() < 1e-12, "{region} {volume}");
        }
        // The corners of the cube and those of the face between the regions; and the references of the sides.
        assert_eq!(next.place.entities.iter().filter(|entity| matches!(entity, Entity::Vertex(_))).count(), 8 + 4);
        let refs: std::collections::BTreeSet<i32> = next.mesh.triangles.refs.iter().copied().collect();
        assert_eq!(refs, (1..=7).collect());
        adapted = next;
    }
}

#[test]
fn slices_alone_are_enough() {
    let input = cube(3, |_| 1);
    let metric = vec![isotropic(0.2).0; input.vertices.len()];
    let bare = MeshView { vertices: &input.vertices, tets: &input.tets.nodes, ..MeshView::default() };
    let settings = Settings { threads: 2, ..Settings::default() };
    let adapted = adapt(&mut Adapter::discrete(settings.clone()).unwrap(), &bare, &metric);
    assert!(adapted.mesh.tets.refs.iter().all(|&region| region == 1));
    let again = adapt(&mut Adapter::discrete(Settings { threads: 1, ..settings }).unwrap(), &bare, &metric);
    assert!(again.mesh == adapted.mesh && again.metric == adapted.metric && again.parents == adapted.parents);
}

#[test]
fn tensors_of_nalgebra_give_the_same_mesh_and_a_report_measures_it() {
    let input = cube(3, |_| 1);
    let metric = front(&input, 0.4);
    let mut adapter = Adapter::discrete(settings()).unwrap();
    let expected = adapt(&mut adapter, &MeshView::of(&input), &metric);
    let points: Vec<Point3<f64>> = input.vertices.iter().map(|&p| p.into()).collect();
    let matrices: Vec<Matrix3<f64>> = metric.iter().map(|&terms| Sym3(terms).into()).collect();
    let view = MeshView { vertices: geo_adapt::coordinates(&points), ..MeshView::of(&input) };
    let found = adapter.adapt(&view, &matrices).unwrap();
    assert!(found.mesh == expected.mesh && found.metric == expected.metric);

    let report = adapter.report(&found).unwrap();
    assert_eq!(
        (report.statistics.vertices, report.statistics.tets),
        (found.mesh.vertices.len(), found.mesh.tets.len())
    );
    assert!((report.statistics.volume - 1.0).abs() < 1e-12 && report.statistics.mean_ratios.min > 0.1);
    assert!(report.fidelity.from_model.unwrap().distance < 1e-12);
    // Of a mesh on another surface there is none.
    let other =
        adapt(&mut Adapter::discrete(settings()).unwrap(), &MeshView::of(&cube(2, |_| 1)), &vec![isotropic(0.4).0; 27]);
    let torn = AdaptedMesh { mesh: other.mesh, ..found };
    assert!(matches!(adapter.report(&torn), Err(Error::Length { .. })));
    assert!(matches!(Adapter::discrete(settings()).unwrap().report(&torn), Err(Error::Place { .. })));
}

#[test]
fn bad_slices_are_errors() {
    let input = cube(2, |_| 1);
    let good = MeshView::of(&input);
    let metric = vec![isotropic(0.4).0; input.vertices.len()];
    let mut adapter = Adapter::discrete(settings()).unwrap();
    let mut refused = |view: MeshView, metric: &[[f64; 6]]| adapter.adapt(&view, metric).expect_err("an error");

    assert!(matches!(refused(good, &metric[1..]), Error::Length { what: "metrics", found: 26, expected: 27 }));
    for bad in [[1.0, 2.0, 1.0, 0.0, 0.0, 1.0], [f64::NAN, 0.0, 1.0, 0.0, 0.0, 1.0], [0.0; 6], [f64::INFINITY; 6]] {
        let mut metric = metric.clone();
        metric[7] = bad;
        assert!(matches!(refused(good, &metric), Error::Metric { vertex: 7 }), "{bad:?}");
    }
    let out = |error: Error, expected: &str, at: usize| match error {
        Error::OutOfRange { what, element, .. } => assert_eq!((what, element), (expected, at)),
        error => panic!("{error}"),
    };
    let mut tets = input.tets.nodes.clone();
    tets[5][2] = 27;
    out(refused(MeshView { tets: &tets, ..good }, &metric), "tetrahedron", 5);
    let triangles = [[0, 1, u32::MAX]];
    out(refused(MeshView { triangles: &triangles, triangle_refs: &[], ..good }, &metric), "triangle", 0);
    out(refused(MeshView { edges: &[[0, 99]], edge_refs: &[], ..good }, &metric), "edge", 0);
    out(refused(MeshView { required_triangles: &[0, 48], ..good }, &metric), "required triangle", 1);
    out(refused(MeshView { required_edges: &[0], edges: &[], edge_refs: &[], ..good }, &metric), "required edge", 0);
    out(refused(MeshView { corners: &[27], ..good }, &metric), "corner", 0);
    let error = refused(MeshView { tet_refs: &[1, 2], ..good }, &metric);
    assert!(matches!(error, Error::Length { what: "references of tetrahedra", found: 2, .. }), "{error}");

    let mut vertices = input.vertices.clone();
    vertices[3][1] = f64::NAN;
    assert!(matches!(refused(MeshView { vertices: &vertices, ..good }, &metric), Error::NotFinite { vertex: 3 }));
    assert!(matches!(refused(MeshView { tets: &[], tet_refs: &[], ..good }, &metric), Error::Mesh(_)));
    assert!(matches!(refused(MeshView::default(), &[]), Error::Mesh(_)));
    let mut tets = input.tets.nodes.clone();
    tets[0].swap(0, 1);
    assert!(matches!(refused(MeshView { tets: &tets, ..good }, &metric), Error::Mesh(_)));
    tets = vec![[0, 1, 2, 3], [0, 1, 2, 3], [0, 1, 2, 3]];
    assert!(matches!(refused(MeshView { tets: &tets, tet_refs: &[], ..good }, &metric), Error::Mesh(_)));
    tets = vec![[4, 4, 4, 4]];
    assert!(matches!(
        refused(MeshView { tets: &tets, tet_refs: &[], triangles: &[], triangle_refs: &[], ..good }, &metric),
        Error::Mesh(_)
    ));

    // What no mesh can have, and the adapter is none the worse for all that.
    for complexity in [0.0, -1.0, f64::NAN, 1e12] {
        adapter.settings().complexity = Some(complexity);
        assert!(matches!(adapter.adapt(&good, &metric), Err(Error::Complexity { .. })), "{complexity}");
    }
    adapter.settings().complexity = None;
    let tiny = vec![isotropic(1e-5).0; input.vertices.len()];
    assert!(matches!(adapter.adapt(&good, &tiny), Err(Error::Complexity { .. })));
    assert!(adapter.adapt(&good, &metric).is_ok());
}

#[test]
fn a_place_of_another_mesh_is_an_error() {
    let (input, other) = (cube(2, |_| 1), cube(3, |_| 1));
    let metric = |mesh: &TetMesh| vec![isotropic(0.4).0; mesh.vertices.len()];
    let mut adapter = Adapter::discrete(Settings { complexity: None, ..settings() }).unwrap();
    let adapted = adapt(&mut Adapter::discrete(settings()).unwrap(), &MeshView::of(&other), &metric(&other));
    // Nothing came before.
    assert!(matches!(adapter.adapt(&adapted.view(), &adapted.metric), Err(Error::Place { .. })));
    let mine = adapt(&mut adapter, &MeshView::of(&input), &metric(&input));
    let wrong = MeshView { place: Some(&adapted.place), ..mine.view() };
    assert!(matches!(adapter.adapt(&wrong, &mine.metric), Err(Error::Length { .. })));
    let mut place = mine.place.clone();
    let at = place.entities.iter().position(|entity| matches!(entity, Entity::Face(_))).unwrap();
    place.entities[at] = Entity::Face(1000);
    let error = adapter.adapt(&MeshView { place: Some(&place), ..mine.view() }, &mine.metric).err().unwrap();
    assert!(matches!(error, Error::OutOfRange { what: "the entity of vertex", .. }), "{error}");
    place = mine.place.clone();
    place.parameters[at] = [f64::NAN; 2];
    assert!(matches!(
        adapter.adapt(&MeshView { place: Some(&place), ..mine.view() }, &mine.metric),
        Err(Error::Place { .. })
    ));
    let bare = MeshView { triangles: &[], triangle_refs: &[], required_triangles: &[], ..mine.view() };
    assert!(matches!(adapter.adapt(&bare, &mine.metric), Err(Error::Place { .. })));
    assert!(adapter.adapt(&mine.view(), &mine.metric).is_ok());
}

#[cfg(feature = "occt")]
mod on_cad {
    use super::*;
    use std::path::{Path, PathBuf};

    fn data(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
    }

    #[test]
    fn the_model_is_read_once_and_the_place_goes_in_again() {
        let cad = data("geometry/cube-cylinder.step");
        let input = io::read_mesh(&data("cases/cube-cylinder/start.meshb")).unwrap().content;
        let metric = |mesh: &TetMesh| front(mesh, 0.5);
        let work = Workplace::new();
        let (path, size) = (work.mesh(&input), work.path("size.solb"));
        io::write_solution(&size, &io::Solution::metric(&metric(&input))).unwrap();
        let options = ["--cad", cad.to_str().unwrap(), "--metric", size.to_str().unwrap(), "--complexity", "300"];
        let expected = work.adapt(&path, &options);
        let mut adapter = Adapter::on_cad(&cad, settings()).unwrap();
        let mut adapted = adapt(&mut adapter, &MeshView::of(&input), &metric(&input));
        assert_eq!(adapted.mesh, expected.mesh);
        for _ in 0..2 {
            let next = adapt(&mut adapter, &adapted.view(), &metric(&adapted.mesh));
            check_parents(&adapted.mesh, &next);
            let corners = |adapted: &AdaptedMesh| adapted.mesh.association.vertices.len();
            assert_eq!(corners(&next), corners(&adapted));
            adapted = next;
        }
    }

    #[test]
    fn a_bad_model_is_an_error() {
        let work = Workplace::new();
        let path = work.path("bad.step");
        assert!(matches!(Adapter::on_cad(&path, settings()), Err(Error::Model(_))));
        std::fs::write(&path, "no model").unwrap();
        assert!(matches!(Adapter::on_cad(&path, settings()), Err(Error::Model(_))));
        assert!(matches!(Adapter::on_cad(Path::new("model.txt"), settings()), Err(Error::Model(_))));
    }
}
