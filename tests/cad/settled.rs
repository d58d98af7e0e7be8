//! What the geometry asks for on a mesh of `bootstrap` is what this mesh was made to.
#![cfg(unix)]

use crate::common::adapting::stderr;
use crate::common::program;
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::read_mesh;
use geo_adapt::mesh::vector::{Vec3, norm, volume6};
use geo_adapt::metric::{Field, Sym3};
use std::path::{Path, PathBuf};

/// A mesh of `bootstrap`, its metric, and that of `metric geometry` on it.
struct Made {
    mesh: TetMesh,
    own: Vec<Sym3>,
    again: Vec<Sym3>,
}

fn made(name: &str, gradation: &str) -> Made {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/zoo").join(name);
    let folder = tempfile::tempdir().unwrap();
    let [mesh, again]: [PathBuf; 2] = ["out.meshb", "again.solb"].map(|name| folder.path().join(name));
    let run = program().arg("bootstrap").arg(&model).arg("-o").arg(&mesh).arg("--quiet").output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{name}: {}", stderr(&run));
    let mut command = program();
    command.args(["metric", "geometry"]).arg(&mesh).arg("--cad").arg(&model).arg("-o").arg(&again);
    let run = command.args(["--quiet", "--gradation", gradation]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{name}: {}", stderr(&run));
    let content = read_mesh(&mesh).unwrap().content;
    let read = |path: &Path| Field::read(path, content.vertices.len()).unwrap().content.metrics;
    Made { own: read(&mesh.with_extension("solb")), again: read(&again), mesh: content }
}

/// Σ √det M V at the vertices.
fn complexity(mesh: &TetMesh, metrics: &[Sym3]) -> f64 {
    let of_tet = |nodes: &[u32; 4]| {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        volume6(a, b, c, d) / 24.0 * nodes.iter().map(|&v| metrics[v as usize].sqrt_det()).sum::<f64>()
    };
    mesh.tets.nodes.iter().map(of_tet).sum()
}

fn check(name: &str) {
    let Made { mesh, own, again } = made(name, "1.5");
    let [own, again] = [&own, &again].map(|metrics| complexity(&mesh, metrics));
    assert!((again / own - 1.0).abs() < 0.1, "{name}: made to {own}, asks for {again}");
}

/// Each of two blocks has an edge of its own where they meet: with a gap between these, which is nothing, a third more was asked for.
#[test]
fn edges_of_two_solids_at_one_place_are_no_gap() {
    check("knife-edge.step");
}

/// Near the ends of a thin coat the way to the rim of the end within it leans: taken as a gap across, it asked for a seventh more.
#[test]
fn ways_that_lean_across_a_thin_part_ask_for_no_more_than_the_part() {
    check("coated-pipe.step");
}

/// On a few hundred vertices it asked for as much twice, and for a tenth less of the third mesh.
#[test]
fn a_small_mesh_is_asked_again_after_its_last_cycle() {
    check("delta-wing-domain.step");
}

/// On the outer wall of the coat sizes along the pipe are those of its curvature, up to its ends.
#[test]
fn a_thin_coat_is_fine_across_alone_up_to_its_ends() {
    let Made { mesh, again, .. } = made("coated-pipe.step", "off");
    let radius = |p: &Vec3| norm([p[0], 0.0, p[2]]);
    let on_wall = |p: &Vec3| (radius(p) - 0.32).abs() < 1e-6 && p[1].abs() > 1e-6 && (p[1] + 0.8).abs() > 1e-6;
    let walls: Vec<usize> = (0..mesh.vertices.len()).filter(|&v| on_wall(&mesh.vertices[v])).collect();
    assert!(walls.len() > 100);
    for v in walls {
        let p = mesh.vertices[v];
        let out = [p[0] / radius(&p), 0.0, p[2] / radius(&p)];
        let [across, along] = [out, [0.0, 1.0, 0.0]].map(|g| again[v].quadratic(g).sqrt().recip());
        assert!((0.005..0.0105).contains(&across) && along > 0.05, "{p:?}: {across} across, {along} along");
    }
}
