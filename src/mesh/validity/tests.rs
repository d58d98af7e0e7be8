//! Each kind of flaw is found.
use super::super::adjacency::FACES;
use super::super::samples::{cube, with_boundary};
use super::*;

fn kinds(mesh: &TetMesh) -> Vec<FlawKind> {
    check(mesh).flaws.iter().map(|flaw| flaw.kind).collect()
}

#[test]
fn a_good_mesh_has_no_flaw() {
    assert_eq!(check(&cube(3)), Validity::default());
}

#[test]
fn inverted_and_flat_tets() {
    let mut mesh = cube(2);
    mesh.tets.nodes[5].swap(0, 1);
    let validity = check(&mesh);
    assert_eq!(validity.count(FlawKind::InvertedTet), 1);
    assert_eq!(validity.flaws[0].first[0].index, Some(5));
    // A vertex inside, moved into the plane of a face of one of its tets.
    let mut mesh = cube(2);
    let inner = mesh.vertices.iter().position(|&p| p == [0.5; 3]).unwrap();
    mesh.vertices[inner] = [0.5, 0.5, 0.0];
    assert!(check(&mesh).count(FlawKind::FlatTet) > 0);
}

#[test]
fn holes_in_the_boundary() {
    let mut mesh = cube(2);
    mesh.triangles.nodes.pop();
    mesh.triangles.refs.pop();
    assert_eq!(kinds(&mesh), [FlawKind::OpenBoundary]);
    // A missing tet inside leaves four faces, or fewer on the boundary with as many loose triangles.
    let mut mesh = cube(3);
    mesh.tets.nodes.remove(40);
    mesh.tets.refs.remove(40);
    let validity = check(&mesh);
    assert_eq!(validity.count(FlawKind::OpenBoundary) + validity.count(FlawKind::LooseTriangle), 4);
}

#[test]
fn things_that_are_there_twice() {
    let mut mesh = cube(2);
    let [a, b, c] = mesh.triangles.nodes[7];
    mesh.triangles.push([c, a, b], 1);
    assert_eq!(kinds(&mesh), [FlawKind::DuplicateTriangle]);
    let mut mesh = cube(2);
    mesh.tets.push(mesh.tets.nodes[3], 1);
    let kinds = kinds(&mesh);
    assert!(kinds.contains(&FlawKind::DuplicateTet) && kinds.contains(&FlawKind::NonManifoldFace), "{kinds:?}");
}

#[test]
fn loose_things() {
    let mut mesh = cube(2);
    mesh.vertices.push([0.3; 3]);
    mesh.triangles.push([0, 13, 26], 1);
    mesh.edges.push([0, 25], 1);
    let expected = [FlawKind::LooseTriangle, FlawKind::LooseEdge, FlawKind::UnusedVertex];
    assert_eq!(kinds(&mesh), expected);
    let text = check(&mesh).flaws[2].to_string();
    assert_eq!(text, "1 unused vertices (of no tetrahedron): no. 28, nodes [28] at (0.300000, 0.300000, 0.300000)");
}

/// Two tetrahedra that share the nodes given.
fn two_tets(second: [u32; 4]) -> TetMesh {
    let vertices = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0],
    ];
    with_boundary(vertices, vec![[0, 1, 2, 3], second])
}

#[test]
fn tets_that_touch_in_a_point_or_an_edge() {
    assert_eq!(kinds(&two_tets([6, 0, 4, 5])), [FlawKind::NonManifoldVertex]);
    let mut mesh = two_tets([0, 1, 4, 5]);
    mesh.vertices[6] = [0.0, 0.0, -2.0];
    let found = check(&mesh);
    assert_eq!(found.count(FlawKind::NonManifoldEdge), 1);
    assert_eq!(found.count(FlawKind::NonManifoldVertex), 2);
    // Bodies may touch along a tagged edge.
    mesh.edges.push([1, 0], 1);
    assert_eq!(check(&mesh).count(FlawKind::NonManifoldEdge), 0);
}

/// Bodies that overlap, though each is well: the tip of one is in the other.
#[test]
fn bodies_that_cross() {
    let beside = |x: f64| {
        let cube = cube(1);
        let mut vertices = cube.vertices.clone();
        let tip = vertices.len() as u32;
        vertices.extend([[x, 0.4, 0.5], [2.0, 0.3, 0.3], [2.0, 0.6, 0.3], [2.0, 0.4, 0.8]]);
        let mut tets = cube.tets.nodes.clone();
        tets.push([tip, tip + 1, tip + 2, tip + 3]);
        with_boundary(vertices, tets)
    };
    assert_eq!(kinds(&beside(1.5)), []);
    assert_eq!(kinds(&beside(0.9)), [FlawKind::CrossingTriangles]);
    let found = check(&beside(0.9));
    // The tip's three sides, and the two halves of the cube's.
    let flaw = &found.flaws[0];
    assert!((3..=6).contains(&flaw.count), "{flaw}");
    for offender in &flaw.first {
        assert!((offender.at[0] - 1.0).abs() < 1e-6, "{offender:?}");
        let corner = beside(0.9).triangles.nodes[offender.other.unwrap()];
        assert_eq!(sorted3(corner), sorted3([offender.nodes[3], offender.nodes[4], offender.nodes[5]]));
    }
    assert!(flaw.to_string().contains("pairs of boundary triangles that cross: no. "), "{flaw}");
    assert_eq!(kinds(&beside(1.0)), [], "a tip on the side");
}

#[test]
fn tets_on_the_same_side_of_a_face() {
    let mut mesh = two_tets([0, 1, 2, 4]);
    mesh.vertices[4] = [0.2, 0.2, 0.5];
    assert!(kinds(&mesh).contains(&FlawKind::FoldedFace));
    mesh.tets.nodes[1] = [0, 1, 2, 2];
    assert!(kinds(&mesh).contains(&FlawKind::RepeatedNodes));
}

#[test]
fn an_interior_surface_is_legal() {
    let mut mesh = cube(2);
    let tet = mesh.tets.nodes[17];
    for face in FACES {
        let nodes = face.map(|i| tet[i]);
        if !mesh.triangles.nodes.iter().any(|&t| sorted3(t) == sorted3(nodes)) {
            mesh.triangles.push(nodes, 9);
        }
    }
    assert_eq!(check(&mesh), Validity::default());
}
