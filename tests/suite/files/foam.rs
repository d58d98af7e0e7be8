//! Cases of OpenFOAM: what we write comes back and passes OpenFOAM's own checks, what it writes is read.
use geo_adapt::formats::{Dataset, NamedField, foam};
use geo_adapt::geometry::{Label, Names};
use geo_adapt::mesh::TetMesh;
use geo_adapt::mesh::io::FieldKind;
use geo_adapt::mesh::samples::cube;
use geo_adapt::mesh::vector::volume6;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A cube of two regions with triangles between them, names that OpenFOAM would not take, and a field of each kind.
fn data() -> Dataset {
    let mut mesh = cube(3);
    for tet in 0..mesh.tets.len() {
        let middle: f64 = mesh.tets.nodes[tet].iter().map(|&v| mesh.vertices[v as usize][0]).sum::<f64>() / 4.0;
        mesh.tets.refs[tet] = if middle < 1.0 / 3.0 { 4 } else { 9 };
    }
    let between: Vec<[u32; 3]> = faces_at(&mesh, 1.0 / 3.0);
    assert_eq!(between.len(), 18);
    between.into_iter().for_each(|nodes| mesh.triangles.push(nodes, 30));
    let label = |name: &str| Label { name: Some(name.to_owned()), colour: None };
    let mut names = Names::default();
    names.triangles.extend([
        (1, label("inlet")),
        (2, label("far field/1")),
        (3, label("wall")),
        (5, label("wall")),
        (30, label("between")),
    ]);
    names.tetrahedra.extend([(9, label("steel (hot)"))]);
    let of = |name: &str, kind: FieldKind, f: &dyn Fn(f64, usize) -> f64| {
        let values =
            mesh.vertices.iter().flat_map(|p| (0..kind.values()).map(|k| f(p[0] + 2.0 * p[1], k)).collect::<Vec<_>>());
        NamedField { name: name.to_owned(), kind, values: values.collect() }
    };
    let fields = vec![
        of("T", FieldKind::Scalar, &|_, _| 2.5),
        of("U", FieldKind::Vector, &|x, k| x + k as f64),
        of("metric", FieldKind::SymmetricTensor, &|_, k| k as f64),
        of("p", FieldKind::Scalar, &|x, _| x),
    ];
    Dataset { mesh, names, fields, ..Dataset::default() }
}

/// The faces of tetrahedra in the plane of that x, each once.
fn faces_at(mesh: &TetMesh, x: f64) -> Vec<[u32; 3]> {
    let inside = |v: u32| (mesh.vertices[v as usize][0] - x).abs() < 1e-9;
    let mut found: Vec<[u32; 3]> = Vec::new();
    for nodes in &mesh.tets.nodes {
        let mut on: Vec<u32> = nodes.iter().copied().filter(|&v| inside(v)).collect();
        on.sort_unstable();
        if let [a, b, c] = on[..] {
            found.push([a, b, c]);
        }
    }
    found.sort_unstable();
    found.dedup();
    found
}

fn sorted<const N: usize>(elements: impl Iterator<Item = ([u32; N], i32)>) -> Vec<([u32; N], i32)> {
    let mut all: Vec<_> = elements
        .map(|(mut nodes, reference)| {
            nodes.sort_unstable();
            (nodes, reference)
        })
        .collect();
    all.sort_unstable();
    all
}

/// The same vertices, tetrahedra in the same order, the same triangles and references; all tetrahedra positive.
fn assert_same(found: &TetMesh, wanted: &TetMesh) {
    assert_eq!(found.vertices, wanted.vertices);
    assert_eq!(sorted(found.triangles.iter()), sorted(wanted.triangles.iter()));
    for ((found, wanted), k) in found.tets.iter().zip(wanted.tets.iter()).zip(0..) {
        let sorted = |mut nodes: [u32; 4]| {
            nodes.sort_unstable();
            nodes
        };
        assert_eq!((sorted(found.0), found.1), (sorted(wanted.0), wanted.1), "tetrahedron {k}");
    }
    assert_eq!(found.tets.len(), wanted.tets.len());
    for nodes in &found.tets.nodes {
        let [a, b, c, d] = nodes.map(|v| found.vertices[v as usize]);
        assert!(volume6(a, b, c, d) > 0.0);
    }
}

#[test]
fn a_case_comes_back_from_text_and_from_bytes() {
    let data = data();
    for text in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let case = folder.path().join("case");
        assert!(!foam::is_case(&case));
        let notices = foam::write(&case, &data, text).unwrap();
        assert!(notices.is_empty(), "{notices:?}");
        assert!(foam::is_case(&case) && foam::is_case(&case.join("constant/polyMesh")));
        let found = foam::read(&case).unwrap();
        assert!(found.notices.is_empty());
        let found = found.content;
        assert_same(&found.mesh, &data.mesh);
        assert_eq!(found.names, data.names);
        let named =
            |fields: &[NamedField]| fields.iter().map(|f| (f.name.clone(), f.kind, f.values.len())).collect::<Vec<_>>();
        assert_eq!(named(&found.fields), named(&data.fields));
        for k in [0, 2] {
            let pairs = found.fields[k].values.iter().zip(&data.fields[k].values);
            assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12), "{}", data.fields[k].name);
        }
        // A linear field: averaged twice, it keeps its values within a cell's extent, and its mean.
        let (p, wanted) = (&found.fields[3].values, &data.fields[3].values);
        assert!(p.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.7));
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean(p) - mean(wanted)).abs() < 0.02);
    }
}

#[test]
fn a_name_of_several_references_is_one_patch() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    foam::write(&case, &data(), true).unwrap();
    let boundary = fs::read_to_string(case.join("constant/polyMesh/boundary")).unwrap();
    let lines: Vec<&str> = boundary.lines().map(str::trim).collect();
    assert_eq!(lines.iter().filter(|line| line.starts_with("wall")).count(), 1, "{boundary}");
    assert!(lines.contains(&"parts (3 18 5 18);") && lines.contains(&"nFaces 36;"), "{boundary}");
}

#[test]
fn a_plain_mesh_has_no_zones_and_an_old_one_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("case");
    foam::write(&case, &data(), true).unwrap();
    let plain = Dataset { mesh: cube(2), ..Dataset::default() };
    fs::write(case.join("constant/polyMesh/owner.gz"), "old").unwrap();
    foam::write(&case, &plain, true).unwrap();
    assert!(!case.join("constant/polyMesh/cellZones").exists() && !case.join("constant/polyMesh/owner.gz").exists());
    let Dataset { mesh, names, .. } = foam::read_mesh(&case).unwrap();
    assert_same(&mesh, &plain.mesh);
    assert!(names.is_empty());
}

#[test]
fn packed_files_are_read() {
    let data = data();
    let folder = tempfile::tempdir().unwrap();
    foam::write(folder.path(), &data, false).unwrap();
    for name in ["constant/polyMesh/points", "constant/polyMesh/faces", "constant/polyMesh/owner", "0/p"] {
        let path = folder.path().join(name);
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut packer, &fs::read(&path).unwrap()).unwrap();
        fs::write(path.with_extension("gz"), packer.finish().unwrap()).unwrap();
        fs::remove_file(path).unwrap();
    }
    let found = foam::read(folder.path()).unwrap().content;
    assert_same(&found.mesh, &data.mesh);
    assert_eq!(found.fields[3].name, "p");
}

#[test]
fn what_cannot_be_carried_or_written_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut data = data();
    data.mesh.edges.push([0, 1], 3);
    data.mesh.corners.push(0);
    let poly_mesh = folder.path().join("constant/polyMesh");
    let notices = foam::write(&poly_mesh, &data, true).unwrap();
    assert!(
        notices[0].contains("no place for edges, corners") && notices[1].contains("a polyMesh has no fields"),
        "{notices:?}"
    );
    assert!(!folder.path().join("0").exists());
    data.mesh.triangles.nodes.swap_remove(0);
    data.mesh.triangles.refs.swap_remove(0);
    let error = foam::write(folder.path(), &data, true).unwrap_err().to_string();
    assert!(error.contains("has no neighbour and no triangle"), "{error}");
}

#[test]
fn cells_that_are_no_tetrahedra_are_named() {
    let folder = tempfile::tempdir().unwrap();
    foam::write(folder.path(), &Dataset { mesh: cube(1), ..Dataset::default() }, true).unwrap();
    let poly_mesh = folder.path().join("constant/polyMesh");
    let message = |name: &str, from: &str, to: &str| {
        let path = poly_mesh.join(name);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{name} has no {from}: {text}");
        fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let error = foam::read(folder.path()).unwrap_err().to_string();
        fs::write(&path, text).unwrap();
        error
    };
    assert!(message("faces", "3(", "5(7 6 ").contains("has 5 points: only tetrahedra, prisms"));
    assert!(message("faces", "3(", "4(7 ").contains("cell "));
    assert!(message("faces", "3(0", "3(99").contains("there are 8 points"));
    assert!(message("faces", "3(0", "3(5").contains("cell "));
    assert!(message("owner", "\n5\n)", "\n0\n)").contains("only"));
    assert!(message("owner", "\n18\n(", "\n17\n(").contains("a list of 18 should stand here"));
    assert!(message("boundary", "startFace 6", "startFace 2").contains("which lies inside"));
    assert!(message("boundary", "nFaces 2", "nFaces 99").contains("but there are 18 faces"));
    fs::remove_file(poly_mesh.join("owner")).unwrap();
    let missing = foam::read(folder.path()).unwrap_err().to_string();
    assert!(missing.contains("polyMesh/owner: "), "{missing}");
}

/// Runs a program of OpenFOAM on a case; its output, or none where it is not installed and not promised by the set-up.
fn openfoam(case: &Path, words: &[&str]) -> Option<String> {
    let rc = ["/usr/share/openfoam/etc/bashrc"].into_iter().find(|path| Path::new(path).is_file());
    let script = format!("source {} >/dev/null 2>&1; cd \"$0\" && exec \"$@\"", rc.unwrap_or("/dev/null"));
    let output = Command::new("bash").args(["-c", &script]).arg(case).args(words).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(127) {
        assert!(std::env::var_os("GEO_ADAPT_OPENFOAM").is_none(), "OpenFOAM was set up, but: {text}");
        eprintln!("skipped: {} is not there (Debian's package openfoam)", words[0]);
        return None;
    }
    assert!(output.status.success(), "{words:?}: {text}");
    Some(text)
}

#[test]
fn openfoam_finds_nothing_wrong_with_what_we_write() {
    for text in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        foam::write(folder.path(), &data(), text).unwrap();
        let Some(said) = openfoam(folder.path(), &["checkMesh", "-allTopology"]) else { return };
        assert!(said.contains("Mesh OK."), "{said}");
        assert!(said.contains("Upper triangular ordering OK") && said.contains("cells:            162"), "{said}");
    }
}

#[test]
fn what_openfoam_writes_itself_is_read() {
    let data = data();
    let folder = tempfile::tempdir().unwrap();
    foam::write(folder.path(), &data, true).unwrap();
    let control = folder.path().join("system/controlDict");
    for [format, compression] in [["binary", "off"], ["ascii", "on"], ["ascii", "off"]] {
        let head = "FoamFile { version 2.0; format ascii; class dictionary; object controlDict; }\n";
        let rest =
            "application none; startFrom startTime; startTime 0; stopAt endTime; endTime 0; deltaT 1; writeInterval 1;";
        fs::write(
            &control,
            format!("{head}{rest} writeFormat {format}; writeCompression {compression}; writePrecision 17;\n"),
        )
        .unwrap();
        if openfoam(folder.path(), &["foamFormatConvert"]).is_none() {
            return;
        }
        assert_eq!(folder.path().join("constant/polyMesh/points.gz").is_file(), compression == "on");
        let found = foam::read(folder.path()).unwrap().content;
        assert_same(&found.mesh, &data.mesh);
        assert_eq!(found.fields.len(), 4, "{format} {compression}");
        assert!(found.fields[0].values.iter().all(|value| (value - 2.5).abs() < 1e-12));
        // OpenFOAM keeps the entries that are ours.
        assert_eq!(found.names, data.names);
    }
}

#[test]
fn a_mesh_made_by_openfoam_is_read() {
    let folder = tempfile::tempdir().unwrap();
    foam::write(folder.path(), &Dataset { mesh: cube(1), ..Dataset::default() }, true).unwrap();
    // A tetrahedron of gmsh's old format, its four faces on two surfaces.
    let msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n5\n\
        1 2 2 5 5 1 3 2\n2 2 2 5 5 1 2 4\n3 2 2 6 6 2 3 4\n4 2 2 6 6 1 4 3\n5 4 2 7 7 1 2 3 4\n$EndElements\n";
    fs::write(folder.path().join("a.msh"), msh).unwrap();
    if openfoam(folder.path(), &["gmshToFoam", "a.msh"]).is_none() {
        return;
    }
    let found = foam::read(folder.path()).unwrap().content;
    assert_eq!((found.mesh.vertices.len(), found.mesh.tets.len(), found.mesh.triangles.len()), (4, 1, 4));
    let [a, b, c, d] = found.mesh.tets.nodes[0].map(|v| found.mesh.vertices[v as usize]);
    assert!(volume6(a, b, c, d) > 0.0);
    assert_eq!(found.names.triangles.len(), 2);
}

#[test]
fn convert_writes_and_reads_cases() {
    let folder = tempfile::tempdir().unwrap();
    let data = data();
    let [first, case, back] = ["first.meshb", "case/", "back.meshb"].map(|name| folder.path().join(name));
    geo_adapt::formats::write(&first, &data).unwrap();
    let convert = |from: &Path, to: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_geo-adapt")).arg("convert").args([from, to]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    convert(&first, &case);
    assert!(foam::is_case(&case));
    convert(&case, &back);
    let found = geo_adapt::formats::read(&back).unwrap().content;
    assert_same(&found.mesh, &data.mesh);
    assert_eq!(found.names, data.names);
    assert_eq!(found.fields.iter().map(|field| &field.name[..]).collect::<Vec<_>>(), ["T", "U", "metric", "p"]);
    let unknown = folder.path().join("case-without-slash");
    let output =
        Command::new(env!("CARGO_BIN_EXE_geo-adapt")).arg("convert").args([&first, &unknown]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("a new one is named with a / at its end"));
}
