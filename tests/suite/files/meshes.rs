//! Mesh and solution files: what is read comes out again, and what is wrong is one clear error.

use super::libmeshb::{Section, ascii, binary, section, sections};
use crate::common::shared_case;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use proptest::prelude::*;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// The mesh of [`sections`] as arrays. All reals are exact in 32 bits, so that version 1 holds them, too.
fn mesh() -> TetMesh {
    let mut mesh = TetMesh {
        vertices: vec![[0.0; 3], [1.5, 0.0, -0.0], [0.0, 1.25, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.375]],
        vertex_refs: vec![1, 2, 3, -4, 5],
        corners: vec![0, 4],
        required_vertices: vec![2],
        ridges: vec![1],
        required_edges: vec![0],
        required_triangles: vec![2, 0],
        ..TetMesh::default()
    };
    mesh.edges.push([0, 1], 7);
    mesh.edges.push([1, 2], 8);
    mesh.triangles.push([0, 2, 1], 1);
    mesh.triangles.push([0, 1, 3], 2);
    mesh.triangles.push([1, 2, 4], 3);
    mesh.tets.push([0, 1, 2, 3], 1);
    mesh.tets.push([1, 2, 3, 4], 2);
    mesh.association.vertices.push(OnVertex { vertex: 0, id: 9 });
    mesh.association.edges.push(OnEdge { vertex: 1, id: 4, t: 0.5, r: 1.0 });
    mesh.association.faces.push(OnFace { vertex: 2, id: 6, uv: [0.25, -2.0], r: 0.0 });
    mesh.association.faces.push(OnFace { vertex: 1, id: 7, uv: [1.0, 2.0], r: 3.0 });
    mesh
}

/// A folder for a test's files.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path("in");
        fs::write(&path, bytes).unwrap();
        path
    }

    fn read(&self, bytes: impl AsRef<[u8]>) -> io::Read<TetMesh> {
        io::read_mesh(&self.file(bytes)).unwrap()
    }
}

/// Bits of all reals, for comparisons that tell 0 from −0.
fn bits(mesh: &TetMesh) -> Vec<u64> {
    mesh.vertices.iter().flatten().map(|x| x.to_bits()).collect()
}

#[test]
fn every_version_and_byte_order_reads_the_same() {
    let folder = Folder::new();
    for version in 1..=4 {
        for big in [false, true] {
            let read = folder.read(binary(version, big, &sections()));
            assert_eq!(read.content, mesh(), "version {version}, big {big}");
            assert_eq!(bits(&read.content), bits(&mesh()));
            assert_eq!(read.notices, [""; 0]);
        }
    }
    let read = folder.read(ascii(&sections()));
    assert_eq!(read.content, mesh());
    assert_eq!(bits(&read.content), bits(&mesh()));
}

#[test]
fn a_binary_mesh_is_written_as_libmeshb_lays_it_out() {
    let folder = Folder::new();
    let path = folder.path("out.meshb");
    io::write_mesh(&path, &mesh()).unwrap();
    assert_eq!(fs::read(&path).unwrap(), binary(2, false, &sections()));
}

#[test]
fn shared_meshes_come_out_as_they_went_in() {
    let folder = Folder::new();
    // file, vertices, triangles, tets, associations on vertices, edges and faces, notices
    let cases = [
        ("cube/cube-linear-00.meshb", [64, 108, 162, 0, 0, 0, 0]),
        ("cube-cylinder/cube-cylinder.meshb", [286, 418, 952, 10, 77, 278, 1]),
        ("delta-wing/delta01.meshb", [143, 216, 434, 0, 0, 0, 0]),
        ("hemisphere-cylinder/hsc01.meshb", [586, 740, 2213, 7, 99, 464, 1]),
        ("hemisphere-cylinder/hsc-gmsh-26-adapt.meshb", [19140, 7602, 102604, 0, 0, 0, 0]),
        ("onera-m6/onera_curvAdapt.meshb", [1544, 1670, 6495, 14, 212, 1035, 0]),
    ];
    for (name, expected) in cases {
        let Some(path) = shared_case(name) else { continue };
        let io::Read { content: mesh, notices } = io::read_mesh(&path).unwrap();
        let on = &mesh.association;
        let counts = [
            mesh.vertices.len(),
            mesh.triangles.len(),
            mesh.tets.len(),
            on.vertices.len(),
            on.edges.len(),
            on.faces.len(),
            notices.len(),
        ];
        assert_eq!(counts, expected, "{name}");
        for out in ["out.mesh", "out.meshb"] {
            io::write_mesh(&folder.path(out), &mesh).unwrap();
            assert_eq!(io::read_mesh(&folder.path(out)).unwrap().content, mesh, "{name} by {out}");
        }
        if notices.is_empty() {
            assert!(fs::read(&path).unwrap() == fs::read(folder.path("out.meshb")).unwrap(), "{name}: other bytes");
        }
    }
}

#[test]
fn shared_solutions_come_out_as_they_went_in() {
    let folder = Folder::new();
    let cases = [
        ("cube/cube-linear-00.solb", 64, FieldKind::SymmetricTensor),
        ("hemisphere-cylinder/hsc-gmsh-26-adapt-mach.solb", 19140, FieldKind::Scalar),
        ("hemisphere-cylinder/hsc-gmsh-26-adapt-metric.solb", 19140, FieldKind::SymmetricTensor),
        ("onera-m6/onera_curvAdapt-mach.solb", 1544, FieldKind::Scalar),
        ("onera-m6/onera_curvAdapt-metric.solb", 1544, FieldKind::SymmetricTensor),
    ];
    for (name, vertices, kind) in cases {
        let Some(path) = shared_case(name) else { continue };
        let solution = io::read_solution(&path).unwrap().content;
        assert_eq!((solution.vertices, solution.fields.len(), solution.fields[0].kind), (vertices, 1, kind), "{name}");
        assert_eq!(solution.as_metric().map(|m| m.len()), (kind == FieldKind::SymmetricTensor).then_some(vertices));
        for out in ["out.sol", "out.solb"] {
            io::write_solution(&folder.path(out), &solution).unwrap();
            assert_eq!(io::read_solution(&folder.path(out)).unwrap().content, solution, "{name} by {out}");
        }
        assert!(fs::read(&path).unwrap() == fs::read(folder.path("out.solb")).unwrap(), "{name}: other bytes");
    }
}

/// A scalar, a vector, a symmetric tensor and a tensor at two vertices.
fn solution() -> (Vec<Section>, Solution) {
    let rows = [0.0, 100.0].map(|base| (0..19).map(|k| base + f64::from(k)).collect::<Vec<_>>());
    let mut section = section(62, "SolAtVertices", 0..19, &[&rows[0], &rows[1]]);
    section.fields = vec![1, 2, 3, 4];
    let field = |kind, range: std::ops::Range<usize>| SolutionField {
        kind,
        values: rows.iter().flat_map(|row| row[range.clone()].to_vec()).collect(),
    };
    let fields = vec![
        field(FieldKind::Scalar, 0..1),
        field(FieldKind::Vector, 1..4),
        field(FieldKind::SymmetricTensor, 4..10),
        field(FieldKind::Tensor, 10..19),
    ];
    (vec![section], Solution { vertices: 2, fields })
}

#[test]
fn a_solution_of_several_fields_reads_and_writes() {
    let folder = Folder::new();
    let (sections, solution) = solution();
    for version in 1..=4 {
        for big in [false, true] {
            let read = io::read_solution(&folder.file(binary(version, big, &sections))).unwrap();
            assert_eq!(read.content, solution, "version {version}, big {big}");
        }
    }
    assert_eq!(io::read_solution(&folder.file(ascii(&sections))).unwrap().content, solution);
    io::write_solution(&folder.path("out.solb"), &solution).unwrap();
    assert_eq!(fs::read(folder.path("out.solb")).unwrap(), binary(2, false, &sections));
    io::write_solution(&folder.path("out.sol"), &solution).unwrap();
    assert_eq!(io::read_solution(&folder.path("out.sol")).unwrap().content, solution);
}

#[test]
fn keywords_that_are_not_known_are_skipped_with_a_notice() {
    let folder = Folder::new();
    let mut more = sections();
    more.insert(1, section(33, "HexahedraQ2", 0..0, &[&[1.0, 2.0, 3.0, 4.0, 5.0, 1.0, 2.0, 3.0, 0.0]]));
    more.insert(3, section(7777, "FutureThings", 0..2, &[&[0.5, 0.5], &[-0.5, 2.0]]));
    more.push(section(126, "ByteFlow", 0..0, &[&[1.0], &[2.0]]));
    let text =
        ascii(&more).replace("\nEdges", "\nComments 2\nVertices 7 of the world\nEnd of comments\n# Tetrahedra\nEdges");
    for (bytes, places) in [
        (binary(2, false, &more), ["byte 172", "byte 256", "byte 632"]),
        (binary(3, true, &more), ["byte 180", "byte 272", "byte 692"]),
    ] {
        let read = folder.read(bytes);
        assert_eq!(read.content, mesh());
        let names = ["keyword 33", "keyword 7777", "ByteFlow (keyword 126)"];
        assert_eq!(read.notices.len(), 3);
        for ((notice, name), place) in read.notices.iter().zip(names).zip(places) {
            assert!(notice.contains(&format!("{place}: {name} is not read, skipped")), "{notice}");
        }
    }
    let read = folder.read(text);
    assert_eq!(read.content, mesh());
    let words: Vec<_> = read.notices.iter().map(|n| n.split(": ").skip(1).collect::<Vec<_>>().join(" ")).collect();
    let expected = ["line 13 'HexahedraQ2'", "line 17 'Comments'", "line 26 'FutureThings'", "line 77 'ByteFlow'"];
    assert_eq!(words, expected.map(|w| format!("{w} is not read, skipped")));
}

#[test]
fn the_ways_in_which_tools_differ_are_read() {
    let folder = Folder::new();
    let text = ascii(&sections());
    // blanks, line ends, comments, a byte order mark, Fortran's exponents, no newline at the end
    assert_eq!(folder.read(text.replace('\n', "\r\n")).content, mesh());
    assert_eq!(folder.read(text.replace(' ', "\t\t")).content, mesh());
    assert_eq!(folder.read(text.split_whitespace().collect::<Vec<_>>().join(" ")).content, mesh());
    assert_eq!(folder.read(text.replace('\n', " # Vertices 5\n")).content, mesh());
    assert_eq!(folder.read(format!("\u{feff}# by hand\n{text}")).content, mesh());
    assert_eq!(folder.read(text.replace("e0", "D+00")).content, mesh());
    assert_eq!(folder.read(text.trim_end()).content, mesh());
    // edges and triangles before the vertices that they name
    let mut turned = sections();
    turned.reverse();
    assert_eq!(folder.read(binary(2, false, &turned)).content, mesh());
    assert_eq!(folder.read(ascii(&turned)).content, mesh());
    // mmg's binary files end with the keyword End alone
    let bytes = binary(2, false, &sections());
    assert_eq!(folder.read(&bytes[..bytes.len() - 4]).content, mesh());
    // version 2 with reals of 32 bits, as libMeshb's GmfSetFloatPrecision writes it
    let mut short = sections();
    short.insert(0, section(155, "FloatingPointPrecision", 0..0, &[]));
    let mut bytes = binary(1, false, &short);
    bytes[4] = 2;
    bytes[28..32].copy_from_slice(&32_i32.to_le_bytes());
    assert_eq!(folder.read(bytes).content, mesh());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any finite reals and any references come back bit by bit from a text and from a binary file.
    #[test]
    fn round_trips_are_exact(
        vertices in prop::collection::vec((any::<[f64; 3]>(), any::<i32>()), 1..20),
        tensors in prop::collection::vec(any::<[f64; 6]>(), 1..20),
    ) {
        let finite = |x: f64| if x.is_finite() { x } else { f64::MIN_POSITIVE / 3.0 };
        let mesh = TetMesh {
            vertices: vertices.iter().map(|v| v.0.map(finite)).collect(),
            vertex_refs: vertices.iter().map(|v| v.1).collect(),
            ..TetMesh::default()
        };
        let metric = Solution::metric(&tensors.iter().map(|t| t.map(finite)).collect::<Vec<_>>());
        let folder = Folder::new();
        for (mesh_name, solution_name) in [("a.mesh", "a.sol"), ("a.meshb", "a.solb")] {
            let (mesh_path, solution_path) = (folder.path(mesh_name), folder.path(solution_name));
            io::write_mesh(&mesh_path, &mesh).unwrap();
            io::write_solution(&solution_path, &metric).unwrap();
            let read = io::read_mesh(&mesh_path).unwrap().content;
            prop_assert_eq!(bits(&read), bits(&mesh));
            prop_assert_eq!(read, mesh.clone());
            let read = io::read_solution(&solution_path).unwrap().content;
            let words = |s: &Solution| s.fields[0].values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(words(&read), words(&metric));
        }
    }
}
