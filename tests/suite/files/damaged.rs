//! Files that are wrong: one clear error each, which names the place; never a crash.

use super::libmeshb::{Section, Value, ascii, binary, section, sections};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::{self, FieldKind, Solution, SolutionField};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder with one file in it.
struct Case {
    _folder: tempfile::TempDir,
    path: PathBuf,
}

impl Case {
    fn new(bytes: impl AsRef<[u8]>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("in");
        fs::write(&path, bytes).unwrap();
        Self { _folder: folder, path }
    }
}

/// The error of reading a mesh, without the file's name in front.
fn error(bytes: impl AsRef<[u8]>) -> String {
    let case = Case::new(bytes);
    strip(&case.path, io::read_mesh(&case.path).expect_err("the file should be refused"))
}

/// The error of reading a solution, without the file's name in front.
fn solution_error(bytes: impl AsRef<[u8]>) -> String {
    let case = Case::new(bytes);
    strip(&case.path, io::read_solution(&case.path).expect_err("the file should be refused"))
}

fn strip(path: &Path, error: io::Error) -> String {
    let (text, name) = (error.to_string(), format!("{}: ", path.display()));
    text.strip_prefix(&name).unwrap_or_else(|| panic!("{text} does not name the file")).to_owned()
}

/// The mesh with one value replaced.
fn with(name: &str, row: usize, column: usize, value: Value) -> Vec<Section> {
    let mut sections = sections();
    sections.iter_mut().find(|s| s.name == name).unwrap().rows[row][column] = value;
    sections
}

/// The error of a mesh with one value replaced, as a text and as a binary file.
fn both(name: &str, row: usize, column: usize, value: Value) -> [String; 2] {
    let sections = with(name, row, column, value);
    [error(ascii(&sections)), error(binary(2, false, &sections))]
}

#[test]
fn an_index_out_of_range_is_named_with_its_entity() {
    for (index, shown) in [(0, "0"), (6, "6"), (-3, "-3"), (i32::MIN, "-2147483648")] {
        let [text, bytes] = both("Triangles", 1, 2, Value::Int(index.into()));
        let message = format!("index {shown} is out of range: the file has 5 Vertices, counted from 1");
        assert_eq!(text, format!("line 21, Triangles 2 of 3: {message}"));
        assert_eq!(bytes, format!("byte 244, Triangles 2 of 3: {message}"));
    }
    for name in ["Ridges", "RequiredEdges"] {
        for message in both(name, 0, 0, Value::Int(3)) {
            assert!(message.contains(&format!("{name} 1 of 1: index 3 is out of range: the file has 2 Edges")));
        }
    }
    for (name, row) in [("Corners", 1), ("RequiredVertices", 0), ("VerticesOnGeometricEdges", 0)] {
        for message in both(name, row, 0, Value::Int(9)) {
            assert!(message.contains(&format!("{name} {} of", row + 1)) && message.contains("has 5 Vertices"));
        }
    }
    let huge = binary(4, false, &with("Edges", 0, 0, Value::Int(i64::MIN)));
    assert!(error(huge).contains("Edges 1 of 2: index -9223372036854775808 is out of range"));
}

#[test]
fn a_value_that_is_not_finite_is_refused() {
    for (value, word) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (f64::NEG_INFINITY, "-inf")] {
        let [text, bytes] = both("Vertices", 2, 1, Value::Real(value));
        assert_eq!(text, format!("line 9, Vertices 3 of 5: a finite number is expected, not '{word}'"));
        assert_eq!(bytes, format!("byte 96, Vertices 3 of 5: {word} is not a finite number"));
        let [text, bytes] = both("VerticesOnGeometricTriangles", 1, 3, Value::Real(value));
        assert!(text.contains("VerticesOnGeometricTriangles 2 of 2: a finite number is expected"));
        assert!(bytes.contains("VerticesOnGeometricTriangles 2 of 2: "));
    }
    for word in ["nan(ind)", "-nan", "Infinity", "1e999", "x", "1.0.0", "0x10", "--1", "é"] {
        let text = ascii(&sections()).replacen("1.25e0", word, 1);
        let message = error(text);
        assert!(message.starts_with("line 9, Vertices 3 of 5: "), "{word}: {message}");
    }
}

#[test]
fn a_reference_that_does_not_fit_is_refused() {
    let big = Value::Int(1 << 40);
    let message = "Tetrahedra 1 of 2: reference 1099511627776 does not fit 32 bits; renumber the references";
    assert!(error(ascii(&with("Tetrahedra", 0, 4, big))).ends_with(message));
    assert!(error(binary(4, true, &with("Tetrahedra", 0, 4, big))).ends_with(message));
    let text = ascii(&sections()).replacen("7 \n", "99999999999999999999 \n", 1);
    assert!(error(text).contains("Edges 1 of 2: a whole number is expected, not '99999999999999999999'"));
    let text = ascii(&sections()).replacen("7 \n", "7.0 \n", 1);
    assert!(error(text).contains("Edges 1 of 2: a whole number is expected, not '7.0'"));
}

#[test]
fn a_count_that_lies_is_refused_without_its_memory() {
    let text = ascii(&sections());
    for count in ["6", "1000000000000", "9223372036854775807"] {
        let message = error(text.replacen("Vertices\n5", &format!("Vertices\n{count}"), 1));
        assert_eq!(
            message,
            format!(
                "line 13, Vertices 6 of {count}: the list ends here, before its count is reached; correct the count or the list"
            )
        );
    }
    let message = error(text.replacen("Vertices\n5", "Vertices\n4", 1));
    assert_eq!(message, "line 11, Vertices: '1e0' follows when the count is reached; correct the count or the list");
    assert!(error(text.replacen("Vertices\n5", "Vertices\n-5", 1)).contains("the count says -5"));
    assert!(
        error(text.replacen("Vertices\n5", "Vertices\nfive", 1)).contains("a whole number is expected, not 'five'")
    );
    for count in [4, 6, -1, i32::MAX, i32::MIN] {
        let mut bytes = binary(2, false, &sections());
        bytes[28..32].copy_from_slice(&count.to_le_bytes());
        let expected =
            format!("byte 28, Vertices: the count says {count}, but there are 5: the file is damaged, write it again");
        assert_eq!(error(bytes), expected);
    }
    let mut bytes = binary(4, false, &sections());
    bytes[36..44].copy_from_slice(&i64::MAX.to_le_bytes());
    assert!(error(bytes).contains("the count says 9223372036854775807, but there are 5"));
}

#[test]
fn a_chain_of_keywords_that_leads_nowhere_is_refused() {
    // the position behind Vertices' keyword
    let next = |value: i32| {
        let mut bytes = binary(2, false, &sections());
        bytes[24..28].copy_from_slice(&value.to_le_bytes());
        error(bytes)
    };
    assert!(next(20).contains("byte 20, Vertices (keyword 4): the next keyword is said to be at byte 20, before this"));
    assert!(next(8).contains("at byte 8, before this one's end"));
    assert!(next(-5).contains("at byte -5, before this one's end"));
    assert!(next(100_000).contains("at byte 100000, but the file has"));
    assert!(next(0).contains("no next keyword and no End"));
    assert!(next(30).contains("the next keyword follows before the count") || next(30).contains("keyword"));
}

#[test]
fn every_file_that_was_cut_is_refused() {
    let text = ascii(&sections());
    for end in 0..text.trim_end().len() {
        let message = error(&text[..end]);
        assert!(end < 30 || message.starts_with("line "), "{message}");
    }
    for version in 1..=4 {
        let bytes = binary(version, version % 2 == 0, &sections());
        let whole = bytes.len() - if version < 3 { 4 } else { 8 }; // End needs no position
        for end in 0..whole {
            error(&bytes[..end]);
        }
    }
}

#[test]
fn a_file_of_another_kind_is_refused() {
    assert_eq!(error(""), "byte 0: the file is empty; a mesh or solution file is expected");
    for bytes in [&b"ISO-10303-21;"[..], b"\0\0\0\0\0\0\0\0", b"\x7fELF\x02", b"Vertices 3", b" \n ", b"\x01\0"] {
        assert!(error(bytes).starts_with("start of the file: no mesh or solution file of libMeshb"));
    }
    for version in [0, 5, -1] {
        let text = ascii(&sections()).replacen("Formatted 2", &format!("Formatted {version}"), 1);
        assert_eq!(error(text), format!("line 1, MeshVersionFormatted: version {version} is not known; 1 to 4 are"));
        let bytes = binary(version, false, &sections());
        assert_eq!(error(bytes), format!("byte 4, version: version {version} is not known; 1 to 4 are"));
    }
    let flat = ascii(&sections()).replacen("Dimension\n3", "Dimension\n2", 1);
    assert!(error(flat).contains("dimension 2 is not supported; give a mesh in 3D"));
    let mut flat = binary(2, false, &sections());
    flat[16] = 2;
    assert!(error(flat).contains("dimension 2 is not supported; give a mesh in 3D"));
    // As programs write it: with two coordinates a vertex.
    let mut flat = binary(2, false, &[section(4, "Vertices", 0..2, &[&[0.0, 0.0, 1.0], &[1.0, 0.0, 1.0]])]);
    flat[16] = 2;
    assert!(error(flat).contains("dimension 2 is not supported; give a mesh in 3D"));
    assert!(error(ascii(&sections()).replacen("Dimension\n3", "", 1)).contains("'Dimension 3' is expected"));
    for bytes in [ascii(&sections()[1..1]).into_bytes(), binary(2, false, &[]), binary(2, false, &solution(2.0))] {
        assert!(error(bytes).contains("no Vertices: a mesh is expected"));
    }
    assert!(error(ascii(&[section(4, "Vertices", 0..3, &[])])).contains("no Vertices"));
    assert!(solution_error(ascii(&sections())).contains("no SolAtVertices"));
    assert!(solution_error(binary(2, false, &sections())).contains("no SolAtVertices"));
}

#[test]
fn what_follows_the_end_or_comes_twice_is_refused() {
    assert!(error(ascii(&sections()) + "7").ends_with("line 65, End: '7' follows the end; cut it off"));
    let mut bytes = binary(2, false, &sections());
    bytes.extend([0; 9]);
    assert!(error(bytes).ends_with("9 bytes follow the end; cut them off"));
    let mut twice = sections();
    twice.push(twice[1].clone());
    for message in [error(ascii(&twice)), error(binary(2, true, &twice))] {
        assert!(message.ends_with("Edges: the keyword comes a second time; join the two into one list"));
    }
}

/// A metric at two vertices, with one value.
fn solution(value: f64) -> Vec<Section> {
    let mut section = section(62, "SolAtVertices", 0..6, &[&[value, 0.0, 2.0, 0.0, 0.0, 2.0], &[2.0; 6]]);
    section.fields = vec![3];
    vec![section]
}

#[test]
fn a_solution_with_wrong_values_is_refused() {
    let text = ascii(&solution(2.0));
    let message =
        "line 7, SolAtVertices: field type 9 is not known; 1 scalar, 2 vector, 3 symmetric tensor, 4 tensor are";
    assert_eq!(solution_error(text.replacen("1 3\n", "1 9\n", 1)), message);
    assert!(solution_error(text.replacen("1 3\n", "0\n", 1)).contains("0 fields; at least 1 is expected"));
    assert!(solution_error(text.replacen("1 3\n", "1 4\n", 1)).contains("SolAtVertices 2 of 2: the list ends here"));
    assert!(solution_error(text.replacen("1 3\n", "1 2\n", 1)).contains("follows when the count is reached"));
    assert!(solution_error(text.replacen("1 3\n", "999999999 3\n", 1)).contains("SolAtVertices: "));
    assert!(solution_error(ascii(&solution(f64::NAN))).contains("line 8, SolAtVertices 1 of 2: a finite number"));
    assert!(solution_error(binary(3, true, &solution(f64::NAN))).contains("SolAtVertices 1 of 2: NaN is not a finite"));
    for fields in [0, -1, 30, i32::MAX] {
        let mut bytes = binary(2, false, &solution(2.0));
        bytes[32..36].copy_from_slice(&fields.to_le_bytes());
        assert!(solution_error(bytes).starts_with("byte 32, SolAtVertices: "));
    }
    let mut bytes = binary(2, false, &solution(2.0));
    bytes[36] = 1;
    assert!(solution_error(bytes).contains("the count says 2, but there are 12"));
    for end in 0..text.trim_end().len() {
        solution_error(&text[..end]);
    }
}

#[test]
fn what_could_not_be_read_again_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let case = Case::new(ascii(&sections()));
    let mesh = io::read_mesh(&case.path).unwrap().content;
    let refused = |change: fn(&mut TetMesh)| {
        let (mut mesh, path) = (mesh.clone(), folder.path().join("out.mesh"));
        change(&mut mesh);
        let message = strip(&path, io::write_mesh(&path, &mesh).expect_err("the mesh should be refused"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "something was written");
        message
    };
    assert!(refused(|m| m.vertices[1][2] = f64::NAN).starts_with("Vertices 2: a value is not a finite number"));
    assert!(refused(|m| m.tets.nodes[1][0] = 5).starts_with("Tetrahedra 2: an index is out of range: 5 are there"));
    assert!(refused(|m| m.ridges[0] = 2).starts_with("Ridges 1: an index is out of range: 2 are there"));
    assert!(refused(|m| m.required_triangles[1] = 3).starts_with("RequiredTriangles 2: an index is out of range"));
    assert!(refused(|m| m.triangles.refs.push(1)).starts_with("Triangles: 4 references for 3 entities"));
    assert!(refused(|m| m.vertex_refs.clear()).starts_with("Vertices: 0 references for 5 entities"));
    assert!(refused(|m| m.association.faces[0].uv[1] = f64::INFINITY).starts_with("VerticesOnGeometricTriangles 1: "));
    assert!(refused(|m| *m = TetMesh::default()).starts_with("Vertices: the mesh has no vertices"));
    let field = SolutionField { kind: FieldKind::Vector, values: vec![0.0; 5] };
    let path = folder.path().join("out.solb");
    let error = io::write_solution(&path, &Solution { vertices: 2, fields: vec![field] }).unwrap_err();
    assert_eq!(strip(&path, error), "SolAtVertices, field 1: 5 values; 3 at each of 2 vertices are expected");
    assert!(io::write_solution(&path, &Solution::default()).is_err());
}

#[test]
fn an_extension_that_is_not_known_is_refused_on_writing() {
    let folder = tempfile::tempdir().unwrap();
    let case = Case::new(ascii(&sections()));
    let mesh = io::read_mesh(&case.path).unwrap().content;
    for name in ["out.vtk", "out", "out.sol", "out.meshbb"] {
        let path = folder.path().join(name);
        let message = strip(&path, io::write_mesh(&path, &mesh).unwrap_err());
        assert!(message.ends_with("give a name that ends in .mesh (text) or .meshb (binary)"), "{message}");
    }
    let path = folder.path().join("out.mesh");
    assert!(strip(&path, io::write_solution(&path, &Solution::metric(&[[1.0; 6]])).unwrap_err()).contains(".solb"));
    let missing = io::read_mesh(&folder.path().join("none.mesh")).unwrap_err();
    assert!(missing.to_string().contains("none.mesh: No such file"));
}

/// Bytes of a valid file, changed at places and cut or lengthened.
fn damage(valid: &[u8], changes: &[(prop::sample::Index, u8)], cut: Option<prop::sample::Index>) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for (at, value) in changes {
        let at = at.index(bytes.len());
        bytes[at] = *value;
    }
    if let Some(cut) = cut {
        bytes.truncate(cut.index(bytes.len()));
    }
    bytes
}

/// Bytes that are likely to hit what the reader looks at.
fn telling() -> impl Strategy<Value = u8> {
    prop_oneof![any::<u8>(), prop::sample::select(&b"\0\x01\x03\x04\x05\x06\x3e\x36\x7f\x80\xff 019-.eEn#\nV"[..])]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Whatever the bytes: a mesh with all indices in range, or an error; never a panic.
    #[test]
    fn no_bytes_make_the_reader_panic(
        version in 1..=4,
        kind in 0..4,
        changes in prop::collection::vec((any::<prop::sample::Index>(), telling()), 0..6),
        cut in prop::option::weighted(0.3, any::<prop::sample::Index>()),
    ) {
        let valid = match kind {
            0 => ascii(&sections()).into_bytes(),
            1 => ascii(&solution(2.0)).into_bytes(),
            2 => binary(version, version % 2 == 1, &sections()),
            _ => binary(version, version % 2 == 0, &solution(2.0)),
        };
        let case = Case::new(damage(&valid, &changes, cut));
        if let Ok(read) = io::read_mesh(&case.path) {
            // the writer checks every index and every number
            let out = case.path.with_extension("meshb");
            io::write_mesh(&out, &read.content).unwrap();
            prop_assert_eq!(io::read_mesh(&out).unwrap().content, read.content);
        }
        if let Ok(read) = io::read_solution(&case.path) {
            let out = case.path.with_extension("sol");
            io::write_solution(&out, &read.content).unwrap();
            prop_assert_eq!(io::read_solution(&out).unwrap().content, read.content);
        }
    }

    /// The same for bytes that have nothing of a file but its beginning.
    #[test]
    fn no_noise_makes_the_reader_panic(
        start in prop::sample::select(vec![
            &b"MeshVersionFormatted 2 Dimension 3 Vertices"[..],
            b"\x01\0\0\0\x02\0\0\0\x03\0\0\0\x14\0\0\0\x03\0\0\0",
            b"",
        ]),
        noise in prop::collection::vec(telling(), 0..200),
    ) {
        let case = Case::new([start, &noise].concat());
        let _ = (io::read_mesh(&case.path), io::read_solution(&case.path));
    }
}
