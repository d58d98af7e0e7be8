//! A loop without CAD: the surface stays where it is.
use super::{Adapter, MeshView, Settings};
use crate::geometry::{Evaluate, Geometry};
use crate::mesh::TetMesh;
use crate::mesh::samples::cube;
use crate::mesh::vector::{Vec3, norm, scale, sub, unit, volume6};
use crate::metric::Sym3;

/// A ball of radius 1, its surface that of a cube blown up and shaken, with one vertex in the middle. Upper and lower half have
/// references of their own where `halves` says so.
fn ball(n: u32, halves: bool) -> TetMesh {
    let block = cube(n);
    let is_on = |v: u32| block.vertices[v as usize].iter().any(|&x| x == 0.0 || x == 1.0);
    let mut number = vec![u32::MAX; block.vertices.len()];
    let mut mesh = TetMesh::default();
    mesh.vertices.push([0.0; 3]);
    let mut seed = 7u64;
    let mut shake = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        0.2 * ((seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0) / f64::from(n)
    };
    for v in (0..block.vertices.len() as u32).filter(|&v| is_on(v)) {
        let q = sub(block.vertices[v as usize], [0.5; 3]);
        let round = unit(q.map(|x| (std::f64::consts::FRAC_PI_2 * x).tan()));
        // The equator stays: it may be a ridge.
        let shaken = if q[2] == 0.0 { round } else { [round[0] + shake(), round[1] + shake(), round[2]] };
        number[v as usize] = mesh.vertices.len() as u32;
        mesh.vertices.push(unit(shaken));
    }
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    for (nodes, _) in block.triangles.iter() {
        let upper = nodes.iter().map(|&v| block.vertices[v as usize][2]).sum::<f64>() > 1.5;
        let mut nodes = nodes.map(|v| number[v as usize]);
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        if volume6(a, b, c, [0.0; 3]) > 0.0 {
            nodes.swap(1, 2);
        }
        mesh.triangles.push(nodes, if halves && upper { 2 } else { 1 });
        mesh.tets.push([nodes[0], nodes[2], nodes[1], 0], 5);
    }
    mesh
}

fn sized(mesh: &TetMesh, size: f64) -> Vec<Sym3> {
    vec![Sym3::IDENTITY.times(size.powi(-2)); mesh.vertices.len()]
}

fn surface_vertices(mesh: &TetMesh) -> Vec<Vec3> {
    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.nodes.iter().flatten().for_each(|&v| used[v as usize] = true);
    (0..used.len()).filter(|&v| used[v]).map(|v| mesh.vertices[v]).collect()
}

/// Sizes of the runs.
const SIZES: [f64; 8] = [0.2, 0.12, 0.2, 0.12, 0.35, 0.12, 0.12, 0.12];

fn settings() -> Settings {
    Settings { threads: 1, ..Settings::default() }
}

#[test]
fn eight_runs_on_their_own_surfaces_leave_the_ball_round() {
    let mut mesh = ball(6, false);
    for size in SIZES {
        let metric = sized(&mesh, size);
        mesh = Adapter::discrete(settings()).unwrap().adapt(&MeshView::of(&mesh), &metric).unwrap().mesh;
        for p in surface_vertices(&mesh) {
            assert!((norm(p) - 1.0).abs() < 5e-4, "{size}: {}", norm(p));
        }
    }
    assert!(surface_vertices(&mesh).len() > 600);
}

#[test]
fn on_a_first_surface_nothing_drifts_and_tags_stay() {
    let first = ball(6, true);
    let mut adapter = Adapter::on_surface(&MeshView::of(&first), settings()).unwrap();
    let mut mesh = first.clone();
    for size in &SIZES[..5] {
        let metric = sized(&mesh, *size);
        mesh = adapter.adapt(&MeshView::of(&mesh), &metric).unwrap().mesh;
        let mut evaluator = adapter.model().unwrap().evaluator();
        for p in surface_vertices(&mesh) {
            let off =
                (0..2).map(|face| evaluator.closest_on_face(face, p, None).distance).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-9 && (norm(p) - 1.0).abs() < 2e-4, "{size}: {off} {}", norm(p));
        }
        for (nodes, reference) in mesh.triangles.iter() {
            let middle = nodes.iter().fold([0.0; 3], |sum, &v| sub(sum, scale(mesh.vertices[v as usize], -1.0 / 3.0)));
            assert_eq!(reference, if middle[2] > 0.0 { 2 } else { 1 }, "{middle:?}");
        }
        assert!(mesh.edges.len() > 10, "the ridge between the references is there");
    }
    // A mesh that is not on the surface is refused.
    let mut other = first.clone();
    other.vertices.iter_mut().for_each(|p| *p = scale(*p, 1.01));
    let metric = sized(&other, 0.3);
    assert!(adapter.adapt(&MeshView::of(&other), &metric).is_err());
    // Triangles alone are a surface too; a mesh without any is none.
    let mut shell = first.clone();
    shell.tets = Default::default();
    assert!(Adapter::on_surface(&MeshView::of(&shell), settings()).is_ok());
    assert!(Adapter::on_surface(&MeshView::of(&TetMesh::default()), settings()).is_err());
}
