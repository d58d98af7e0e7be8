//! From its file a mesh is told to be what it is in memory, however small the pieces.
use super::*;
use crate::mesh::adjacency::FACES;
use crate::mesh::io::write_mesh;
use crate::mesh::samples::{cube, shuffled, with_boundary};
use crate::mesh::{FlawKind, TetMesh, validity};
use crate::metric::statistics::Class;
use crate::metric::{Analytic, Distribution, Field, Sym3};
use crate::tasks::{Plan, Pool};

/// From one vertex a range, and slices of two blocks, to all at once.
const SIZES: [Sizes; 4] = [
    Sizes { slice: 32, block: 16, range: 1, memory: None },
    Sizes { slice: 64, block: 64, range: 20_000, memory: None },
    Sizes { slice: 1024, block: 16, range: 60_000, memory: None },
    Sizes { slice: 1 << 16, block: 1 << 10, range: 1 << 30, memory: None },
];

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(b.abs())
}

/// The same values; sums may be rounded otherwise.
fn are_alike(a: &Distribution, b: &Distribution) -> bool {
    let counts = |of: &Distribution| of.classes.iter().map(|class: &Class| class.count).collect::<Vec<_>>();
    (a.count, a.min, a.max, counts(a)) == (b.count, b.min, b.max, counts(b)) && close(a.mean, b.mean)
}

fn assert_alike(found: &Statistics, expected: &Statistics) {
    assert!(are_alike(&found.edge_lengths, &expected.edge_lengths), "{found:?}");
    assert!(are_alike(&found.mean_ratios, &expected.mean_ratios), "{found:?}");
    assert_eq!(found.mean_ratios.argmin, expected.mean_ratios.argmin);
    let counts = |of: &Statistics| {
        let Statistics { vertices, tets, triangles, tagged_edges, regions, patches, curves, .. } = of.clone();
        ([vertices, tets, triangles, tagged_edges], regions, patches, curves)
    };
    assert_eq!(counts(found), counts(expected));
    assert!(close(found.volume, expected.volume));
    let metric = |of: &Statistics| of.metric.clone().map(|metric| (metric.complexity, metric.unit_edges));
    match (metric(found), metric(expected)) {
        (Some((a, b)), Some((c, d))) => assert!(close(a, c) && b == d),
        (found, expected) => assert_eq!(found, expected),
    }
}

/// Inspects a mesh by pieces of all sizes, in space and in metrics, and returns the kinds of its flaws.
fn inspected(mesh: &TetMesh) -> Vec<FlawKind> {
    let folder = tempfile::tempdir().unwrap();
    let (path, of_metric) = (folder.path().join("a.meshb"), folder.path().join("a.solb"));
    write_mesh(&path, mesh).unwrap();
    let field = Analytic::Polar2;
    let metrics: Vec<Sym3> = mesh.vertices.iter().map(|&p| field.at(p)).collect();
    Field { metrics: metrics.clone() }.write(&of_metric).unwrap();
    let reader = MeshReader::open(&path).unwrap();
    let file = Field::open(&of_metric, mesh.vertices.len()).unwrap();
    let pool = Pool::new(3).unwrap();
    let expected = validity::check(mesh);
    let in_space = Statistics::in_space(Team::alone(), mesh);
    let in_metric = Statistics::in_metric(Team::alone(), mesh, &metrics);
    for sizes in &SIZES {
        for team in [Team::alone(), Team::new(&pool, Plan::default())] {
            let ways = [
                (Metrics::None, &in_space),
                (Metrics::File(&file), &in_metric),
                (Metrics::Analytic(field), &in_metric),
            ];
            for (metrics, statistics) in ways {
                let found = inspect_by(team, &reader, metrics, sizes).unwrap();
                assert_eq!(found.validity, expected, "{sizes:?}");
                assert_alike(&found.statistics, statistics);
                let worst = mesh.tets.nodes[statistics.mean_ratios.argmin].map(|v| mesh.vertices[v as usize]);
                assert_eq!(found.worst, Some(worst));
            }
        }
    }
    expected.flaws.iter().map(|flaw| flaw.kind).collect()
}

/// A cube moved off its lattice, with two regions and a tagged edge.
fn valid() -> TetMesh {
    let mut mesh = cube(5);
    for p in &mut mesh.vertices {
        let [x, y, z] = *p;
        let bump = 0.1 * (x - x * x) * (y - y * y) * (z - z * z);
        *p = [x + bump, y - 2.0 * bump, z + 3.0 * bump];
    }
    mesh.tets.refs[100..].fill(2);
    mesh.edges.push([0, 1], 3);
    mesh
}

#[test]
fn a_valid_mesh_in_any_order() {
    assert_eq!(inspected(&valid()), []);
    assert_eq!(inspected(&shuffled(&valid())), []);
}

#[test]
fn flaws_of_elements() {
    let mut mesh = valid();
    for t in [3, 77, 78, 400] {
        mesh.tets.nodes[t].swap(1, 2);
    }
    mesh.tets.nodes[200] = mesh.tets.nodes[500];
    mesh.tets.nodes[201][1] = mesh.tets.nodes[201][3];
    mesh.triangles.nodes[20][0] = mesh.triangles.nodes[20][1];
    mesh.triangles.nodes[21] = mesh.triangles.nodes[90];
    let kinds = inspected(&mesh);
    use FlawKind::*;
    for kind in [InvertedTet, RepeatedNodes, DuplicateTet, DuplicateTriangle, FoldedFace, NonManifoldFace, OpenBoundary]
    {
        assert!(kinds.contains(&kind), "{kind:?} of {kinds:?}");
    }
    inspected(&shuffled(&mesh));
}

#[test]
fn flaws_of_neighbours() {
    let mut mesh = valid();
    for t in [600, 310, 5] {
        mesh.tets.nodes.remove(t);
        mesh.tets.refs.remove(t);
    }
    mesh.triangles.nodes.remove(50);
    mesh.triangles.refs.remove(50);
    mesh.vertices.extend([[0.3; 3], [0.4; 3], [7.0; 3], [8.0; 3]]);
    mesh.vertex_refs.extend([0; 4]);
    mesh.edges.push([0, 200], 1);
    mesh.edges.push([9, 9], 1);
    let last = mesh.vertices.len() as u32 - 1;
    mesh.triangles.push([last, 4, last - 1], 1);
    mesh.triangles.push([0, 100, 50], 1);
    let kinds = inspected(&mesh);
    use FlawKind::*;
    assert_eq!(kinds, [LooseTriangle, OpenBoundary, LooseEdge, UnusedVertex]);
    inspected(&shuffled(&mesh));
}

#[test]
fn boundaries_that_touch_and_cross() {
    let body = cube(3);
    let beside = |by: f64, joined: usize| {
        let mut vertices = body.vertices.clone();
        let count = vertices.len() as u32;
        vertices.extend(body.vertices.iter().map(|[x, y, z]| [x + by, y + 0.21, z + 0.13]));
        // The second has some of the first one's vertices in place of its own.
        let second = |v: u32| if (v as usize) < joined { count - 1 - v } else { v + count };
        let mut tets = body.tets.nodes.clone();
        tets.extend(body.tets.nodes.iter().map(|nodes| nodes.map(second)));
        let mut mesh = with_boundary(vertices, tets);
        mesh.vertex_refs.resize(mesh.vertices.len(), 0);
        mesh
    };
    assert_eq!(inspected(&beside(2.0, 0)), []);
    assert_eq!(inspected(&beside(0.9, 0)), [FlawKind::CrossingTriangles]);
    let kinds = inspected(&beside(2.0, 2));
    assert!(kinds.contains(&FlawKind::NonManifoldVertex) && kinds.contains(&FlawKind::UnusedVertex), "{kinds:?}");
    // An interior surface is no boundary.
    let mut mesh = valid();
    let tet = mesh.tets.nodes[300];
    FACES.into_iter().for_each(|face| mesh.triangles.push(face.map(|i| tet[i]), 9));
    assert!(!inspected(&mesh).contains(&FlawKind::LooseTriangle));
}

#[test]
fn what_is_wrong_with_files_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let (path, of_metric) = (folder.path().join("a.meshb"), folder.path().join("a.solb"));
    let mesh = valid();
    write_mesh(&path, &mesh).unwrap();
    let counts = *MeshReader::open(&path).unwrap().counts();
    let message = |error: Error| error.to_string();
    let few = inspect(Team::alone(), &MeshReader::open(&path).unwrap(), Metrics::None, 50_000_000);
    let said = message(few.err().unwrap());
    assert!(said.contains("give --memory") && said.contains("MB or more"), "{said}");
    // What is asked for is enough.
    let needed: u64 = said.split("--memory ").nth(1).and_then(|rest| rest.split("MB").next()).unwrap().parse().unwrap();
    assert!(
        Sizes::of(needed * 1_000_000, 2, &counts).is_ok() && Sizes::of((needed - 2) * 1_000_000, 2, &counts).is_err()
    );
    // A metric that is none, at a vertex in the middle.
    let mut metrics = vec![Sym3::IDENTITY; mesh.vertices.len()];
    metrics[100] = Sym3::diagonal(1.0, -1.0, 1.0);
    let values = metrics.iter().flat_map(|m| m.0).collect();
    let field = crate::mesh::io::SolutionField { kind: crate::mesh::io::FieldKind::SymmetricTensor, values };
    let solution = crate::mesh::io::Solution { vertices: metrics.len(), fields: vec![field] };
    crate::mesh::io::write_solution(&of_metric, &solution).unwrap();
    let (reader, file) = (MeshReader::open(&path).unwrap(), Field::open(&of_metric, metrics.len()).unwrap());
    for sizes in &SIZES {
        let said = message(inspect_by(Team::alone(), &reader, Metrics::File(&file), sizes).err().unwrap());
        assert!(said.contains("metric of vertex 101 is not positive definite"), "{said}");
    }
    // A tetrahedron that names a vertex which is not there.
    let mut bytes = std::fs::read(&path).unwrap();
    let last = bytes.len() - 4 - 20;
    bytes[last..last + 4].copy_from_slice(&9999i32.to_le_bytes());
    std::fs::write(&path, &bytes).unwrap();
    let expected = crate::mesh::io::read_mesh(&path).unwrap_err().to_string();
    let reader = MeshReader::open(&path).unwrap();
    for sizes in &SIZES {
        assert_eq!(message(inspect_by(Team::alone(), &reader, Metrics::None, sizes).err().unwrap()), expected);
    }
}
