use super::super::layout::{Framed, frame, version};
use super::super::read::{mesh_from, solution_from};
use super::super::rows::{Slice, sections};
use super::super::{Batch, FieldKind, MeshCounts, Solution, SolutionField, write_mesh, write_solution};
use super::*;
use crate::mesh::samples::cube;
use crate::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use crate::tasks::{GRAIN, Plan, Pool, Team};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// A mesh with rows of every kind, of several blocks where there are many.
fn mesh() -> TetMesh {
    let mut mesh = cube(16);
    assert!(mesh.vertices.len() > GRAIN && mesh.tets.len() > 5 * GRAIN);
    mesh.vertex_refs = (0..mesh.vertices.len() as i32).map(|v| v % 7 - 3).collect();
    (0..GRAIN as u32 + 5).for_each(|e| mesh.edges.push([e % 4000, e % 4000 + 1], e as i32));
    (mesh.corners, mesh.ridges, mesh.required_vertices) = (vec![4, 2], vec![9, 0, 8], vec![0]);
    (mesh.required_edges, mesh.required_triangles) = (vec![3, 1], vec![5]);
    mesh.association.vertices.push(OnVertex { vertex: 2, id: 8 });
    mesh.association.edges.push(OnEdge { vertex: 3, id: -1, t: 0.3, r: 1e-300 });
    mesh.association.faces = (0..50).map(|v| OnFace { vertex: v, id: 5, uv: [-0.25, f64::from(v)], r: 0.0 }).collect();
    mesh
}

fn slices(mesh: &TetMesh) -> [Slice<'_>; 12] {
    let on = &mesh.association;
    [
        Slice::OnFaces(&on.faces),
        Slice::Tets(&mesh.tets.nodes, &mesh.tets.refs),
        Slice::Edges(&mesh.edges.nodes, &mesh.edges.refs),
        Slice::Triangles(&mesh.triangles.nodes, &mesh.triangles.refs),
        Slice::Vertices(&mesh.vertices, &mesh.vertex_refs),
        Slice::Corners(&mesh.corners),
        Slice::Ridges(&mesh.ridges),
        Slice::RequiredVertices(&mesh.required_vertices),
        Slice::RequiredEdges(&mesh.required_edges),
        Slice::RequiredTriangles(&mesh.required_triangles),
        Slice::OnVertices(&on.vertices),
        Slice::OnEdges(&on.edges),
    ]
}

fn created(path: &Path) -> File {
    File::options().read(true).write(true).create_new(true).open(path).unwrap()
}

/// Bytes of a mesh in memory by the writer of slices.
fn whole(path: &Path, mesh: &TetMesh) -> Vec<u8> {
    let writer = MeshWriter::create(created(path), path, &MeshCounts::of(mesh)).unwrap();
    slices(mesh).into_iter().for_each(|slice| writer.put(Team::alone(), 0, slice).unwrap());
    writer.finish().unwrap();
    fs::read(path).unwrap()
}

#[test]
fn a_mesh_by_slices_has_the_bytes_of_the_whole() {
    let (mesh, folder) = (mesh(), tempfile::tempdir().unwrap());
    let path = |name: &str| folder.path().join(name);
    write_mesh(&path("whole.meshb"), &mesh).unwrap();
    let expected = fs::read(path("whole.meshb")).unwrap();
    assert!(whole(&path("once.meshb"), &mesh) == expected);
    // Tetrahedra and vertices in pieces, back to front, from several threads at once.
    let sliced = path("sliced.meshb");
    let mut batch = Batch::new();
    let writer = MeshWriter::create(batch.open(&sliced, true).unwrap(), &sliced, &MeshCounts::of(&mesh)).unwrap();
    let (pool, pieces) = (Pool::new(3).unwrap(), 7);
    let cut = |n: usize, k: usize| n * k / pieces..n * (k + 1) / pieces;
    std::thread::scope(|scope| {
        for k in (0..pieces).rev() {
            let (writer, mesh, team) = (&writer, &mesh, Team::new(&pool, Plan::default()));
            scope.spawn(move || {
                let tets = cut(mesh.tets.len(), k);
                let slice = Slice::Tets(&mesh.tets.nodes[tets.clone()], &mesh.tets.refs[tets.clone()]);
                writer.put(team, tets.start, slice).unwrap();
                let points = cut(mesh.vertices.len(), k);
                let slice = Slice::Vertices(&mesh.vertices[points.clone()], &mesh.vertex_refs[points.clone()]);
                writer.put(team, points.start, slice).unwrap();
            });
        }
    });
    let others = slices(&mesh).into_iter().filter(|s| !matches!(s, Slice::Tets(..) | Slice::Vertices(..)));
    others.for_each(|slice| writer.put(Team::alone(), 0, slice).unwrap());
    writer.finish().unwrap();
    assert!(!sliced.exists());
    batch.commit().unwrap();
    assert!(fs::read(&sliced).unwrap() == expected);
    // Empty sections are left out, here as there.
    let small = TetMesh { vertices: vec![[0.5, 0.0, -2.0]], vertex_refs: vec![3], ..Default::default() };
    write_mesh(&path("whole.meshb"), &small).unwrap();
    assert_eq!(whole(&path("small.meshb"), &small), fs::read(path("whole.meshb")).unwrap());
}

/// Two writers of one file, as two processes have them.
#[test]
fn who_joins_writes_rows_of_the_same_file() {
    let (mesh, folder) = (mesh(), tempfile::tempdir().unwrap());
    let path = |name: &str| folder.path().join(name);
    write_mesh(&path("whole.meshb"), &mesh).unwrap();
    let (counts, shared) = (MeshCounts::of(&mesh), path("shared.meshb"));
    let first = MeshWriter::create(created(&shared), &shared, &counts).unwrap();
    let again = || File::options().read(true).write(true).open(&shared).unwrap();
    let fewer = MeshCounts { tets: counts.tets - 1, ..counts };
    let refused = MeshWriter::join(again(), &shared, &fewer).unwrap_err();
    assert!(refused.to_string().contains("the process that has begun it"), "{refused}");
    let second = MeshWriter::join(again(), &shared, &counts).unwrap();
    let half = mesh.tets.len() / 2;
    let (nodes, refs) = (&mesh.tets.nodes, &mesh.tets.refs);
    second.put(Team::alone(), half, Slice::Tets(&nodes[half..], &refs[half..])).unwrap();
    first.put(Team::alone(), 0, Slice::Tets(&nodes[..half], &refs[..half])).unwrap();
    let others = slices(&mesh).into_iter().filter(|slice| !matches!(slice, Slice::Tets(..)));
    others.for_each(|slice| first.put(Team::alone(), 0, slice).unwrap());
    let written = second.leave().unwrap();
    assert_eq!(written.len(), 1);
    first.add_written(&written).unwrap();
    assert!(first.add_written(&written).unwrap_err().to_string().contains("a second time"));
    assert!(first.add_written(&[[999, 0, 1]]).unwrap_err().to_string().contains("other sections"));
    first.finish().unwrap();
    assert!(fs::read(&shared).unwrap() == fs::read(path("whole.meshb")).unwrap());
}

/// What another process has not written is missed.
#[test]
fn rows_that_nobody_wrote_are_missed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shared.solb");
    let tensors = vec![[1.0, 0.0, 1.0, 0.0, 0.0, 1.0]; 10];
    let first = MetricWriter::create(created(&path), &path, 10).unwrap();
    let second = MetricWriter::join(File::options().read(true).write(true).open(&path).unwrap(), &path, 10).unwrap();
    first.put(Team::alone(), 0, &tensors[..4]).unwrap();
    second.put(Team::alone(), 5, &tensors[5..]).unwrap();
    first.add_written(&second.leave().unwrap()).unwrap();
    let missed = first.finish().unwrap_err().to_string();
    assert!(missed.contains("9 rows of 10") && missed.contains("row 5 is missing"), "{missed}");
}

#[test]
fn a_metric_by_slices_has_the_bytes_of_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let count = 2 * GRAIN + 3;
    let tensors: Vec<_> = (0..count).map(|v| [1.0, 0.1, 2.0, 0.0, 1e-9, v as f64 / 3.0]).collect();
    write_solution(&path("whole.solb"), &Solution::metric(&tensors)).unwrap();
    let sliced = path("sliced.solb");
    let writer = MetricWriter::create(created(&sliced), &sliced, count).unwrap();
    writer.put(Team::alone(), 5, &tensors[5..]).unwrap();
    writer.put(Team::alone(), 0, &tensors[..5]).unwrap();
    writer.finish().unwrap();
    assert!(fs::read(&sliced).unwrap() == fs::read(path("whole.solb")).unwrap());
    let reader = SolutionReader::open(&sliced).unwrap();
    assert_eq!((reader.vertices(), reader.kinds()), (count, &[FieldKind::SymmetricTensor][..]));
    let range = GRAIN - 1..2 * GRAIN + 1;
    let read = reader.fields(Team::alone(), range.clone()).unwrap();
    assert!(read == Solution::metric(&tensors[range]));
}

/// What stands where in files that are too big for a test.
#[test]
fn the_frame_of_large_files_is_that_of_their_version() {
    let ends = |counts: MeshCounts| {
        let sections = sections(|keyword| counts.rows(keyword));
        let version = version(&sections);
        let framed = frame(version, &sections);
        // Each head names the place of the next one.
        let mut next = framed[0].head.len() as u64;
        for Framed { place, head, rows } in &framed[1..] {
            assert_eq!(*place, next);
            next = place + head.len() as u64 + rows.map_or(0, |(section, row)| section.count as u64 * row as u64);
            let said = match version {
                2 => u64::from(u32::from_le_bytes(*head[4..].first_chunk().unwrap())),
                _ => u64::from_le_bytes(*head[4..].first_chunk().unwrap()),
            };
            assert_eq!(said, if rows.is_some() { next } else { 0 });
        }
        (version, framed.len(), next)
    };
    // 28 bytes a vertex, 20 a tetrahedron; in version 4 32 and 40.
    let counts = MeshCounts { vertices: 30_000_000, tets: 65_000_000, ..MeshCounts::default() };
    assert_eq!(ends(counts), (2, 4, 20 + 12 + 12 + 8 + 28 * 30_000_000 + 20 * 65_000_000));
    let counts = MeshCounts { tets: 66_000_000, ..counts };
    assert_eq!(ends(counts), (3, 4, 24 + 16 + 16 + 12 + 28 * 30_000_000 + 20 * 66_000_000));
    let counts = MeshCounts { tets: 2_147_483_648, ..counts };
    assert_eq!(ends(counts), (4, 4, 24 + 20 + 20 + 12 + 32 * 30_000_000 + 40 * 2_147_483_648));
}

#[test]
fn rows_that_are_missing_doubled_or_wrong_are_refused() {
    let (mut mesh, folder) = (cube(1), tempfile::tempdir().unwrap());
    mesh.ridges.clear();
    let path = folder.path().join("a.meshb");
    let counts = MeshCounts { ridges: 1, edges: 2, ..MeshCounts::of(&mesh) };
    let writer = MeshWriter::create(created(&path), &path, &counts).unwrap();
    let put = |start, slice| writer.put(Team::alone(), start, slice).map_err(|error| error.to_string());
    let failed = |start, slice, message: &str| {
        assert_eq!(put(start, slice).unwrap_err(), format!("{}: {message}", path.display()));
    };
    let range = "an index is out of range: 8 are there, counted from 0; nothing is written";
    failed(3, Slice::Tets(&[[0, 1, 2, 7], [0, 1, 2, 8]], &[1, 1]), &format!("Tetrahedra 5: {range}"));
    failed(0, Slice::Corners(&[8]), &format!("Corners 1: {range}"));
    failed(0, Slice::Ridges(&[2]), &format!("Ridges 1: {}", range.replace('8', "2")));
    failed(0, Slice::Triangles(&[[0, 1, 2]], &[]), "Triangles: 0 references for 1 entities; give each one reference");
    let not_finite = [[0.0, f64::NAN, 0.0]];
    failed(6, Slice::Vertices(&not_finite, &[0]), "Vertices 7: a value is not a finite number; nothing is written");
    failed(1, Slice::Edges(&[[0, 1]; 2], &[0; 2]), "Edges: rows 2 to 3 are given, but the file is for 2");
    failed(0, Slice::Corners(&[0]), "Corners: rows 1 to 1 are given, but the file is for 0");
    put(1, Slice::Edges(&[[0, 1]], &[0])).unwrap();
    failed(0, Slice::Edges(&[[0, 1]; 2], &[0; 2]), "Edges 2: the row comes a second time");
    put(0, Slice::Vertices(&mesh.vertices, &mesh.vertex_refs)).unwrap();
    put(0, Slice::Corners(&[])).unwrap();
    let message = writer.finish().unwrap_err().to_string();
    assert_eq!(message, format!("{}: Edges: 1 rows of 2 were written; row 1 is missing", path.display()));
    let message = MeshWriter::create(created(&folder.path().join("b")), &path, &MeshCounts::default());
    assert!(message.unwrap_err().to_string().ends_with("Vertices: the mesh has no vertices; nothing is written"));
}

/// The same file in another version or byte order.
fn encoded(mesh: &TetMesh, version: i32, big: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let is_long = version > 2;
    let int = |bytes: &mut Vec<u8>, value: i64, long: bool| match (long, big) {
        (false, false) => bytes.extend((value as i32).to_le_bytes()),
        (false, true) => bytes.extend((value as i32).to_be_bytes()),
        (true, false) => bytes.extend(value.to_le_bytes()),
        (true, true) => bytes.extend(value.to_be_bytes()),
    };
    let real = |bytes: &mut Vec<u8>, x: f64| bytes.extend(if big { x.to_be_bytes() } else { x.to_le_bytes() });
    let wide = version == 4;
    let head = |bytes: &mut Vec<u8>, code: i64, count: usize, row: usize| {
        int(bytes, code, false);
        let next = bytes.len() + if is_long { 8 } else { 4 } + if wide { 8 } else { 4 } + count * row;
        int(bytes, next as i64, is_long);
        int(bytes, count as i64, wide);
    };
    let word = if wide { 8 } else { 4 };
    [1, i64::from(version), 3].into_iter().for_each(|word| int(&mut bytes, word, false));
    let next = bytes.len() as i64 + if is_long { 12 } else { 8 };
    int(&mut bytes, next, is_long);
    int(&mut bytes, 3, false);
    head(&mut bytes, 4, mesh.vertices.len(), 24 + word);
    for (x, &reference) in mesh.vertices.iter().zip(&mesh.vertex_refs) {
        x.iter().for_each(|&x| real(&mut bytes, x));
        int(&mut bytes, reference.into(), wide);
    }
    head(&mut bytes, 8, mesh.tets.len(), 5 * word);
    for (nodes, reference) in mesh.tets.iter() {
        nodes.iter().for_each(|&v| int(&mut bytes, i64::from(v) + 1, wide));
        int(&mut bytes, reference.into(), wide);
    }
    head(&mut bytes, 14, mesh.ridges.len(), word);
    mesh.ridges.iter().for_each(|&e| int(&mut bytes, i64::from(e) + 1, wide));
    head(&mut bytes, 5, mesh.edges.len(), 3 * word);
    for (nodes, reference) in mesh.edges.iter() {
        nodes.iter().for_each(|&v| int(&mut bytes, i64::from(v) + 1, wide));
        int(&mut bytes, reference.into(), wide);
    }
    int(&mut bytes, 54, false);
    bytes
}

#[test]
fn slices_of_every_version_and_byte_order_read_what_is_there() {
    let (mut mesh, folder) = (mesh(), tempfile::tempdir().unwrap());
    let path = folder.path().join("a.meshb");
    let pool = Pool::new(3).unwrap();
    let teams = [Team::alone(), Team::new(&pool, Plan::default())];
    let cut = |n: usize| [0..n, n..n, 1..n.min(GRAIN + 3), n / 3..n - 1];
    let check = |reader: &MeshReader, mesh: &TetMesh| {
        assert_eq!(*reader.counts(), MeshCounts::of(mesh));
        for team in teams {
            for range in cut(mesh.vertices.len()) {
                let (points, refs) = reader.vertices(team, range.clone()).unwrap();
                assert!(points == mesh.vertices[range.clone()] && refs == mesh.vertex_refs[range]);
            }
            for range in cut(mesh.tets.len()) {
                let tets = reader.tets(team, range.clone()).unwrap();
                assert!(tets.nodes == mesh.tets.nodes[range.clone()] && tets.refs == mesh.tets.refs[range]);
            }
            let (edges, triangles) = (mesh.edges.len(), mesh.triangles.len());
            assert!(reader.edges(team, 2..edges).unwrap().nodes == mesh.edges.nodes[2..]);
            assert!(reader.triangles(team, 0..triangles).unwrap() == mesh.triangles);
        }
        assert_eq!((reader.corners().unwrap(), reader.ridges().unwrap()), (mesh.corners.clone(), mesh.ridges.clone()));
        let required = (&mesh.required_vertices, &mesh.required_edges, &mesh.required_triangles);
        assert_eq!((&reader.required_vertices().unwrap(), &reader.required_edges().unwrap()), (required.0, required.1));
        assert_eq!(&reader.required_triangles().unwrap(), required.2);
        assert_eq!(reader.association().unwrap(), mesh.association);
    };
    whole(&path, &mesh);
    check(&MeshReader::open(&path).unwrap(), &mesh);
    mesh = TetMesh {
        vertices: mesh.vertices,
        vertex_refs: mesh.vertex_refs,
        edges: mesh.edges,
        tets: mesh.tets,
        ridges: mesh.ridges,
        ..Default::default()
    };
    for (version, big) in [(2, false), (3, false), (4, false), (2, true), (3, true), (4, true)] {
        let bytes = encoded(&mesh, version, big);
        assert!(mesh_from(Team::alone(), &path, &bytes).unwrap().content.0 == mesh, "{version} {big}");
        fs::write(&path, bytes).unwrap();
        check(&MeshReader::open(&path).unwrap(), &mesh);
    }
}

#[test]
fn fields_of_several_kinds_come_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.solb");
    let count = GRAIN + 10;
    let values = |kind: FieldKind| (0..count * kind.values()).map(|k| k as f64 / 7.0).collect::<Vec<_>>();
    let fields = [FieldKind::Vector, FieldKind::Scalar].map(|kind| SolutionField { kind, values: values(kind) });
    let solution = Solution { vertices: count, fields: fields.into() };
    write_solution(&path, &solution).unwrap();
    let reader = SolutionReader::open(&path).unwrap();
    assert!(reader.fields(Team::alone(), 0..count).unwrap() == solution);
    let some = reader.fields(Team::alone(), 3..GRAIN + 7).unwrap();
    assert_eq!(some.vertices, GRAIN + 4);
    assert!(some.fields[0].values == solution.fields[0].values[9..3 * (GRAIN + 7)]);
    assert!(some.fields[1].values == solution.fields[1].values[3..GRAIN + 7]);
    let (width, rows) = (reader.width(), reader.rows(Team::alone(), 0..count).unwrap());
    assert_eq!((width, &rows[4..8]), (4, &[3.0, 4.0, 5.0, 1.0].map(|k| k / 7.0)[..]));
    // Written by slices they are the same bytes.
    let sliced = folder.path().join("b.solb");
    let writer = SolutionWriter::create(created(&sliced), &sliced, count, reader.kinds()).unwrap();
    writer.put(Team::alone(), 9, (width, &rows[4 * 9..])).unwrap();
    assert!(writer.put(Team::alone(), 0, (width, &[f64::NAN; 4])).is_err());
    writer.put(Team::alone(), 0, (width, &rows[..4 * 9])).unwrap();
    writer.finish().unwrap();
    assert!(fs::read(&sliced).unwrap() == fs::read(&path).unwrap());
    let message = reader.fields(Team::alone(), 0..count + 1).unwrap_err().to_string();
    assert!(message.ends_with(&format!("rows 1 to {} are asked for, but there are {count}", count + 1)), "{message}");
}

/// A damaged file is refused with the words of the reader of whole files.
#[test]
fn errors_are_those_of_the_whole() {
    let (mesh, folder) = (mesh(), tempfile::tempdir().unwrap());
    let path: PathBuf = folder.path().join("a.meshb");
    let bytes = whole(&path, &mesh);
    let vertices = 20 + 12;
    let edges = vertices + 28 * mesh.vertices.len() + 12;
    let triangles = edges + 12 * mesh.edges.len() + 12;
    let tets = triangles + 16 * mesh.triangles.len() + 12;
    let changed = |at: usize, value: i32| {
        let mut bytes = bytes.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let nan =
        [&bytes[..vertices + 28 * 4200], &f64::NAN.to_le_bytes()[..], &bytes[vertices + 28 * 4200 + 8..]].concat();
    let damaged = [
        Vec::new(),
        bytes[..bytes.len() / 2].to_vec(),
        bytes[..6].to_vec(),
        [&bytes[..], b"more"].concat(),
        changed(4, 9),
        changed(vertices - 4, 7),
        changed(vertices - 12, 99),
        changed(16, 2),
        changed(edges + 12 * 4099, 0),
        changed(tets + 20 * 9000 + 4, 1 << 30),
        nan,
    ];
    for (number, bytes) in damaged.iter().enumerate() {
        let expected = mesh_from(Team::alone(), &path, bytes).map(|_| ()).expect_err(&number.to_string()).to_string();
        fs::write(&path, bytes).unwrap();
        let found = MeshReader::open(&path).and_then(|reader| {
            let counts = *reader.counts();
            reader.vertices(Team::alone(), 4000..counts.vertices)?;
            reader.edges(Team::alone(), 7..counts.edges)?;
            reader.tets(Team::alone(), 5000..counts.tets).map(|_| ())
        });
        assert_eq!(found.expect_err(&number.to_string()).to_string(), expected);
    }
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        SolutionReader::open(&path).unwrap_err().to_string()
    };
    assert_eq!(message(&bytes), solution_from(Team::alone(), &path, &bytes).unwrap_err().to_string());
    assert!(message(b"MeshVersionFormatted 2").contains("no binary file of libMeshb"));
    // A file that is cut while it is read.
    fs::write(&path, &bytes).unwrap();
    let reader = MeshReader::open(&path).unwrap();
    File::options().write(true).open(&path).unwrap().set_len(tets as u64 + 1000).unwrap();
    assert!(reader.vertices(Team::alone(), 0..9).is_ok());
    assert!(reader.tets(Team::alone(), 0..9000).is_err());
    assert!(reader.tets(Team::alone(), 0..mesh.tets.len() + 1).unwrap_err().to_string().contains("are asked for"));
}
