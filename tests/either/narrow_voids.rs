//! The boundary never passes through itself: not where a void is thinner than the chords of its walls rise.
#[cfg(feature = "occt")]
use crate::common::adapting::text;
use crate::common::adapting::{Workplace, isotropic, stderr};
use crate::common::program;
#[cfg(feature = "occt")]
use crate::common::shared_case;
use geo_adapt::mesh::validity::{self, Validity};
use geo_adapt::mesh::{FlawKind, TetMesh, io, samples};

/// A rod and its bushing adapted to one uniform size after the other; how often a change was refused.
fn coarsened(mesh: TetMesh, sizes: &[f64], threads: &str) -> (TetMesh, u64) {
    let (mut mesh, mut refused) = (mesh, 0);
    for &size in sizes {
        let place = Workplace::new();
        let input = place.mesh(&mesh);
        let metric = place.metric(&mesh, |_| isotropic(size));
        // Every result is checked, crossings included.
        let adapted = place.adapt(&input, &["--metric", &metric, "--threads", threads]);
        assert_eq!(adapted.report["crossings"]["count"], 0);
        for operation in adapted.report["operations"].as_object().unwrap().values() {
            refused += operation["refused"]["crossing"].as_u64().unwrap_or(0);
        }
        mesh = adapted.mesh;
    }
    (mesh, refused)
}

#[test]
fn boundaries_cross_in_silence() {
    let start = samples::rod_in_bushing(0.01, 48, 6);
    assert_eq!(validity::check(&start), Validity::default());
    let (mesh, refused) = coarsened(start.clone(), &[0.3, 0.6, 1.2], "1");
    assert!(refused > 0, "nothing was in the way");
    assert!(mesh.vertices.len() < start.vertices.len() / 4, "{} vertices", mesh.vertices.len());
    assert_eq!(coarsened(start, &[0.3, 0.6, 1.2], "3").0, mesh, "the threads matter");
}

#[test]
fn a_wide_gap_hinders_nothing() {
    let start = samples::rod_in_bushing(0.4, 24, 3);
    let (_, refused) = coarsened(start, &[0.3, 0.5], "1");
    assert_eq!(refused, 0);
}

#[test]
fn a_sharp_edge_of_a_void_gets_as_coarse_as_is_asked() {
    // Two sides that share their edges, in a far field that is as coarse as the lens is long.
    let start = samples::about_a_lens(0.1, 64, 8);
    let (mesh, _) = coarsened(start, &[0.3, 1.0], "2");
    let on_lens = |p: &[f64; 3]| p[0].abs() <= 1.0 && p[1].abs() <= 0.0501 * (1.0 - p[0] * p[0]) + 1e-9;
    let left = mesh.vertices.iter().filter(|p| on_lens(p)).count();
    assert!(left <= 16, "{left} vertices on the lens");
}

/// The rod pushed into its bushing.
fn crossing() -> TetMesh {
    let mut mesh = samples::rod_in_bushing(0.05, 24, 3);
    let rod: std::collections::BTreeSet<u32> =
        mesh.tets.iter().filter(|(_, reference)| *reference == 1).flat_map(|(nodes, _)| nodes).collect();
    rod.into_iter().for_each(|v| mesh.vertices[v as usize][0] += 0.1);
    mesh
}

#[test]
fn inspect_names_boundary_triangles_that_cross() {
    let (place, mesh) = (Workplace::new(), crossing());
    let found = validity::check(&mesh).count(FlawKind::CrossingTriangles);
    assert!(found > 10, "{found}");
    let run = program().arg("inspect").arg(place.mesh(&mesh)).output().unwrap();
    assert_eq!(run.status.code(), Some(1));
    let said = String::from_utf8(run.stdout).unwrap();
    assert!(said.contains(&format!("{found} pairs of boundary triangles that cross: no. ")), "{said}");
}

#[test]
fn a_mesh_that_comes_in_crossing_is_told_and_taken() {
    let (place, mesh) = (Workplace::new(), crossing());
    let metric = place.metric(&mesh, |_| isotropic(0.3));
    let input = place.mesh(&mesh);
    let run = place.command(&input, &["--metric", &metric]).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let said = stderr(&run);
    assert!(said.contains("crosses itself") && said.contains("in.meshb"), "{said}");
    let said = String::from_utf8(run.stdout).unwrap();
    let left = validity::check(&io::read_mesh(&place.path("out.meshb")).unwrap().content);
    let left = left.count(FlawKind::CrossingTriangles);
    assert_eq!(said.contains("THE BOUNDARY CROSSES ITSELF"), left > 0, "{said}");
    assert!(left == 0 || said.contains(&format!("{left} pairs of triangles")), "{said}");
}

#[cfg(feature = "occt")]
#[test]
fn ring_gap() {
    let Some(model) = shared_case("cad-faults/ring-gap.brep") else { return };
    let place = Workplace::new();
    let (model, first) = (text(&model), place.path("first.meshb"));
    let made = program().args(["bootstrap", &model, "-o", &text(&first), "--quiet"]).output().unwrap();
    if !made.status.success() {
        eprintln!("skipped: no first mesh ({})", stderr(&made));
        return;
    }
    let mut mesh = io::read_mesh(&first).unwrap().content;
    for size in [0.3, 0.6, 1.2] {
        let input = place.mesh(&mesh);
        let metric = place.metric(&mesh, |_| isotropic(size));
        mesh = place.adapt(&input, &["--metric", &metric, "--cad", &model]).mesh;
    }
}
