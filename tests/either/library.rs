//! The adapter in memory: the same meshes as by the program, meshes that go in again, and an error for whatever is wrong with the slices.

use crate::common::adapting::{Workplace, cube, isotropic, volumes};
use crate::common::models::Random;
use geo_adapt::api::{AdaptedMesh, Adapter, Error, MeshView, Settings};
use geo_adapt::geometry::Entity;
use geo_adapt::geometry::classify::Classification;
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
    assert!(adapted.off_model.is_empty() && adapted.growth_end.is_none());
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

/// A mesh that came out of an adapter, and the adapter: a ball of two regions in a cube.
fn with_place() -> (Adapter, AdaptedMesh) {
    let mut adapter = Adapter::discrete(Settings { complexity: Some(40.0), ..settings() }).unwrap();
    let input = cube(2, |p| if p[2] < 0.5 { 1 } else { 2 });
    let adapted = adapt(&mut adapter, &MeshView::of(&input), &front(&input, 0.5));
    (adapter, adapted)
}

#[test]
fn a_vertex_on_a_model_edge_with_three_ridges_is_an_error() {
    let (mut adapter, mine) = with_place();
    let mut place = mine.place.clone();
    let at = place.entities.iter().position(|entity| matches!(entity, Entity::Edge(_))).unwrap() as u32;
    let Entity::Edge(edge) = place.entities[at as usize] else { unreachable!() };
    let corner = place.entities.iter().position(|entity| matches!(entity, Entity::Vertex(_))).unwrap() as u32;
    place.ridges.push(([at, corner], edge));
    let error = adapter.adapt(&MeshView { place: Some(&place), ..mine.view() }, &mine.metric).err().unwrap();
    assert!(matches!(error, Error::Place { .. }), "{error}");
    assert!(
        error.to_string().contains(&format!("vertex {at} lies on edge {edge}, and has more than two ridges")),
        "{error}"
    );
}

#[test]
fn whatever_is_wrong_with_a_place_is_told_and_what() {
    let (mut adapter, mine) = with_place();
    let entities = &mine.place.entities;
    let first = |is: fn(&Entity) -> bool| entities.iter().position(is).unwrap();
    let on_face = first(|entity| matches!(entity, Entity::Face(_)));
    let on_edge = first(|entity| matches!(entity, Entity::Edge(_)));
    let inside = first(|entity| *entity == Entity::Interior);
    let Entity::Face(face) = entities[on_face] else { unreachable!() };
    let corners: Vec<usize> = (0..entities.len()).filter(|&v| matches!(entities[v], Entity::Vertex(_))).collect();
    let ridge = mine.place.ridges[0];
    type Change<'a> = &'a dyn Fn(&mut Classification);
    let changes: [(Change, &str); 10] = [
        (&|place| place.entities[on_face] = Entity::Interior, "lies inside, and is in triangle"),
        (&|place| place.entities[on_face] = Entity::Face(u32::from(face == 0)), "and is in triangle"),
        (&|place| place.entities[on_face] = Entity::Edge(0), "has no ridge"),
        (&|place| place.entities[inside] = Entity::Face(0), "is in no triangle of the surface"),
        (&|place| place.entities[on_edge] = Entity::Face(face), ""),
        (&|place| place.entities[corners[0]] = place.entities[corners[1]], "both lie on vertex"),
        (&|place| place.ridges.push((ridge.0, ridge.1)), ""),
        (&|place| place.ridges.push(([corners[0] as u32, corners[0] as u32], 0)), "is no edge of the surface"),
        (&|place| place.ridges.retain(|other| *other != ridge), "where there is no ridge"),
        (&|place| place.faces[0] = u32::from(place.faces[0] == 0), ""),
    ];
    for (number, (change, expected)) in changes.into_iter().enumerate() {
        let mut place = mine.place.clone();
        change(&mut place);
        let error = adapter.adapt(&MeshView { place: Some(&place), ..mine.view() }, &mine.metric).err();
        let Some(Error::Place { message }) = &error else { panic!("{number}: {error:?}") };
        assert!(message.contains(expected), "{number}: {message}");
    }
    assert!(adapter.adapt(&mine.view(), &mine.metric).is_ok());
}

/// How often something is damaged at random: 30 times, or as GEO_ADAPT_MUTATIONS says.
fn mutations() -> usize {
    std::env::var("GEO_ADAPT_MUTATIONS").ok().and_then(|text| text.parse().ok()).unwrap_or(30)
}

fn below(random: &mut Random, n: usize) -> usize {
    ((random.next() * n as f64) as usize).min(n.saturating_sub(1))
}

/// A number that is likely to be in range, at its end, or far beyond.
fn index(random: &mut Random, n: usize) -> u32 {
    match below(random, 8) {
        0 => n as u32,
        1 => u32::MAX,
        _ => below(random, n) as u32,
    }
}

fn coordinate(random: &mut Random) -> f64 {
    [0.0, 0.5, 1.0, -1.0, 1e-17, 3.0, f64::INFINITY, f64::NAN][below(random, 8)]
}

#[test]
fn no_place_makes_the_adapter_panic() {
    let (mut adapter, mine) = with_place();
    let mut random = Random(7);
    let mut taken = 0;
    for _ in 0..mutations() {
        let mut place = mine.place.clone();
        let entities = place.entities.len();
        for _ in 0..=below(&mut random, 3) {
            let v = below(&mut random, entities);
            let ridge = below(&mut random, place.ridges.len());
            match below(&mut random, 10) {
                0 => place.entities[v] = Entity::Vertex(index(&mut random, 12)),
                1 => place.entities[v] = Entity::Edge(index(&mut random, 20)),
                2 => place.entities[v] = Entity::Face(index(&mut random, 7)),
                3 => place.entities[v] = Entity::Interior,
                4 => place.ridges[ridge].1 = index(&mut random, 20),
                5 => place.ridges[ridge].0[below(&mut random, 2)] = index(&mut random, entities),
                6 => {
                    place.ridges.remove(ridge);
                }
                7 => {
                    let triangle = below(&mut random, place.faces.len());
                    place.faces[triangle] = index(&mut random, 7);
                }
                8 => place.projected[v][below(&mut random, 3)] = coordinate(&mut random),
                _ => place.parameters[v][below(&mut random, 2)] = coordinate(&mut random),
            }
        }
        if let Ok(adapted) = adapter.adapt(&MeshView { place: Some(&place), ..mine.view() }, &mine.metric) {
            assert!(validity::check(&adapted.mesh).is_valid());
            taken += 1;
        }
    }
    assert!(taken > 0, "other parameters and points on the model do no harm");
}

#[test]
fn no_mesh_makes_the_adapter_panic() {
    let input = cube(2, |p| if p[2] < 0.5 { 1 } else { 2 });
    let mut random = Random(11);
    for _ in 0..mutations() {
        let mut mesh = input.clone();
        mesh.edges.push([0, 1], 1);
        let mut metric: Vec<[f64; 6]> = front(&mesh, 0.5);
        let n = mesh.vertices.len();
        for _ in 0..=below(&mut random, 4) {
            let at = below(&mut random, n);
            let (tet, triangle) =
                (below(&mut random, mesh.tets.len()), below(&mut random, mesh.triangles.len().max(1)));
            match below(&mut random, 15) {
                0 => mesh.vertices[at][below(&mut random, 3)] = coordinate(&mut random),
                1 => mesh.tets.nodes[tet][below(&mut random, 4)] = index(&mut random, n),
                2 => drop((mesh.tets.nodes.remove(tet), mesh.tets.refs.remove(tet))),
                3 => mesh.tets.push(mesh.tets.nodes[tet], i32::MIN),
                4 => mesh.triangles.push([0; 3].map(|_| index(&mut random, n)), i32::MAX),
                5 => drop((mesh.triangles.nodes.remove(triangle), mesh.triangles.refs.remove(triangle))),
                6 => mesh.triangles.push(mesh.triangles.nodes[triangle], -3),
                7 => mesh.edges.push([0; 2].map(|_| index(&mut random, n)), 9),
                8 => mesh.corners.push(index(&mut random, n)),
                9 => mesh.required_vertices.push(index(&mut random, n)),
                10 => mesh.required_edges.push(index(&mut random, mesh.edges.len())),
                11 => mesh.required_triangles.push(index(&mut random, mesh.triangles.len())),
                12 => mesh.vertices.push([coordinate(&mut random); 3]),
                13 => mesh.tets.refs[tet] = coordinate(&mut random) as i32,
                _ => metric[at.min(26)][below(&mut random, 6)] *= coordinate(&mut random),
            }
        }
        mesh.vertex_refs.resize(mesh.vertices.len(), 0);
        metric.resize(mesh.vertices.len(), isotropic(0.5).0);
        let mut adapter = Adapter::discrete(Settings { complexity: Some(40.0), ..settings() }).unwrap();
        if let Ok(adapted) = adapter.adapt(&MeshView::of(&mesh), &metric) {
            // What is in range was taken: if it was a mesh, it is one still.
            assert!(!validity::check(&mesh).is_valid() || validity::check(&adapted.mesh).is_valid());
        }
    }
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
