//! Tests of the discrete geometry on meshes built here.
use super::samples::{cube, sphere};
use super::{DEFAULT_RIDGE_ANGLE, Discrete, DiscreteOptions, complete_boundary, outward_triangles};
use crate::geometry::classify::Classification;
use crate::geometry::{Entity, Evaluate, Geometry};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, area2, distance, dot, norm, sub, unit};
use crate::tasks::Team;

fn discrete(mesh: &TetMesh) -> (Discrete, Classification) {
    Discrete::from_mesh(Team::alone(), mesh, DEFAULT_RIDGE_ANGLE).unwrap()
}

fn flat(mesh: &TetMesh) -> (Discrete, Classification) {
    Discrete::new(Team::alone(), mesh, &DiscreteOptions { smooth: false, ..DiscreteOptions::default() }).unwrap()
}

fn count(classification: &Classification, dimension: u32) -> usize {
    classification.entities.iter().filter(|e| e.dimension() == dimension).count()
}

#[test]
fn a_cube_has_its_corners_edges_and_faces_with_normals_outward() {
    let mut mesh = cube(4);
    assert_eq!(complete_boundary(Team::alone(), &mut mesh), 6 * 4 * 4 * 2);
    assert_eq!(complete_boundary(Team::alone(), &mut mesh), 0, "a second time there is nothing to add");
    // Triangles may be listed either way round.
    mesh.triangles.nodes.iter_mut().step_by(3).for_each(|nodes| nodes.swap(0, 1));
    let (model, classification) = discrete(&mesh);
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [8, 12, 6]);
    assert!(topology.vertices.iter().all(|v| v.edges.len() == 3));
    assert!(topology.edges.iter().all(|e| e.faces.len() == 2 && (e.range[1] - 1.0).abs() < 1e-12));
    assert_eq!([0, 1, 2, 3].map(|d| count(&classification, d)), [8, 12 * 3, 6 * 9, 27]);
    assert_eq!(classification.ridges.len(), 48);
    let mut evaluator = model.evaluator();
    for face in 0..6 {
        assert!(model.is_plane(face));
        let [low, high] = topology.faces[face as usize].bounds;
        let middle: Vec3 = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        let outward = unit(sub(middle, [0.5; 3]));
        assert!(distance(evaluator.face_normal(face, [0.3, 0.1]), outward) < 1e-14);
        let beyond = std::array::from_fn(|i| middle[i] + 0.3 * outward[i]);
        let on = evaluator.closest_on_face(face, beyond, None);
        assert!((on.distance - 0.3).abs() < 1e-14 && distance(on.point, middle) < 1e-14);
        assert!(distance(evaluator.face_frame(face, on.uv).point, on.point) < 1e-14);
        let out_of_face = evaluator.closest_on_face(face, [3.0, 3.0, 3.0], Some([0.0; 2]));
        assert!((0..3).all(|i| out_of_face.point[i] <= high[i] + 1e-14), "{:?}", out_of_face.point);
    }
}

#[test]
fn parameters_give_back_the_points_of_the_classification() {
    for mesh in [sphere(6), {
        let mut mesh = cube(3);
        complete_boundary(Team::alone(), &mut mesh);
        mesh
    }] {
        let (model, classification) = discrete(&mesh);
        let mut evaluator = model.evaluator();
        for (v, entity) in classification.entities.iter().enumerate() {
            let [u, w] = classification.parameters[v];
            let point = match *entity {
                Entity::Edge(edge) => evaluator.edge_frame(edge, u).point,
                Entity::Face(face) => evaluator.face_frame(face, [u, w]).point,
                Entity::Vertex(vertex) => model.topology().vertices[vertex as usize].point,
                Entity::Interior => continue,
            };
            assert!(distance(point, mesh.vertices[v]) < 1e-12, "{v} {entity:?}");
        }
        for (edge, entity) in model.topology().edges.iter().enumerate() {
            for &face in &entity.faces {
                let t = 0.37 * entity.range[1];
                let uv = evaluator.edge_on_face(edge as u32, t, face).unwrap();
                let (on_edge, on_face) = (evaluator.edge_frame(edge as u32, t), evaluator.face_frame(face, uv));
                assert!(distance(on_edge.point, on_face.point) < 1e-12);
            }
            assert!(evaluator.edge_on_face(edge as u32, 0.0, u32::MAX).is_none());
        }
    }
}

#[test]
fn a_sphere_of_flat_triangles_is_one_face_and_has_its_curvature() {
    let mut mesh = sphere(16);
    mesh.triangles.refs.fill(1);
    let (model, classification) = flat(&mesh);
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [0, 0, 1]);
    assert!(classification.ridges.is_empty());
    let mut evaluator = model.evaluator();
    let (mut sum, mut samples) = (0.0, 0);
    for nodes in &mesh.triangles.nodes {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        let centroid: Vec3 = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        let on = evaluator.closest_on_face(0, centroid, Some([7.2, 0.4]));
        assert!(on.distance < 1e-12);
        let frame = evaluator.face_frame(0, on.uv);
        let normal = unit(area2(a, b, c));
        assert!(1.0 - dot(frame.normal, normal).abs() < 1e-12, "no normal deviation at the input's centroids");
        assert!(dot(frame.directions[0], frame.directions[1]).abs() < 1e-12);
        sum += frame.curvatures[0].abs() + frame.curvatures[1].abs();
        samples += 2;
    }
    let mean = sum / f64::from(samples);
    assert!((mean - 0.5).abs() < 0.03, "mean curvature {mean} of a sphere of radius 2");
}

#[test]
fn closest_points_are_closest_whatever_the_guess() {
    let mesh = sphere(8);
    let (model, classification) = flat(&mesh);
    let mut evaluator = model.evaluator();
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    for _ in 0..60 {
        let p: Vec3 = std::array::from_fn(|_| 6.0 * random() - 3.0);
        let guess = [128.0 * random(), random()];
        let face = (6.0 * random()) as u32 % model.topology().faces.len() as u32;
        let on = evaluator.closest_on_face(face, p, Some(guess));
        let mut least = f64::INFINITY;
        for k in 0..mesh.triangles.len() {
            if classification.faces[k] == face {
                let corners = mesh.triangles.nodes[k].map(|v| mesh.vertices[v as usize]);
                least = least.min(brute_distance(corners, p));
            }
        }
        assert!(on.distance <= least + 1e-9, "{} {least}", on.distance);
        assert!((norm(sub(on.point, p)) - on.distance).abs() < 1e-12);
    }
}

/// Distance to a triangle by a fine scan of its points: an upper bound.
fn brute_distance([a, b, c]: [Vec3; 3], p: Vec3) -> f64 {
    let n = 12;
    let mut least = f64::INFINITY;
    for i in 0..=n {
        for j in 0..=n - i {
            let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let q = std::array::from_fn(|x| a[x] + s * (b[x] - a[x]) + t * (c[x] - a[x]));
            least = least.min(distance(p, q));
        }
    }
    least
}

#[test]
fn a_disc_keeps_its_rim_as_a_closed_edge() {
    let mut mesh = TetMesh::default();
    mesh.vertices.push([0.0; 3]);
    let n = 24;
    for i in 0..n {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        mesh.vertices.push([3.0 * angle.cos(), 3.0 * angle.sin(), 0.0]);
        mesh.triangles.push([0, 1 + i, 1 + (i + 1) % n], 4);
    }
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    let (model, classification) = discrete(&mesh);
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [0, 1, 1]);
    let rim = &topology.edges[0];
    assert_eq!(rim.vertices, [None, None]);
    assert_eq!(rim.period, Some(rim.range[1]));
    assert_eq!(classification.ridges.len(), n as usize);
    let mut evaluator = model.evaluator();
    let frame = evaluator.edge_frame(0, 0.0);
    assert!((frame.curvature() - 1.0 / 3.0).abs() < 0.01, "{}", frame.curvature());
    let past = evaluator.edge_frame(0, rim.range[1] + 0.1);
    assert!(distance(past.point, evaluator.edge_frame(0, 0.1).point) < 1e-12);
    // A corner listed on the rim opens it there, and one listed inside stands alone.
    mesh.corners = vec![5, 0];
    let (model, classification) = discrete(&mesh);
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [2, 1, 1]);
    assert_eq!(topology.edges[0].vertices, [Some(1), Some(1)]);
    assert_eq!(topology.edges[0].period, None);
    assert_eq!(classification.entities[0], Entity::Vertex(0));
    assert!(topology.vertices[0].edges.is_empty());
}

#[test]
fn regions_get_an_interface_that_belongs_to_both() {
    let mut mesh = cube(4);
    let high = |tet: &[u32; 4], mesh: &TetMesh| tet.iter().any(|&v| mesh.vertices[v as usize][2] > 0.5 + 1e-9);
    mesh.tets.refs = mesh.tets.nodes.iter().map(|tet| if high(tet, &mesh) { 2 } else { 1 }).collect();
    assert_eq!(complete_boundary(Team::alone(), &mut mesh), 6 * 32 + 32);
    let mut refs = mesh.triangles.refs.clone();
    refs.sort_unstable();
    refs.dedup();
    assert_eq!(refs, [1, 2, 3], "the interface and the boundary of each region");
    let (model, _) = discrete(&mesh);
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [12, 20, 11]);
    assert_eq!(topology.edges.iter().filter(|e| e.faces.len() == 3).count(), 4);
    let interface = (0..11).find(|&f| {
        let bounds = topology.faces[f].bounds;
        bounds[0][2] == 0.5 && bounds[1][2] == 0.5
    });
    let normal = model.evaluator().face_normal(interface.unwrap() as u32, [0.0; 2]);
    assert!(normal[2] > 0.99, "out of the region with the smaller reference: {normal:?}");
}

#[test]
fn outward_triangles_do_not_depend_on_the_order_of_a_tetrahedron() {
    let mut mesh = cube(2);
    complete_boundary(Team::alone(), &mut mesh);
    let expected = mesh.triangles.nodes.clone();
    mesh.triangles.nodes.iter_mut().step_by(2).for_each(|nodes| nodes.swap(1, 2));
    mesh.tets.nodes.iter_mut().step_by(2).for_each(|nodes| nodes.swap(1, 2));
    assert_eq!(outward_triangles(Team::alone(), &mesh), expected);
}

#[test]
fn a_mesh_without_triangles_is_an_error() {
    let error = Discrete::from_mesh(Team::alone(), &cube(1), DEFAULT_RIDGE_ANGLE).err().unwrap();
    assert!(error.to_string().contains("no boundary triangles"), "{error}");
}

#[test]
fn features_come_back_with_their_references() {
    let mut mesh = cube(2);
    complete_boundary(Team::alone(), &mut mesh);
    let at = |mesh: &TetMesh, p: Vec3| mesh.vertices.iter().position(|&q| q == p).unwrap() as u32;
    let (a, b, c) = (at(&mesh, [0.0; 3]), at(&mesh, [0.5, 0.0, 0.0]), at(&mesh, [1.0, 0.0, 0.0]));
    for (t, nodes) in mesh.triangles.nodes.iter().enumerate() {
        let low = nodes.iter().all(|&v| mesh.vertices[v as usize][2] == 0.0);
        mesh.triangles.refs[t] = if low { 12 } else { 5 };
    }
    // The upper half of the edge along x is listed with another reference than the lower one.
    mesh.edges = crate::mesh::Elements { nodes: vec![[a, b], [c, b]], refs: vec![8, 9] };
    let (model, classification) = discrete(&mesh);
    assert_eq!(model.topology().vertices.len(), 9, "the reference changes at the ninth");
    let mut copy = mesh.clone();
    copy.triangles.refs.fill(0);
    model.restore(&mut copy, &classification);
    assert_eq!(copy.triangles, mesh.triangles);
    assert_eq!((copy.edges.len(), copy.corners.len()), (24, 9));
    let mut refs = copy.edges.refs.clone();
    refs.sort_unstable();
    assert_eq!(refs[21..], [0, 8, 9]);
}
