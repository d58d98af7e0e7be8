use super::super::keyword::Keyword;
use super::super::read::{mesh_from, solution_from};
use super::super::rows::{Whole, solution_sections};
use super::super::{FieldKind, Solution, SolutionField};
use super::*;
use crate::mesh::samples::cube;
use crate::mesh::stack::Stack;
use crate::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use crate::tasks::{Plan, Pool};
use std::fs::File;
use std::path::Path;
use std::sync::LazyLock;

fn section(keyword: Keyword, count: usize) -> Section {
    Section { keyword, count, body: 0..0, kinds: Vec::new() }
}

#[test]
fn the_version_follows_from_the_size() {
    assert_eq!(version(&[section(Keyword::Vertices, 1000)]), 2);
    // 28 bytes a vertex
    let full = (i32::MAX as usize - 28 - 12) / 28;
    assert_eq!(version(&[section(Keyword::Vertices, full)]), 2);
    assert_eq!(version(&[section(Keyword::Vertices, full + 1)]), 3);
    let metric = Section { kinds: vec![FieldKind::SymmetricTensor], ..section(Keyword::SolAtVertices, 50_000_000) };
    assert_eq!(version(&[metric]), 3);
    assert_eq!(version(&[section(Keyword::Corners, i32::MAX as usize + 1)]), 4);
}

/// A mesh without a stack.
fn whole(mesh: &TetMesh) -> Whole<'_> {
    static NONE: LazyLock<Stack> = LazyLock::new(Stack::default);
    Whole::of(mesh, &NONE)
}

fn streamed(team: Team<'_>, layout: &Layout) -> Vec<u8> {
    let mut bytes = Vec::new();
    layout.write(team, To::Stream(&mut bytes)).unwrap();
    bytes
}

/// Versions 3 and 4 are chosen for files that are too big for a test; what they look like is tested here.
#[test]
fn every_version_that_is_written_reads_back() {
    let mut mesh = TetMesh { vertices: vec![[0.1, -2.5e-300, 7.0]; 4], vertex_refs: vec![-1; 4], ..Default::default() };
    mesh.tets.push([3, 1, 0, 2], i32::MIN);
    mesh.association.faces.push(OnFace { vertex: 3, id: 2, uv: [0.5, 0.25], r: 1.0 });
    let solution = Solution::metric(&[[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]; 3]);
    let (of_mesh, of_solution) = (whole(&mesh).sections(), solution_sections(&solution));
    for (version, position, int) in [(2, 4, 4), (3, 8, 4), (4, 8, 8)] {
        let bytes = streamed(Team::alone(), &Layout::of(true, version, &of_mesh, Content::Mesh(whole(&mesh))));
        let rows = 4 * (24 + int) + 5 * int + 2 * int + 24;
        assert_eq!(bytes.len(), 8 + 5 * (4 + position) + 4 + 3 * int + rows, "version {version}");
        assert_eq!(mesh_from(Team::alone(), Path::new("m"), &bytes).unwrap().content.0, mesh);
        let layout = Layout::of(true, version, &of_solution, Content::Solution(&solution));
        let bytes = streamed(Team::alone(), &layout);
        assert_eq!(solution_from(Team::alone(), Path::new("s"), &bytes).unwrap().content, solution);
    }
}

/// A mesh with rows of every kind: more tetrahedra and vertices than a piece has, as many edges, fewer of the others.
fn mesh() -> TetMesh {
    let mut mesh = cube(16);
    assert!(mesh.vertices.len() > ROWS && mesh.tets.len() > 5 * ROWS);
    mesh.vertex_refs = (0..mesh.vertices.len() as i32).map(|v| v % 7 - 3).collect();
    (0..ROWS as u32).for_each(|e| mesh.edges.push([e, e + 1], e as i32));
    mesh.corners = vec![4, 2];
    mesh.ridges = (0..ROWS as u32 - 1).collect();
    (mesh.required_vertices, mesh.required_edges, mesh.required_triangles) = (vec![0], vec![3, 1], vec![5]);
    mesh.association.vertices.push(OnVertex { vertex: 2, id: 8 });
    mesh.association.edges.push(OnEdge { vertex: 3, id: -1, t: 0.3, r: 1e-300 });
    mesh.association.faces = vec![OnFace { vertex: 1, id: 5, uv: [-0.25, 1.0 / 3.0], r: 0.0 }; ROWS + 1];
    mesh
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let mesh = mesh();
    let scalars = |start: f64| (0..mesh.vertices.len()).map(|v| start + v as f64 / 3.0).collect::<Vec<_>>();
    let vectors = SolutionField { kind: FieldKind::Vector, values: [0.0, 0.1, -1e9].map(scalars).concat() };
    let fields = vec![SolutionField { kind: FieldKind::Scalar, values: scalars(1.0) }, vectors];
    let solution = Solution { vertices: mesh.vertices.len(), fields };
    let (of_mesh, of_solution) = (whole(&mesh).sections(), solution_sections(&solution));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let in_file = |team: Team<'_>, layout: &Layout| {
        layout.write(team, To::File(&File::create(&path).unwrap())).unwrap();
        std::fs::read(&path).unwrap()
    };
    for (binary, version) in [(false, 2), (true, 2), (true, 3), (true, 4)] {
        for is_mesh in [true, false] {
            let (sections, content) = match is_mesh {
                true => (&of_mesh, Content::Mesh(whole(&mesh))),
                false => (&of_solution, Content::Solution(&solution)),
            };
            let layout = Layout::of(binary, version, sections, content);
            let alone = streamed(Team::alone(), &layout);
            assert!(in_file(Team::alone(), &layout) == alone);
            for threads in [2, 3, 8] {
                let pool = Pool::new(threads).unwrap();
                let team = Team::new(&pool, Plan::default());
                assert!(in_file(team, &layout) == alone && streamed(team, &layout) == alone, "{threads} threads");
            }
            if is_mesh {
                assert!(mesh_from(Team::alone(), &path, &alone).unwrap().content.0 == mesh);
            } else {
                assert!(solution_from(Team::alone(), &path, &alone).unwrap().content == solution);
            }
        }
    }
}

/// The bytes of a small file of each kind, as they were before all threads wrote them.
#[test]
fn a_small_file_has_these_bytes() {
    let mut mesh = TetMesh { vertices: vec![[0.5, 0.0, -2.0]], vertex_refs: vec![3], ..Default::default() };
    mesh.edges.push([0, 0], -1);
    mesh.association.edges.push(OnEdge { vertex: 0, id: 9, t: 0.25, r: 1e300 });
    let sections = whole(&mesh).sections();
    let text = streamed(Team::alone(), &Layout::of(false, 2, &sections, Content::Mesh(whole(&mesh))));
    let expected = "MeshVersionFormatted 2\n\nDimension 3\n\nVertices\n1\n0.5 0.0 -2.0 3\n\nEdges\n1\n1 1 -1\n\n\
                    VerticesOnGeometricEdges\n1\n1 9 0.25 1e300\n\nEnd\n";
    assert_eq!(String::from_utf8(text).unwrap(), expected);
    let solution = Solution::metric(&[[1.0, 0.0, 2.0, 0.0, 0.0, 0.25]]);
    let sections = solution_sections(&solution);
    let text = streamed(Team::alone(), &Layout::of(false, 2, &sections, Content::Solution(&solution)));
    let expected = "MeshVersionFormatted 2\n\nDimension 3\n\nSolAtVertices\n1\n1 3 \n1.0 0.0 2.0 0.0 0.0 0.25\n\nEnd\n";
    assert_eq!(String::from_utf8(text).unwrap(), expected);
    let bytes = streamed(Team::alone(), &Layout::of(true, 2, &sections, Content::Solution(&solution)));
    let words = |words: &[i32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let mut expected = words(&[1, 2, 3, 20, 3, 62, 88, 1, 1, 3]);
    expected.extend([1.0f64, 0.0, 2.0, 0.0, 0.0, 0.25].iter().flat_map(|x| x.to_le_bytes()));
    expected.extend(words(&[54, 0]));
    assert_eq!(bytes, expected);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_by_every_way() {
    let (mesh, pool) = (mesh(), Pool::new(3).unwrap());
    let sections = whole(&mesh).sections();
    let layout = Layout::of(true, 2, &sections, Content::Mesh(whole(&mesh)));
    let mut full = File::options().write(true).open("/dev/full").unwrap();
    for team in [Team::alone(), Team::new(&pool, Plan::default())] {
        for error in [layout.write(team, To::File(&full)), layout.write(team, To::Stream(&mut full))] {
            assert_eq!(error.unwrap_err().kind(), io::ErrorKind::StorageFull);
        }
    }
}
