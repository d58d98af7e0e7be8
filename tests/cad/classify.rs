//! `geo-adapt classify`: a mesh finds its place on the CAD model, or the user learns where it does not.

use crate::common::{program, shared_case};
use geo_adapt::geometry::classify::{Classification, Error, Options, Report, classify};
use geo_adapt::geometry::{Entity, Evaluate, Geometry, Model};
use geo_adapt::mesh::vector::distance;
use geo_adapt::mesh::{Association, Elements, TetMesh, io};
use geo_adapt::tasks::Team;
use std::path::{Path, PathBuf};

/// Meshes with their models: entities of the model (vertices that corners stand on, edges that ridges cover, faces).
const CASES: [(&str, &str, [usize; 3]); 6] = [
    ("cube-cylinder/cube-cylinder.meshb", "cube-cylinder/cube-cylinder.step", [10, 15, 7]),
    ("cube-cylinder/cube-cylinder.meshb", "cube-cylinder/cube-cylinder.egads", [10, 15, 7]),
    ("hemisphere-cylinder/hsc01.meshb", "hemisphere-cylinder/hemisph-cyl.stp", [7, 10, 5]),
    ("hemisphere-cylinder/hsc-gmsh-26-adapt.meshb", "hemisphere-cylinder/hemisph-cyl.egads", [7, 10, 5]),
    ("onera-m6/onera_curvAdapt.meshb", "onera-m6/onera-m6-sharp-te.stp", [14, 23, 12]),
    ("onera-m6/onera_curvAdapt.meshb", "onera-m6/onera-m6-sharp-te.egads", [14, 23, 12]),
];

struct Case {
    mesh_path: PathBuf,
    model_path: PathBuf,
    mesh: TetMesh,
    model: Model,
    counts: [usize; 3],
}

fn case(number: usize) -> Option<Case> {
    let (mesh, model, counts) = CASES[number];
    let (mesh_path, model_path) = (shared_case(mesh)?, shared_case(model)?);
    let mesh = io::read_mesh(&mesh_path).unwrap().content;
    let model = Model::read(&model_path).unwrap();
    Some(Case { mesh_path, model_path, mesh, model, counts })
}

fn fit(mesh: &TetMesh, model: &Model) -> Result<(Classification, Report), Error> {
    classify(Team::alone(), mesh, model, &Options::default())
}

/// The mesh without anything that names entities.
fn anonymous(mesh: &TetMesh) -> TetMesh {
    let mut mesh = mesh.clone();
    mesh.triangles.refs.fill(0);
    mesh.edges = Elements::default();
    mesh.association = Association::default();
    (mesh.corners, mesh.ridges, mesh.required_edges) = Default::default();
    mesh
}

/// Every promise of a classification, checked against the model anew.
fn check(case: &Case, mesh: &TetMesh, result: &Classification) {
    let topology = case.model.topology();
    let mut seen = [vec![], vec![], result.faces.clone()];
    let (mut evaluator, gaps) = (case.model.evaluator(), case.model.closed_gaps());
    for (v, &entity) in result.entities.iter().enumerate() {
        let [first, second] = result.parameters[v];
        let point = match entity {
            Entity::Interior => continue,
            Entity::Vertex(i) => {
                seen[0].push(i);
                topology.vertices[i as usize].point
            }
            Entity::Edge(i) => evaluator.edge_frame(i, first).point,
            Entity::Face(i) => evaluator.face_frame(i, [first, second]).point,
        };
        let scale = 1e-9 * topology.diagonal();
        // A mesh that was made before lies on edges where the file has them.
        let moved = gaps.iter().filter(|gap| entity == Entity::Edge(gap.edge)).map(|gap| gap.before + gap.after);
        let allowed = scale + moved.fold(0.0, f64::max);
        assert!(distance(point, mesh.vertices[v]) < allowed, "vertex {} {entity:?}", v + 1);
        assert!(distance(point, result.projected[v]) < 1e-3 * scale, "vertex {} {entity:?}", v + 1);
    }
    for &(nodes, edge) in &result.ridges {
        seen[1].push(edge);
        let entity = &topology.edges[edge as usize];
        for node in nodes {
            match result.entities[node as usize] {
                Entity::Vertex(i) => assert!(entity.vertices.contains(&Some(i))),
                other => assert_eq!(other, Entity::Edge(edge)),
            }
        }
    }
    assert_eq!(seen[0].len(), case.counts[0], "one mesh vertex on each vertex");
    let distinct = seen.map(|mut list| {
        list.sort_unstable();
        list.dedup();
        list.len()
    });
    assert_eq!(distinct, case.counts);
}

#[test]
fn shared_meshes_are_put_on_their_models() {
    for case in (0..CASES.len()).filter_map(case) {
        let (result, report) = fit(&case.mesh, &case.model).unwrap();
        check(&case, &case.mesh, &result);
        assert_eq!(report.faces_from_file, case.mesh.triangles.len());
        assert!(result.faces.iter().zip(&case.mesh.triangles.refs).all(|(&f, &r)| f as i32 + 1 == r));
    }
}

#[test]
fn shared_meshes_without_references_are_classified_alike() {
    for case in (0..CASES.len()).filter_map(case) {
        let (expected, _) = fit(&case.mesh, &case.model).unwrap();
        let mesh = anonymous(&case.mesh);
        let (result, report) = fit(&mesh, &case.model).unwrap();
        check(&case, &mesh, &result);
        assert_eq!(result.entities, expected.entities);
        assert_eq!(result.faces, expected.faces);
        assert_eq!(report.dimensions.map(|d| d.from_file), [0; 3]);
        assert!(report.notices.is_empty(), "{:?}", report.notices);
    }
}

#[test]
fn references_that_lie_are_found_out() {
    for case in (0..CASES.len()).filter_map(case) {
        let (expected, _) = fit(&case.mesh, &case.model).unwrap();
        let mut mesh = case.mesh.clone();
        let faces = case.counts[2] as i32;
        mesh.triangles.refs.iter_mut().for_each(|r| *r = faces + 1 - *r);
        let (result, report) = fit(&mesh, &case.model).unwrap();
        assert_eq!((result.entities, result.faces), (expected.entities, expected.faces));
        assert!(report.notices.iter().any(|n| n.contains("not the numbers of their faces")), "{:?}", report.notices);
    }
}

/// Runs the program on a changed mesh and gives what it said on stderr; it must have failed with code 2.
fn complaint(case: &Case, mesh: &TetMesh) -> String {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.meshb"), folder.path().join("out.meshb"));
    io::write_mesh(&input, mesh).unwrap();
    let run = program()
        .arg("classify")
        .arg(&input)
        .arg("--cad")
        .arg(&case.model_path)
        .arg("-x")
        .arg(&output)
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(2));
    assert!(!output.exists());
    let text = String::from_utf8(run.stderr).unwrap();
    assert!(text.contains("geo-adapt: error: ") && text.contains("in.meshb"), "{text}");
    text
}

#[test]
fn a_vertex_off_the_model_is_named_with_its_distance() {
    let Some(case) = case(0) else { return };
    let (result, report) = fit(&case.mesh, &case.model).unwrap();
    let allowed = report.tolerance;
    let position = |wanted: fn(&Entity) -> bool| result.entities.iter().position(wanted).unwrap();
    // Outward of the cylinder, of face 5's vertex: by far, and by little more than allowed.
    for (wanted, step) in [
        ((|e: &Entity| *e == Entity::Face(4)) as fn(&Entity) -> bool, 0.01),
        (|e| *e == Entity::Face(4), 4.0 * allowed),
        (|e| e.dimension() == 1, 30.0 * allowed),
        (|e| e.dimension() == 0, 3.0 * allowed),
    ] {
        let v = position(wanted);
        let mut mesh = case.mesh.clone();
        mesh.vertices[v] = mesh.vertices[v].map(|x| x + step);
        let text = complaint(&case, &mesh);
        assert!(text.contains("tolerance") && text.contains(&(v + 1).to_string()), "vertex {}: {text}", v + 1);
    }
}

#[test]
fn a_mesh_in_other_units_is_told_so() {
    let Some(case) = case(0) else { return };
    for (factor, part) in [(1000.0, "in millimetres, the model in metres"), (0.0254, "in inches")] {
        let mut mesh = case.mesh.clone();
        mesh.vertices.iter_mut().for_each(|p| *p = p.map(|x| factor * x));
        if factor < 0.1 {
            mesh.vertices.iter_mut().for_each(|p| *p = p.map(|x| x / 0.0254 / 25.4));
        }
        let text = complaint(&case, &mesh);
        assert!(text.contains(part) && text.contains("multiply the mesh's coordinates by"), "{text}");
    }
}

#[test]
fn a_mesh_of_another_model_names_the_patch() {
    let (Some(case), Some(other)) = (case(0), case(2)) else { return };
    let text = complaint(&other, &case.mesh);
    assert!(text.contains("times as large as the model") || text.contains("lies on no face"), "{text}");
    let mut moved = case.mesh.clone();
    moved.vertices.iter_mut().for_each(|p| p[2] += 0.5);
    let text = complaint(&case, &moved);
    assert!(text.contains("with reference") && text.contains("lies on no face of the model"), "{text}");
}

#[test]
fn the_program_writes_the_association_and_prints_the_distances() {
    let Some(case) = case(0) else { return };
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.meshb");
    let anonymous_path = folder.path().join("anonymous.meshb");
    io::write_mesh(&anonymous_path, &anonymous(&case.mesh)).unwrap();
    for input in [&case.mesh_path, &anonymous_path] {
        let run = program()
            .arg("classify")
            .args([input, &PathBuf::from("--cad"), &case.model_path, &PathBuf::from("-o"), &output])
            .output()
            .unwrap();
        let text = String::from_utf8(run.stdout).unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        assert!(text.contains("greatest dist.") && text.contains("ridges: 62"), "{text}");
        let mesh = io::read_mesh(&output).unwrap().content;
        let association = &mesh.association;
        assert_eq!([association.vertices.len(), association.edges.len(), association.faces.len()], [10, 47, 154]);
        assert_eq!((mesh.corners.len(), mesh.edges.len(), mesh.ridges.len()), (10, 62, 62));
        assert_eq!(mesh.triangles.refs, case.mesh.triangles.refs);
        let edges: std::collections::BTreeSet<i32> = mesh.edges.refs.iter().copied().collect();
        assert_eq!(edges, (1..=15).collect());
        let (_, report) = fit(&mesh, &case.model).unwrap();
        assert!(report.dimensions.iter().all(|d| d.from_file == d.count), "what was written holds: {report:?}");
    }
}

/// A triangle with three vertices on the rim of a cylinder lies on the side as well as on the cap: its reference tells which.
#[test]
fn an_ear_on_a_rim_has_the_face_of_its_reference() {
    const AROUND: u32 = 12;
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/cylinder.step");
    let model = Model::read(&model).unwrap();
    let mut mesh = TetMesh::default();
    for z in [0.0, 0.5, 1.0] {
        for k in 0..AROUND {
            let angle = std::f64::consts::TAU * f64::from(k) / f64::from(AROUND);
            mesh.vertices.push([0.25 * angle.cos(), 0.25 * angle.sin(), z]);
        }
    }
    let centres = [0.0, 1.0].map(|z| {
        mesh.vertices.push([0.0, 0.0, z]);
        mesh.vertices.len() as u32 - 1
    });
    let mut triangles = Vec::new();
    let mut add = |nodes: [u32; 3], reference: i32| triangles.push((nodes, reference));
    for k in 0..AROUND {
        let next = (k + 1) % AROUND;
        add([centres[0], next, k], 2);
        add([AROUND + k, AROUND + next, 2 * AROUND + next], 1);
        add([AROUND + k, 2 * AROUND + next, 2 * AROUND + k], 1);
        // The side is cut off below vertex 4: there the ear is.
        let lower = if next == 4 { 5 } else { next };
        match k {
            4 => add([5, AROUND + 5, AROUND + 4], 1),
            _ => {
                add([k, lower, AROUND + next], 1);
                add([k, AROUND + next, AROUND + k], 1);
            }
        }
    }
    for k in 0..AROUND {
        add([centres[1], 2 * AROUND + k, 2 * AROUND + (k + 1) % AROUND], 3);
    }
    add([3, 4, 5], 1);
    (mesh.triangles.nodes, mesh.triangles.refs) = triangles.into_iter().unzip();
    let (result, report) = fit(&mesh, &model).unwrap();
    let of_references: Vec<u32> = mesh.triangles.refs.iter().map(|&of| of as u32 - 1).collect();
    assert_eq!(result.faces, of_references, "{:?}", report.notices);
    assert_eq!(result.entities[4].dimension(), 1);
}
