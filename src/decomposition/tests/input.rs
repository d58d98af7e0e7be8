//! A mesh that is read by slices is the same mesh.
use super::{Random, picture};
use crate::decomposition::Error;
use crate::decomposition::input::{Files, InMemory, Input, MetricOf, Shell, Skin, slices};
use crate::decomposition::join::join;
use crate::decomposition::piece::Piece;
use crate::decomposition::sizes::Sizes;
use crate::geometry::classify::Classification;
use crate::geometry::discrete::{DEFAULT_RIDGE_ANGLE, complete_boundary};
use crate::geometry::{Discrete, Model};
use crate::mesh::io::slices::MeshReader;
use crate::mesh::{TetMesh, io, samples};
use crate::metric::{Analytic, Background, Field, Source, Sym3};
use crate::ranks::Alone;
use crate::tasks::Team;
use std::path::Path;

/// A cube of n³ cells with two regions, its tetrahedra in no order, with what may be required; on its own surface, with ln M at its vertices.
fn sample(n: u32) -> (TetMesh, Model, Classification, Vec<Sym3>) {
    let mut mesh = samples::cube(n);
    for t in 0..mesh.tets.len() {
        let sum: f64 = mesh.tets.nodes[t].iter().map(|&v| mesh.vertices[v as usize][0]).sum();
        mesh.tets.refs[t] = if sum < 2.0 { 7 } else { 4 };
    }
    let mut random = Random(5);
    for t in (1..mesh.tets.len()).rev() {
        let other = random.below(t + 1);
        mesh.tets.nodes.swap(t, other);
        mesh.tets.refs.swap(t, other);
    }
    complete_boundary(Team::alone(), &mut mesh);
    mesh.required_vertices = vec![1, 40];
    mesh.required_triangles = vec![3, mesh.triangles.len() as u32 - 1];
    mesh.required_edges = vec![0];
    mesh.edges.push([0, 1], 5);
    mesh.vertex_refs = (0..mesh.vertices.len() as i32).map(|v| v % 3).collect();
    let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).unwrap();
    let log = |p: &[f64; 3]| Sym3::diagonal(9.0 + p[0], 16.0, 4.0 + 20.0 * p[2]).ln();
    let logs = mesh.vertices.iter().map(log).collect();
    (mesh, Model::Discrete(model), place, logs)
}

/// Mesh and metric as files.
fn written(folder: &Path, mesh: &TetMesh, logs: &[Sym3]) -> Files {
    let [path, metric] = ["a.meshb", "a.solb"].map(|name| folder.join(name));
    io::write_mesh(&path, mesh).unwrap();
    Field::write_logs(Team::alone(), &metric, logs).unwrap();
    let metric = MetricOf::File(Field::open(&metric, mesh.vertices.len()).unwrap());
    Files::new(MeshReader::open(&path).unwrap(), metric)
}

fn pieces(skin: &Skin<'_>, input: &dyn Input, size: usize) -> Vec<Piece> {
    let tets = input.size()[1];
    let ranges = (0..tets).step_by(size).map(|start| start..tets.min(start + size));
    ranges.map(|range| skin.piece(input, range).unwrap()).collect()
}

#[test]
fn slices_join_to_the_mesh() {
    let (mesh, _, place, logs) = sample(5);
    let input = InMemory { mesh: &mesh, logs: &logs };
    let skin = Skin::of(Team::alone(), &mesh, &place);
    let whole = picture(&skin.piece(&input, 0..mesh.tets.len()).unwrap());
    for size in [7, 100, 400] {
        let mut parts = pieces(&skin, &input, size);
        assert!(parts.len() > 1 && parts.iter().all(|piece| piece.ids.is_sorted()));
        assert!(picture(&join(parts.clone())) == whole, "{size}");
        parts.reverse();
        assert!(picture(&join(parts)) == whole, "{size}, the last one first");
    }
}

#[test]
fn slices_of_files_are_those_of_the_mesh_in_memory() {
    let (mesh, model, place, logs) = sample(5);
    let folder = tempfile::tempdir().unwrap();
    let files = written(folder.path(), &mesh, &logs);
    let shell = Shell::read(Team::alone(), &Alone, &files).unwrap();
    assert!(shell.mesh.tets.len() < mesh.tets.len() && shell.mesh.triangles.len() == mesh.triangles.len());
    // What was written and read is a little different.
    let logs = files.vertices(&(0..mesh.vertices.len() as u32).collect::<Vec<_>>()).unwrap().logs;
    let input = InMemory { mesh: &mesh, logs: &logs };
    let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), logs.clone());
    assert_eq!(shell.complexity.to_bits(), Source::Background(background).complexity(Team::alone(), &mesh).to_bits());
    let (own, place_there) = Discrete::from_mesh(Team::alone(), &shell.mesh, DEFAULT_RIDGE_ANGLE).unwrap();
    let (there, here) = (shell.skin(Team::alone(), &place_there), Skin::of(Team::alone(), &mesh, &place));
    for size in [50, 10_000] {
        assert!(pieces(&there, &files, size) == pieces(&here, &input, size), "{size}");
    }
    let [a, b] = [there.references(Team::alone(), &Model::Discrete(own)), here.references(Team::alone(), &model)];
    assert_eq!((a.faces, a.inward, a.edges), (b.faces, b.inward, b.edges));
}

#[test]
fn an_analytic_metric_has_the_complexity_of_the_whole_mesh() {
    // More than a task's tetrahedra.
    let (mesh, _, _, logs) = sample(12);
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), &mesh, &logs);
    let source = || Source::Analytic { field: Analytic::Polar1, log_scale: 0.5 };
    let mesh_file = MeshReader::open(&folder.path().join("a.meshb")).unwrap();
    let shell = Shell::read(Team::alone(), &Alone, &Files::new(mesh_file, MetricOf::Analytic(source()))).unwrap();
    assert_eq!(shell.complexity.to_bits(), source().complexity(Team::alone(), &mesh).to_bits());
}

#[test]
fn a_missing_triangle_and_an_inverted_tetrahedron_are_told() {
    let (mesh, _, _, logs) = sample(4);
    let outer = mesh.triangles.nodes.iter().position(|t| t.iter().all(|&v| mesh.vertices[v as usize][2] == 0.0));
    let inner = mesh.triangles.nodes.iter().position(|t| t.iter().all(|&v| mesh.vertices[v as usize][0] == 0.5));
    for missing in [outer, inner].map(Option::unwrap) {
        let mut mesh = mesh.clone();
        mesh.required_triangles.clear();
        mesh.triangles.nodes.remove(missing);
        mesh.triangles.refs.remove(missing);
        let folder = tempfile::tempdir().unwrap();
        let found = Shell::read(Team::alone(), &Alone, &written(folder.path(), &mesh, &logs));
        assert!(matches!(found, Err(Error::Incomplete)));
    }
    let (mut mesh, folder) = (mesh, tempfile::tempdir().unwrap());
    mesh.tets.nodes[9].swap(0, 1);
    let found = Shell::read(Team::alone(), &Alone, &written(folder.path(), &mesh, &logs));
    assert!(found.err().unwrap().to_string().contains("tetrahedron 10 is inverted"));
}

#[test]
fn slices_are_of_one_size_and_all_of_the_mesh() {
    let found = slices(1000, &Sizes::of(50.0));
    assert_eq!(found, [0..300, 300..600, 600..900, 900..1000]);
    let of_nothing = slices(0, &Sizes::of(50.0));
    assert!(of_nothing.len() == 1 && of_nothing[0].is_empty());
}
