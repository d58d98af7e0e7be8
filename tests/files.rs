//! Mesh and solution files: what is read comes out again, and what is wrong is one clear error.
mod common;
#[path = "common/libmeshb.rs"]
mod libmeshb;

use common::shared_case;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use geo_adapt::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use libmeshb::{Section, Value, ascii, binary, section};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Two tetrahedra with everything that a mesh file carries.
fn sections() -> Vec<Section> {
    vec![
        section(
            4,
            "Vertices",
            0..3,
            &[
                &[0.0, 0.0, 0.0, 1.0],
                &[1.5, 0.0, -0.0, 2.0],
                &[0.0, 1.25, 0.0, 3.0],
                &[0.0, 0.0, 1.0, -4.0],
                &[1.0, 1.0, 0.375, 5.0],
            ],
        ),
        section(5, "Edges", 0..0, &[&[1.0, 2.0, 7.0], &[2.0, 3.0, 8.0]]),
        section(6, "Triangles", 0..0, &[&[1.0, 3.0, 2.0, 1.0], &[1.0, 2.0, 4.0, 2.0], &[2.0, 3.0, 5.0, 3.0]]),
        section(8, "Tetrahedra", 0..0, &[&[1.0, 2.0, 3.0, 4.0, 1.0], &[2.0, 3.0, 4.0, 5.0, 2.0]]),
        section(13, "Corners", 0..0, &[&[1.0], &[5.0]]),
        section(14, "Ridges", 0..0, &[&[2.0]]),
        section(15, "RequiredVertices", 0..0, &[&[3.0]]),
        section(16, "RequiredEdges", 0..0, &[&[1.0]]),
        section(17, "RequiredTriangles", 0..0, &[&[3.0], &[1.0]]),
        section(40, "VerticesOnGeometricVertices", 0..0, &[&[1.0, 9.0]]),
        section(41, "VerticesOnGeometricEdges", 2..4, &[&[2.0, 4.0, 0.5, 1.0]]),
        section(42, "VerticesOnGeometricTriangles", 2..5, &[&[3.0, 6.0, 0.25, -2.0, 0.0], &[2.0, 7.0, 1.0, 2.0, 3.0]]),
    ]
}

/// The same as arrays. All reals are exact in 32 bits, so that version 1 holds them, too.
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

    /// The error of reading a mesh, without the file's name in front.
    fn error(&self, bytes: impl AsRef<[u8]>) -> String {
        let path = self.file(bytes);
        strip(&path, io::read_mesh(&path).expect_err("the file should be refused"))
    }

    /// The error of reading a solution, without the file's name in front.
    fn solution_error(&self, bytes: impl AsRef<[u8]>) -> String {
        let path = self.file(bytes);
        strip(&path, io::read_solution(&path).expect_err("the file should be refused"))
    }
}

fn strip(path: &Path, error: io::Error) -> String {
    let (text, name) = (error.to_string(), format!("{}: ", path.display()));
    text.strip_prefix(&name).unwrap_or_else(|| panic!("{text} does not name the file")).to_owned()
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
