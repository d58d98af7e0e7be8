//! What the input requires and what the user freezes stays as it is, to the bit, also where it lies a little beside its model.

use crate::common::adapting::{Workplace, cube, isotropic};
use geo_adapt::mesh::vector::{Vec3, volume6};
use geo_adapt::mesh::{Elements, TetMesh};
use std::collections::BTreeSet;

/// A point to the bit.
type Bits = [u64; 3];

fn bits(p: Vec3) -> Bits {
    p.map(f64::to_bits)
}

/// The elements with a reference, each by its points to the bit.
fn of_reference<const N: usize>(mesh: &TetMesh, elements: &Elements<N>, wanted: i32) -> BTreeSet<Vec<Bits>> {
    let listed = elements.iter().filter(|&(_, reference)| reference == wanted);
    listed.map(|(nodes, _)| points(mesh, &nodes)).collect()
}

fn points(mesh: &TetMesh, nodes: &[u32]) -> Vec<Bits> {
    let mut points: Vec<Bits> = nodes.iter().map(|&v| bits(mesh.vertices[v as usize])).collect();
    points.sort_unstable();
    points
}

/// A cube of two regions, on whose side z = 1 flat tetrahedra of region 2 lie like roofs, each with two triangles of that side.
fn with_roofs() -> TetMesh {
    let n = 4;
    let mut mesh = cube(n, |p| 1 + i32::from(p[0] > 0.5));
    let index = |i: u32, j: u32| (i * (n + 1) + j) * (n + 1) + n;
    for [i, j] in [[2, 1], [3, 2]] {
        let [a, b, c, d] = [index(i, j), index(i + 1, j + 1), index(i + 1, j), index(i, j + 1)];
        for ridge in [c, d] {
            mesh.vertices[ridge as usize][2] = 1.04;
        }
        let kept = mesh.triangles.iter().filter(|(nodes, _)| !(nodes.contains(&a) && nodes.contains(&b)));
        let mut triangles = Elements::default();
        kept.for_each(|(nodes, reference)| triangles.push(nodes, reference));
        assert_eq!(triangles.len() + 2, mesh.triangles.len());
        triangles.push([a, c, d], 6);
        triangles.push([b, d, c], 6);
        mesh.triangles = triangles;
        let [p, q, r, s] = [a, b, c, d].map(|v| mesh.vertices[v as usize]);
        mesh.tets.push(if volume6(p, q, r, s) > 0.0 { [a, b, c, d] } else { [b, a, c, d] }, 2);
    }
    mesh
}

#[test]
fn edge_removal_takes_no_tetrahedron_from_the_boundary_of_a_frozen_region() {
    let work = Workplace::new();
    let input = with_roofs();
    let metric = work.metric(&input, |_| isotropic(0.25));
    let thawed = work.adapt(&work.mesh(&input), &["--metric", &metric]).mesh;
    assert!(!of_reference(&input, &input.tets, 2).is_subset(&of_reference(&thawed, &thawed.tets, 2)));
    let frozen = work.adapt(&work.mesh(&input), &["--metric", &metric, "--freeze", "region:2"]).mesh;
    assert_eq!(of_reference(&frozen, &frozen.tets, 2), of_reference(&input, &input.tets, 2));
}

#[test]
fn a_required_vertex_of_no_tetrahedron_does_not_count() {
    let work = Workplace::new();
    let mut input = cube(2, |_| 1);
    let hanging = input.vertices.len() as u32;
    input.vertices.push([3.0; 3]);
    input.vertex_refs.push(0);
    input.edges.push([0, hanging], 4);
    input.edges.push([0, 1], 5);
    input.required_edges = vec![0, 1];
    input.required_vertices = vec![hanging, 13];
    let metric = work.metric(&input, |_| isotropic(0.2));
    let mesh = work.adapt(&work.mesh(&input), &["--metric", &metric]).mesh;
    let required = |mesh: &TetMesh, v: usize| bits(mesh.vertices[mesh.required_vertices[v] as usize]);
    assert_eq!((mesh.required_vertices.len(), required(&mesh, 0)), (1, bits([0.5; 3])));
    let [edge] = mesh.required_edges[..] else { panic!("{:?}", mesh.required_edges) };
    assert_eq!(points(&mesh, &mesh.edges.nodes[edge as usize]), points(&input, &[0, 1]));
}

#[cfg(feature = "occt")]
mod on_cad {
    use super::*;
    use crate::common::adapting::{Adapted, text};
    use geo_adapt::adapt::{Freeze, Options};
    use geo_adapt::api::{Adapter, MeshView, Settings};
    use geo_adapt::mesh::io;
    use geo_adapt::metric::Sym3;
    use std::path::{Path, PathBuf};

    /// How far vertices lie beside the model: within the tolerance.
    const BESIDE: f64 = 4e-7;

    fn at(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
    }

    /// The same mesh with every vertex moved by something of no more than [`BESIDE`] in each direction.
    fn shaken(mut mesh: TetMesh) -> TetMesh {
        let mut state = 1u64;
        for x in mesh.vertices.as_flattened_mut() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *x += BESIDE * ((state >> 11) as f64 / (1u64 << 52) as f64 - 1.0);
        }
        mesh
    }

    fn cylinder() -> TetMesh {
        shaken(io::read_mesh(&at("cases/cube-cylinder/start.meshb")).unwrap().content)
    }

    /// Two boxes side by side, the first of region 1, the second of region 2.
    fn boxes() -> TetMesh {
        let mut mesh = cube(4, |p| 1 + i32::from(p[0] > 0.5));
        mesh.vertices.iter_mut().for_each(|p| p[0] *= 2.0);
        shaken(mesh)
    }

    fn adapt(work: &Workplace, mesh: &TetMesh, model: &str, arguments: &[&str]) -> Adapted {
        let model = text(&at("geometry").join(model));
        work.adapt(&work.mesh(mesh), &[&["--cad", &model], arguments].concat())
    }

    /// The vertices that must stay lie where they did, all others on the model; and the report tells them apart.
    fn check_fidelity(found: &Adapted) {
        let fidelity = &found.report["fidelity"];
        let distance = |name: &str| fidelity[name]["distance"].as_f64().unwrap();
        assert!(distance("from_entity") < 1e-9 && distance("from_model") < 1e-9, "{fidelity}");
        let held = distance("held");
        assert!(held > 0.1 * BESIDE && held < 2.0 * BESIDE, "{fidelity}");
        assert_eq!(found.report["off_model"], serde_json::json!([]));
    }

    #[test]
    fn a_frozen_surface_beside_its_model_stays_to_the_bit() {
        let input = cylinder();
        // Refined; coarsened before the store is filled; in two cycles.
        for arguments in [["300", "1"], ["2", "1"], ["300", "2"]] {
            let [complexity, cycles] = arguments;
            let arguments = ["--analytic", "polar-2", "--complexity", complexity, "--cycles", cycles, "--freeze", "5"];
            let found = adapt(&Workplace::new(), &input, "cube-cylinder.step", &arguments);
            let mesh = &found.mesh;
            assert_eq!(of_reference(mesh, &mesh.triangles, 5), of_reference(&input, &input.triangles, 5));
            check_fidelity(&found);
        }
    }

    #[test]
    fn a_frozen_region_beside_its_model_stays_to_the_bit() {
        let input = boxes();
        for size in ["0.6", "0.12"] {
            let work = Workplace::new();
            let metric = work.metric(&input, |_| isotropic(size.parse().unwrap()));
            let found = adapt(&work, &input, "two-materials.step", &["--metric", &metric, "--freeze", "region:2"]);
            let mesh = &found.mesh;
            assert_eq!(of_reference(mesh, &mesh.tets, 2), of_reference(&input, &input.tets, 2));
            check_fidelity(&found);
        }
    }

    #[test]
    fn what_is_required_beside_its_model_stays_to_the_bit() {
        let mut input = cylinder();
        let wall: Vec<u32> =
            (0..input.triangles.len() as u32).filter(|&t| input.triangles.refs[t as usize] == 5).collect();
        let nodes = |t: usize| input.triangles.nodes[wall[t] as usize];
        let (vertex, triangle) = (nodes(0)[0], wall[wall.len() / 3]);
        let [a, b, _] = nodes(2 * wall.len() / 3);
        (input.required_vertices, input.required_triangles) = (vec![vertex], vec![triangle]);
        input.required_edges = vec![input.edges.len() as u32];
        input.edges.push([a, b], 77);
        for complexity in ["300", "2"] {
            let arguments = ["--analytic", "polar-2", "--complexity", complexity];
            let found = adapt(&Workplace::new(), &input, "cube-cylinder.step", &arguments);
            let mesh = &found.mesh;
            let all = |mesh: &TetMesh| {
                let vertices = mesh.required_vertices.iter().map(|&v| points(mesh, &[v]));
                let edges = mesh.required_edges.iter().map(|&e| points(mesh, &mesh.edges.nodes[e as usize]));
                let triangles =
                    mesh.required_triangles.iter().map(|&t| points(mesh, &mesh.triangles.nodes[t as usize]));
                vertices.chain(edges).chain(triangles).collect::<Vec<_>>()
            };
            assert_eq!(all(mesh), all(&input));
            check_fidelity(&found);
        }
    }

    #[test]
    fn a_frozen_surface_stays_to_the_bit_in_memory_too() {
        let input = cylinder();
        let options = Options { freeze: Freeze { surfaces: vec![5], regions: Vec::new() }, ..Options::default() };
        let settings = Settings { threads: 1, complexity: Some(300.0), options, ..Settings::default() };
        let mut adapter = Adapter::on_cad(&at("geometry/cube-cylinder.step"), settings).unwrap();
        let metric = |mesh: &TetMesh| vec![Sym3::diagonal(25.0, 100.0, 25.0).0; mesh.vertices.len()];
        let mut adapted = adapter.adapt(&MeshView::of(&input), &metric(&input)).unwrap();
        for _ in 0..2 {
            let mesh = &adapted.mesh;
            assert_eq!(of_reference(mesh, &mesh.triangles, 5), of_reference(&input, &input.triangles, 5));
            // The place of what came out goes in again.
            adapted = adapter.adapt(&adapted.view(), &metric(mesh)).unwrap();
        }
    }

    #[test]
    fn what_is_frozen_by_a_reference_that_the_first_cycle_replaces_is_refused() {
        let mut input = cylinder();
        input.triangles.refs.fill(1);
        let work = Workplace::new();
        let model = text(&at("geometry/cube-cylinder.step"));
        let arguments = ["--cad", &model, "--analytic", "polar-2", "--complexity", "50", "--freeze", "1"];
        let message = work.refusal(&work.mesh(&input), &[&arguments[..], &["--cycles", "2"]].concat());
        assert!(message.contains("--freeze") && message.contains("classify"), "{message}");
        // In one cycle all of the surface stays.
        let found = work.adapt(&work.path("in.meshb"), &arguments);
        let all =
            |mesh: &TetMesh| mesh.triangles.nodes.iter().map(|nodes| points(mesh, nodes)).collect::<BTreeSet<_>>();
        assert_eq!(all(&found.mesh), all(&input));
    }
}
