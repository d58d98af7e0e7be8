//! Tests of the classification on discrete models; those on CAD models are in tests/cad/classify.rs.
use super::{Classification, Error, Options, Report, associate, classify};
use crate::geometry::discrete::samples::{cube, sphere};
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, complete_boundary};
use crate::geometry::{Discrete, Entity, Geometry, Model};
use crate::mesh::vector::{distance, lerp};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::Team;

/// A cube of n³ cells with its boundary.
fn closed_cube(n: u32) -> TetMesh {
    let mut mesh = cube(n);
    complete_boundary(Team::alone(), &mut mesh);
    mesh
}

/// The unit cube as a model: twelve edges, six faces, exact.
fn cube_model() -> Model {
    Model::Discrete(Discrete::from_mesh(Team::alone(), &closed_cube(2), DEFAULT_RIDGE_ANGLE).unwrap().0)
}

fn fit(mesh: &TetMesh, model: &Model) -> Result<(Classification, Report), Error> {
    classify(Team::alone(), mesh, model, &Options::default())
}

fn counts(result: &Classification) -> [usize; 4] {
    [0, 1, 2, 3].map(|d| result.entities.iter().filter(|e| e.dimension() == d).count())
}

#[test]
fn a_cube_without_any_reference_is_classified_by_geometry() {
    let (mesh, model) = (closed_cube(5), cube_model());
    let (result, report) = fit(&mesh, &model).unwrap();
    assert_eq!(counts(&result), [8, 12 * 4, 6 * 16, 64]);
    assert_eq!(result.ridges.len(), 60);
    assert_eq!(report.dimensions.map(|d| d.count), [8, 48, 96]);
    assert!(report.dimensions.iter().all(|d| d.greatest < 1e-14), "{report:?}");
    for (v, &point) in result.projected.iter().enumerate() {
        assert!(distance(point, mesh.vertices[v]) < 1e-14);
    }
    for &(nodes, edge) in &result.ridges {
        let faces = &model.topology().edges[edge as usize].faces;
        let beside = |t: &usize| nodes.iter().all(|v| mesh.triangles.nodes[*t].contains(v));
        for t in (0..mesh.triangles.len()).filter(beside) {
            assert!(faces.contains(&result.faces[t]));
        }
    }
}

#[test]
fn faces_that_no_ridge_separates_are_told_apart_triangle_by_triangle() {
    // With a limit of 100 degrees the whole cube is one patch.
    let options = Options { ridge_angle_deg: 100.0, ..Options::default() };
    let (mesh, model) = (closed_cube(4), cube_model());
    let (result, _) = classify(Team::alone(), &mesh, &model, &options).unwrap();
    let (expected, _) = fit(&mesh, &model).unwrap();
    assert_eq!(result.faces, expected.faces);
    assert_eq!(result.entities, expected.entities);
}

#[test]
fn an_association_comes_back_and_is_recognised() {
    let (mut mesh, model) = (closed_cube(3), cube_model());
    mesh.edges.push([0, 21], 9); // inside the volume or across: no edge of the model
    let (result, _) = fit(&mesh, &model).unwrap();
    let done = associate(&mut mesh, &result);
    assert!(done.references_replaced, "one reference stood for six faces");
    assert_eq!(done.edges_dropped, 1);
    assert_eq!(mesh.corners.len(), 8);
    assert_eq!((mesh.edges.len(), mesh.ridges.len()), (36, 36));
    let association = &mesh.association;
    assert_eq!([association.vertices.len(), association.edges.len(), association.faces.len()], [8, 24, 24]);
    let (again, report) = fit(&mesh, &model).unwrap();
    assert_eq!(again.entities, result.entities);
    assert!(report.dimensions.iter().all(|d| d.from_file == d.count));
    assert!(report.notices.is_empty(), "{:?}", report.notices);
    assert_eq!(report.faces_from_file, mesh.triangles.len());
    assert!(!associate(&mut mesh, &again).references_replaced);
}

#[test]
fn references_with_another_numbering_are_kept_but_not_believed() {
    let (mut mesh, model) = (closed_cube(3), cube_model());
    let (result, _) = fit(&mesh, &model).unwrap();
    associate(&mut mesh, &result);
    mesh.triangles.refs.iter_mut().for_each(|r| *r = 1 + *r % 6);
    mesh.association.faces.iter_mut().for_each(|on| on.id = 1 + on.id % 6);
    mesh.association.edges[0].id = 999;
    let refs = mesh.triangles.refs.clone();
    let (again, report) = fit(&mesh, &model).unwrap();
    assert_eq!((&again.faces, &again.entities), (&result.faces, &result.entities));
    assert_eq!(report.dimensions.map(|d| d.from_file), [8, 23, 0]);
    let notices = report.notices.join("\n");
    for part in ["are not the numbers of their faces", "does not hold for 24 of 55", "1 entries"] {
        assert!(notices.contains(part), "{part:?} in {notices}");
    }
    assert!(!associate(&mut mesh, &again).references_replaced, "each still stands for one face");
    assert_eq!(mesh.triangles.refs, refs);
}

#[test]
fn required_edges_stay_required() {
    let (mut mesh, model) = (closed_cube(2), cube_model());
    mesh.edges = Elements { nodes: vec![[1, 0], [1, 2]], refs: vec![4, 4] };
    mesh.required_edges = vec![1];
    let (result, _) = fit(&mesh, &model).unwrap();
    associate(&mut mesh, &result);
    let required: Vec<[u32; 2]> = mesh.required_edges.iter().map(|&e| mesh.edges.nodes[e as usize]).collect();
    assert!(required == [[1, 2]] || required == [[2, 1]], "{required:?}");
}

#[test]
fn a_vertex_off_its_face_edge_or_corner_is_named() {
    let model = cube_model();
    let find = |at: [f64; 3]| {
        let mesh = closed_cube(4);
        mesh.vertices.iter().position(|&p| distance(p, at) < 1e-12).unwrap()
    };
    for (at, to) in [
        ([0.5, 0.5, 1.0], [0.5, 0.5, 1.01]),
        ([0.5, 0.5, 1.0], [0.5, 0.5, 1.00001]),
        ([0.5, 0.0, 1.0], [0.5, 0.02, 1.0]),
        ([0.5, 0.0, 1.0], [0.5, 4e-6, 1.0]),
        ([0.0, 0.0, 1.0], [0.0, 0.0, 1.1]),
        ([0.0, 0.0, 1.0], [0.01, 0.0, 1.0]),
    ] {
        let v = find(at);
        let mut mesh = closed_cube(4);
        mesh.vertices[v] = to;
        let text = fit(&mesh, &model).unwrap_err().to_string();
        assert!(text.contains(&format!("{}", v + 1)), "vertex {} at {to:?}: {text}", v + 1);
        assert!(
            text.contains("tolerance") || text.contains("lie on several") || text.contains("no single face"),
            "{text}"
        );
        let far = Options { tolerance: Some(0.15), ..Options::default() };
        if at != [0.0, 0.0, 1.0] {
            let (result, report) = classify(Team::alone(), &mesh, &model, &far).unwrap();
            assert_eq!(report.worst[0].vertex, v as u32);
            assert!((report.worst[0].distance - distance(at, to)).abs() < 1e-12);
            assert!(distance(result.projected[v], at) < 1e-12);
        }
    }
}

#[test]
fn another_unit_is_told_by_its_factor() {
    let model = cube_model();
    for (factor, part) in [
        (1000.0, "1000 times as large as the model (diagonals 1732.050808 and 1.732051): the mesh is in millimetres"),
        (0.001, "0.001 times as large"),
        (25.4, "25.4 times as large"),
        (1.0 / 25.4, "multiply the mesh's coordinates by 25.4,"),
        (7.0, "7 times as large"),
    ] {
        let mut mesh = closed_cube(2);
        mesh.vertices.iter_mut().for_each(|p| *p = p.map(|x| factor * x));
        let error = fit(&mesh, &model).unwrap_err();
        assert!(matches!(error, Error::Units { .. }), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn a_patch_beside_the_model_is_named() {
    let mut mesh = closed_cube(2);
    mesh.triangles.refs.fill(77);
    mesh.vertices.iter_mut().for_each(|p| p[0] += 0.25);
    let error = fit(&mesh, &cube_model()).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, Error::PatchWithoutFace { reference: 77, .. }), "{text}");
    assert!(text.contains("2.5") && text.contains("e-1"), "{text}");
}

#[test]
fn a_model_that_is_not_covered_is_an_error() {
    let model = cube_model();
    let mut mesh = closed_cube(2);
    let (result, _) = fit(&mesh, &model).unwrap();
    // Leave out one face: the others' borders are still on the model's edges.
    let keep: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| result.faces[t] != 2).collect();
    mesh.triangles = Elements {
        nodes: keep.iter().map(|&t| mesh.triangles.nodes[t]).collect(),
        refs: keep.iter().map(|&t| mesh.triangles.refs[t]).collect(),
    };
    let error = fit(&mesh, &model).unwrap_err();
    assert!(matches!(error, Error::FaceNotCovered { face: 2, .. }), "{error}");
    assert!(matches!(fit(&TetMesh::default(), &model).unwrap_err(), Error::NoTriangles));
}

#[test]
fn a_mesh_that_cuts_a_corner_is_an_error() {
    let model = cube_model();
    let mut mesh = closed_cube(3);
    let v = mesh.vertices.iter().position(|&p| p == [0.0, 0.0, 0.0]).unwrap();
    mesh.vertices[v] = [0.1, 0.0, 0.0];
    let error = fit(&mesh, &model).unwrap_err();
    assert!(matches!(error, Error::NoMeshVertex { .. } | Error::VertexOff { .. } | Error::Straddles { .. }), "{error}");
}

#[test]
fn a_closed_surface_without_ridges_lies_on_one_face() {
    let mut mesh = sphere(6);
    mesh.triangles.refs.fill(0);
    let model = Model::Discrete(Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).unwrap().0);
    let (result, report) = fit(&mesh, &model).unwrap();
    assert!(result.ridges.is_empty() && result.faces.iter().all(|&f| f == 0));
    let on_surface = result.entities.iter().filter(|e| **e == Entity::Face(0)).count();
    assert_eq!(report.dimensions.map(|d| d.count), [0, 0, on_surface]);
}

/// A box with a ball cut out of it: a seam and two poles, of which nothing may be asked of the mesh.
#[cfg(feature = "occt")]
#[test]
fn a_sphere_has_no_ridge_along_its_seam_and_no_corner_at_its_poles() {
    use crate::geometry::SurfaceKind;
    use crate::mesh::vector::{add, scale};
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/sphere-in-box.step");
    if !path.is_file() {
        eprintln!("skipped: {} is not there", path.display());
        return;
    }
    let model = Model::read(&path).unwrap();
    let topology = model.topology();
    let ball = topology.faces.iter().position(|face| face.kind == SurfaceKind::Sphere).unwrap();
    let [low, high] = topology.faces[ball].bounds;
    let (centre, radius) = (scale(add(low, high), 0.5), 0.5 * (high[2] - low[2]));
    let mut mesh = closed_cube(3);
    mesh.tets = Elements::default();
    let [low, high] = topology.bounds;
    let place = |p: [f64; 3]| std::array::from_fn(|i| low[i] + p[i] * (high[i] - low[i]));
    mesh.vertices.iter_mut().for_each(|p| *p = place(*p));
    let inner = sphere(6);
    let base = mesh.vertices.len() as u32;
    mesh.vertices.extend(inner.vertices.iter().map(|&p| add(centre, scale(p, 0.5 * radius))));
    mesh.triangles.nodes.extend(inner.triangles.nodes.iter().map(|nodes| nodes.map(|v| v + base)));
    mesh.triangles.refs.extend(&inner.triangles.refs);
    // Boxes are found within a gap, so the radius is only that good.
    let options = Options { tolerance: Some(1e-4), ..Options::default() };
    let (result, _) = classify(Team::alone(), &mesh, &model, &options).unwrap();
    assert_eq!(result.ridges.len(), 36, "the box's edges alone");
    assert_eq!(counts(&result)[..2], [8, 24]);
    for &v in inner.triangles.nodes.iter().flatten() {
        assert_eq!(result.entities[(base + v) as usize], Entity::Face(ball as u32));
    }
}

/// A wire within a side that bends by less than a corner does: its ends are joined by an edge of the mesh too.
#[test]
fn a_chord_over_a_bend_is_no_piece_of_a_wire() {
    let mut mesh = closed_cube(3);
    let is_inside = |p: [f64; 3]| p[2] == 0.0 && (0..2).all(|i| p[i] > 0.1 && p[i] < 0.9);
    let inside = |nodes: &[u32; 3]| nodes.iter().all(|&v| is_inside(mesh.vertices[v as usize]));
    let nodes = *mesh.triangles.nodes.iter().find(|nodes| inside(nodes)).unwrap();
    // The corner across from the longest side goes towards that side.
    let length = |k: usize| distance(mesh.vertices[nodes[k] as usize], mesh.vertices[nodes[(k + 1) % 3] as usize]);
    let long = (0..3).find(|&k| length(k) > 0.4).unwrap();
    let [a, c, b] = [long, (long + 1) % 3, (long + 2) % 3].map(|k| nodes[k]);
    let [pa, pb, pc] = [a, b, c].map(|v| mesh.vertices[v as usize]);
    mesh.vertices[b as usize] = lerp(pb, lerp(pa, pc, 0.5), 0.8);
    let mut with_wire = mesh.clone();
    [[a, b], [b, c]].iter().for_each(|side| with_wire.edges.push(*side, 9));
    let (model, on) = Discrete::from_mesh(Team::alone(), &with_wire, DEFAULT_RIDGE_ANGLE).unwrap();
    assert_eq!((model.topology().edges.len(), model.topology().faces.len()), (13, 6));
    let (result, _) = fit(&mesh, &Model::Discrete(model)).unwrap();
    assert_eq!(result.entities, on.entities);
    let wire = |place: &Classification| {
        let mut nodes: Vec<[u32; 2]> = place.ridges.iter().map(|(nodes, _)| *nodes).collect();
        nodes.iter_mut().for_each(|nodes| nodes.sort_unstable());
        nodes.sort_unstable();
        nodes
    };
    assert_eq!(wire(&result), wire(&on));
    let chord = if a < c { [a, c] } else { [c, a] };
    assert!(!wire(&result).contains(&chord));
}
