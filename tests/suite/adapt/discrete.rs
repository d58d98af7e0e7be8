//! `geo-adapt adapt` without a CAD model: the surface of the input is the geometry.

use crate::common::adapting::{Adapted, Workplace, areas, cube, faces, isotropic, sorted, stderr, text, volumes};
use crate::common::program;
use geo_adapt::geometry::discrete::outward_triangles;
use geo_adapt::mesh::vector::{Vec3, area2, distance};
use geo_adapt::mesh::{Elements, TetMesh, io};
use geo_adapt::metric::{Sym3, field};
use geo_adapt::tasks::Team;
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// Two boxes that meet at x = ½.
fn two_regions(n: u32) -> TetMesh {
    cube(n, |p| 1 + i32::from(p[0] > 0.5))
}

fn one(n: u32) -> TetMesh {
    cube(n, |_| 5)
}

/// The six sides have their areas, their references and their outward normals, and the volume is that of the cube.
fn check_cube(found: &Adapted) {
    let mesh = &found.mesh;
    let sides = areas(mesh);
    assert_eq!(sides.keys().copied().filter(|&r| r < 7).collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6]);
    for side in 1..=6 {
        assert!((sides[&side] - 1.0).abs() < 1e-12, "side {side}: {}", sides[&side]);
    }
    for (nodes, side) in mesh.triangles.iter().filter(|&(_, side)| side < 7) {
        let (axis, value) = ((side as usize - 1) / 2, f64::from((side - 1) % 2));
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        assert!([a, b, c].iter().all(|p| (p[axis] - value).abs() < 1e-12));
        assert!(area2(a, b, c)[axis] * (value - 0.5) > 0.0, "normals point outward");
    }
    assert!((volumes(mesh).values().sum::<f64>() - 1.0).abs() < 1e-12);
    assert_eq!(mesh.corners.len(), 8);
    assert_eq!(mesh.ridges.len(), mesh.edges.len());
    assert!(mesh.association.is_empty());
}

#[test]
fn a_cube_keeps_volume_patches_and_references() {
    let work = Workplace::new();
    let mut mesh = one(3);
    assert_eq!(mesh.vertices.len(), 64);
    // Listed edges keep their references: the bottom's border.
    for (a, b, reference) in [([0, 0], [1, 0], 21), ([1, 0], [1, 1], 22), ([1, 1], [0, 1], 23), ([0, 1], [0, 0], 24)] {
        let at = |k: u32| on_bottom(a, b, k);
        (0..3).for_each(|k| mesh.edges.push([at(k), at(k + 1)], reference));
    }
    let metric = work.metric(&mesh, |_| isotropic(0.15));
    let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
    check_cube(&found);
    assert!(found.mesh.vertices.len() > 300, "{}", found.mesh.vertices.len());
    assert!(found.mesh.tets.refs.iter().all(|&region| region == 5));
    for reference in [21, 22, 23, 24] {
        let length: f64 = lengths(&found.mesh, reference).sum();
        assert!((length - 1.0).abs() < 1e-12, "{reference}: {length}");
    }
    let others: f64 = lengths(&found.mesh, 0).sum();
    assert!((others - 8.0).abs() < 1e-12, "ridges that were not listed: {others}");
    assert_eq!(found.report["input_vertices"], 64);
}

/// Vertex k of 0..=3 on the way from one corner (x, y) of the bottom to another.
fn on_bottom(a: [u32; 2], b: [u32; 2], k: u32) -> u32 {
    let [i, j] = [0, 1].map(|axis| (3 - k) * a[axis] + k * b[axis]);
    (i * 4 + j) * 4
}

fn lengths(mesh: &TetMesh, reference: i32) -> impl Iterator<Item = f64> + '_ {
    let length = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|v| mesh.vertices[v as usize]);
        distance(a, b)
    };
    mesh.edges.iter().filter(move |edge| edge.1 == reference).map(move |edge| length(edge.0))
}

/// A wedge with a blunt edge at x = 1: a strip between two ridges, a fifth of the sizes wide.
#[test]
fn ridges_side_by_side_are_split_to_unit_length() {
    let work = Workplace::new();
    let mut mesh = one(1);
    mesh.vertices.iter_mut().for_each(|p| *p = [p[0], 3.0 * p[1], 0.5 + (p[2] - 0.5) * (1.0 - 0.98 * p[0])]);
    // The longest edge and the least mean ratio are one place's, so there are several meshes.
    let sizes = [0.09, 0.1, 0.11, 0.12];
    let [mut longest, mut least] = [0.0, 0.0];
    for size in sizes {
        let metric = work.metric(&mesh, |_| isotropic(size));
        let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
        let at_the_end = |nodes: [u32; 2]| nodes.map(|v| found.mesh.vertices[v as usize]);
        let along: Vec<f64> = (found.mesh.edges.iter().map(|(nodes, _)| at_the_end(nodes)))
            .filter(|ends| ends.iter().all(|p| p[0] == 1.0) && (ends[0][1] - ends[1][1]).abs() > 1e-9)
            .map(|[a, b]| distance(a, b) / size)
            .collect();
        assert!((along.iter().sum::<f64>() * size - 6.0).abs() < 1e-9, "{size}, the two ridges: {along:?}");
        // Where points near the other ridge were refused, edges of twice the size stayed.
        assert!(along.iter().all(|&length| length < 1.9), "{size}: {along:?}");
        longest += along.iter().copied().fold(0.0, f64::max) / sizes.len() as f64;
        least += found.report["statistics"]["mean_ratios"]["min"].as_f64().unwrap() / sizes.len() as f64;
    }
    assert!(longest < 1.6, "{longest}");
    assert!(least > 0.34, "{least}");
}

#[test]
fn a_fine_cube_is_coarsened() {
    let work = Workplace::new();
    let mesh = one(8);
    let metric = work.metric(&mesh, |_| isotropic(0.5));
    let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
    check_cube(&found);
    assert!(found.mesh.vertices.len() < 80, "{} of 729 vertices", found.mesh.vertices.len());
}

#[test]
fn two_regions_keep_their_volumes_and_a_conforming_interface() {
    let work = Workplace::new();
    for (n, size) in [(4, 0.14), (8, 0.45)] {
        let mesh = two_regions(n);
        let metric = work.metric(&mesh, |_| isotropic(size));
        let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
        let mesh = &found.mesh;
        let volumes = volumes(mesh);
        assert_eq!(volumes.keys().copied().collect::<Vec<_>>(), [1, 2]);
        assert!(volumes.values().all(|v| (v - 0.5).abs() < 1e-12), "{volumes:?}");
        assert!((areas(mesh)[&7] - 1.0).abs() < 1e-12);
        let tagged: BTreeSet<_> = mesh.triangles.iter().filter(|t| t.1 == 7).map(|(nodes, _)| sorted(nodes)).collect();
        let between =
            faces(mesh).into_iter().filter(|(_, (_, regions))| regions.len() == 2 && regions[0] != regions[1]);
        let between: BTreeSet<_> = between.map(|(key, _)| key).collect();
        assert_eq!(tagged, between, "the triangles of reference 7 are what lies between the regions");
        assert!(between.iter().flatten().all(|&v| (mesh.vertices[v as usize][0] - 0.5).abs() < 1e-12));
    }
}

#[test]
fn new_vertices_take_their_metric_from_the_file() {
    let work = Workplace::new();
    let mesh = one(4);
    // ln M is linear in space, so its interpolation is exact.
    let at = |p: Vec3| Sym3::diagonal((3.0 + 2.0 * p[0]).exp(), (3.0 - p[1]).exp(), (4.0 + p[2]).exp());
    let metric = work.metric(&mesh, at);
    let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
    check_cube(&found);
    for (m, &p) in found.metrics.iter().zip(&found.mesh.vertices) {
        let expected = at(p);
        assert!((0..6).all(|i| (m.0[i] - expected.0[i]).abs() < 1e-9 * expected.0[5]), "{p:?}: {m:?} {expected:?}");
    }
}

#[test]
fn the_complexity_that_is_asked_for_is_reached() {
    let work = Workplace::new();
    let mesh = one(5);
    let input = work.mesh(&mesh);
    let metric = work.metric(&mesh, |p| Sym3::diagonal(1.0 + p[0], 2.0, 0.5));
    for (wanted, field) in [(600.0, ["--metric", &metric]), (2000.0, ["--analytic", "linear"])] {
        let found = work.adapt(&input, &[&field[..], &["--complexity", &wanted.to_string()]].concat());
        let reached = found.report["statistics"]["metric"]["complexity"].as_f64().unwrap();
        assert!((reached / wanted - 1.0).abs() < 0.1, "{field:?}: {reached} for {wanted}");
        let vertices = found.mesh.vertices.len() as f64;
        assert!((vertices / (2.0 * wanted) - 1.0).abs() < 0.25, "{field:?}: {vertices} vertices for {wanted}");
        assert_eq!(found.report["complexity_wanted"], wanted);
    }
}

/// Vertices inside, on a side and on an edge of the cube; an edge and a triangle on a side; an edge inside.
fn with_required(n: u32) -> TetMesh {
    let mut mesh = one(n);
    let index = |i: u32, j: u32, k: u32| (i * (n + 1) + j) * (n + 1) + k;
    let m = n / 2;
    mesh.required_vertices = vec![index(m, m, m), index(m, m, 0), index(m, 0, 0), index(1, 1, 1)];
    for &v in &mesh.required_vertices {
        mesh.vertex_refs[v as usize] = 9;
    }
    mesh.edges = Elements {
        nodes: vec![[index(0, m, m), index(0, m, m - 1)], [index(1, 2, 1), index(1, 1, 1)], [0, 1]],
        refs: vec![31, 32, 33],
    };
    mesh.required_edges = vec![1, 0];
    let top = mesh.triangles.iter().position(|(_, side)| side == 6).unwrap();
    mesh.required_triangles = vec![top as u32];
    mesh
}

fn positions<const N: usize>(mesh: &TetMesh, elements: &Elements<N>, listed: &[u32]) -> BTreeSet<Vec<String>> {
    let place = |v: u32| format!("{:?}", mesh.vertices[v as usize].map(|x| (1e9 * x).round()));
    let of = |&e: &u32| {
        let mut places: Vec<String> = elements.nodes[e as usize].iter().map(|&v| place(v)).collect();
        places.sort();
        places
    };
    listed.iter().map(of).collect()
}

#[test]
fn what_is_required_stays_when_everything_around_it_changes() {
    let work = Workplace::new();
    let input = with_required(6);
    for size in [0.6, 0.09] {
        let metric = work.metric(&input, |_| isotropic(size));
        let found = work.adapt(&work.mesh(&input), &["--metric", &metric]);
        let mesh = &found.mesh;
        check_required(&input, mesh);
        assert!(if size > 0.5 { mesh.vertices.len() < 150 } else { mesh.vertices.len() > 1000 });
        assert_eq!(mesh.edges.refs.iter().filter(|&&r| r == 31 || r == 32).count(), 2, "in one piece each");
    }
}

fn check_required(input: &TetMesh, mesh: &TetMesh) {
    let vertices = |mesh: &TetMesh| {
        let listed = Elements { nodes: mesh.required_vertices.iter().map(|&v| [v]).collect(), refs: Vec::new() };
        positions(mesh, &listed, &(0..listed.nodes.len() as u32).collect::<Vec<_>>())
    };
    assert_eq!(vertices(mesh), vertices(input));
    assert!(mesh.required_vertices.iter().all(|&v| mesh.vertex_refs[v as usize] == 9));
    assert_eq!(
        positions(mesh, &mesh.edges, &mesh.required_edges),
        positions(input, &input.edges, &input.required_edges)
    );
    let refs =
        |mesh: &TetMesh| mesh.required_edges.iter().map(|&e| mesh.edges.refs[e as usize]).collect::<BTreeSet<_>>();
    assert_eq!(refs(mesh), refs(input));
    assert_eq!(
        positions(mesh, &mesh.triangles, &mesh.required_triangles),
        positions(input, &input.triangles, &input.required_triangles)
    );
}

#[test]
fn two_threads_make_a_valid_mesh_too() {
    let work = Workplace::new();
    let mesh = with_required(6);
    let metric = work.metric(&mesh, |p| isotropic(0.08 + 0.2 * p[0]));
    let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric, "--threads", "2"]);
    check_required(&mesh, &found.mesh);
    assert!((volumes(&found.mesh)[&5] - 1.0).abs() < 1e-12);
    assert_eq!(found.report["threads"], 2);
}

#[test]
fn triangles_that_the_file_lacks_are_added_and_said() {
    let work = Workplace::new();
    let mut mesh = two_regions(4);
    mesh.triangles = Elements::default();
    let metric = work.metric(&mesh, |_| isotropic(0.2));
    let run = work.command(&work.mesh(&mesh), &["--metric", &metric]).output().unwrap();
    assert!(run.status.success() && stderr(&run).contains("triangles were missing"), "{}", stderr(&run));
    let found = io::read_mesh(&work.path("out.meshb")).unwrap().content;
    assert!(volumes(&found).values().all(|v| (v - 0.5).abs() < 1e-12));
    assert_eq!(areas(&found).len(), 3);
}

#[test]
fn x_is_another_name_of_o_and_quiet_says_nothing() {
    let work = Workplace::new();
    let mesh = one(3);
    let (input, metric) = (work.mesh(&mesh), work.metric(&mesh, |_| isotropic(0.3)));
    let mut outputs = Vec::new();
    for (option, quiet) in [("-o", false), ("-x", false), ("-x", true)] {
        let output = work.path("other.meshb");
        let mut run = program();
        run.arg("adapt").arg(&input).arg(option).arg(&output).args(["--metric", &metric, "--threads", "1"]);
        let run = run.args(quiet.then_some("--quiet")).output().unwrap();
        assert!(run.status.success() && run.stderr.is_empty(), "{}", stderr(&run));
        let table = String::from_utf8(run.stdout).unwrap();
        assert_eq!(table.is_empty(), quiet, "{table}");
        assert!(quiet || table.contains("other.meshb") && table.contains("other.solb"), "{table}");
        assert!(!table.contains('\u{1b}'));
        outputs.push(std::fs::read(&output).unwrap());
        std::fs::remove_file(&output).unwrap();
    }
    assert!(outputs[0] == outputs[1] && outputs[0] == outputs[2], "the same mesh on one thread");
}

/// One Ctrl-C ends the work after the running sweep.
#[cfg(unix)]
#[test]
fn an_interrupted_run_writes_a_valid_mesh() {
    let work = Workplace::new();
    let mesh = two_regions(6);
    let (input, metric) = (work.mesh(&mesh), work.metric(&mesh, |_| isotropic(0.02)));
    let report = text(&work.path("report.json"));
    let mut command = work.command(&input, &["--metric", &metric, "--threads", "1", "--report", &report]);
    // The trace tells when the first sweep is over.
    let mut run = command.env("GEO_ADAPT_TRACE", "1").stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let mut lines = BufReader::new(run.stderr.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains("Split")));
    let kill = std::process::Command::new("sh").arg("-c").arg(format!("kill -INT {}", run.id())).status().unwrap();
    assert!(kill.success());
    let said: Vec<String> = lines.map(Result::unwrap).collect();
    assert_eq!(run.wait().unwrap().code(), Some(130), "{said:?}");
    assert!(said.iter().any(|line| line.contains("interrupted")), "{said:?}");
    let found = work.result();
    assert!(volumes(&found.mesh).values().all(|v| (v - 0.5).abs() < 1e-12));
    let unit = found.report["statistics"]["metric"]["unit_edges"].as_f64().unwrap();
    assert!(unit < 0.5, "it was ended before it was done: {unit}");
}

/// A mesh that does not resolve its metric: sizes across a layer differ by 30 within a cell. From one edge of the new mesh to the next they grow by a seventh.
#[test]
fn the_complexity_is_reached_from_a_coarse_mesh_too() {
    let work = Workplace::new();
    let mesh = one(1);
    let metric = work.metric(&mesh, |p| Sym3::diagonal((-6.8 * p[0]).exp(), 1.0 / 1600.0, 1.0 / 1600.0));
    let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric, "--complexity", "600"]);
    // The integral over the new mesh: the sum over its vertices counts too much where sizes change as fast as here.
    let logs: Vec<Sym3> = found.metrics.iter().map(Sym3::ln).collect();
    let reached = field::complexity_between(Team::alone(), &found.mesh, &logs);
    assert!((reached / 600.0 - 1.0).abs() < 0.05, "{reached}");
}

/// Some programs write triangles that look into the domain: theirs still do afterwards.
#[test]
fn triangles_look_to_the_side_that_they_looked_to() {
    for inward in [false, true] {
        let work = Workplace::new();
        let mut mesh = one(3);
        mesh.triangles.nodes = outward_triangles(Team::alone(), &mesh);
        if inward {
            mesh.triangles.nodes.iter_mut().for_each(|nodes| nodes.swap(0, 1));
        }
        let metric = work.metric(&mesh, |_| isotropic(0.2));
        let found = work.adapt(&work.mesh(&mesh), &["--metric", &metric]);
        let outward = outward_triangles(Team::alone(), &found.mesh);
        let same = found.mesh.triangles.nodes.iter().zip(&outward).filter(|(found, outward)| found == outward).count();
        assert_eq!(same, if inward { 0 } else { outward.len() });
    }
}

fn of_reference<const N: usize>(mesh: &TetMesh, elements: &Elements<N>, wanted: i32) -> BTreeSet<Vec<String>> {
    let listed: Vec<u32> =
        elements.refs.iter().zip(0..).filter(|&(&reference, _)| reference == wanted).map(|(_, e)| e).collect();
    positions(mesh, elements, &listed)
}

#[test]
fn what_is_frozen_stays_when_everything_around_it_changes() {
    let work = Workplace::new();
    let input = two_regions(6);
    for size in [0.6, 0.09] {
        let metric = work.metric(&input, |_| isotropic(size));
        let mesh = work.adapt(&work.mesh(&input), &["--metric", &metric, "--freeze", "6,region:2"]).mesh;
        assert_eq!(of_reference(&mesh, &mesh.triangles, 6), of_reference(&input, &input.triangles, 6));
        assert_eq!(of_reference(&mesh, &mesh.tets, 2), of_reference(&input, &input.tets, 2));
        let count = |mesh: &TetMesh| mesh.tets.refs.iter().filter(|&&region| region == 1).count();
        let [before, after] = [count(&input), count(&mesh)];
        assert!(if size > 0.5 { after < before } else { after > 3 * before }, "{before} tetrahedra, {after} after");
    }
}
