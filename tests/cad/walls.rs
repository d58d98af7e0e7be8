//! Layers along walls: exact distances, `geo-adapt metric wall`, and what becomes of the layers when meshes are adapted to it.

use crate::common::adapting::{Workplace, complaint, isotropic, stderr, text, write_tensors};
use crate::common::models::{Random, data};
use crate::common::program;
use geo_adapt::geometry::classify::{self, Classification};
use geo_adapt::geometry::{Entity, Evaluate, Geometry, Model};
use geo_adapt::mesh::vector::{Vec3, add, dot, lerp, scale, unit};
use geo_adapt::mesh::{TetMesh, io};
use geo_adapt::metric::Sym3;
use geo_adapt::sizing::layer::{Foot, distances, from_triangles};
use geo_adapt::tasks::{Plan, Pool, Team};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;

fn cube_cylinder() -> [String; 2] {
    ["geometry/cube-cylinder.step", "cases/cube-cylinder/start.meshb"]
        .map(|path| text(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)))
}

fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

/// A run that must succeed: what it printed.
fn made(arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    String::from_utf8(run.stdout).unwrap()
}

fn mesh_of(path: &str) -> TetMesh {
    io::read_mesh(Path::new(path)).unwrap().content
}

fn scalars(path: &str) -> Vec<f64> {
    io::read_solution(Path::new(path)).unwrap().content.fields.remove(0).values
}

fn tensors(path: &str) -> Vec<Sym3> {
    scalars(path).as_chunks().0.iter().map(|&terms| Sym3(terms)).collect()
}

fn length(metric: &Sym3, direction: Vec3) -> f64 {
    metric.quadratic(direction).sqrt().recip()
}

/// The cylinder of the radius 0.5 about z: its reference on the start mesh is that of the triangles all of whose corners are on it.
fn reference(mesh: &TetMesh) -> i32 {
    let on = |v: &u32| {
        let p = mesh.vertices[*v as usize];
        (p[0].hypot(p[1]) - 0.5).abs() < 1e-9
    };
    mesh.triangles.iter().find(|(nodes, _)| nodes.iter().all(on)).unwrap().1
}

/// Along the radius, about the axis, along it.
fn axes(p: Vec3) -> [Vec3; 3] {
    let r = p[0].hypot(p[1]);
    let [x, y] = [p[0] / r, p[1] / r];
    [[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]]
}

#[test]
fn the_distance_from_a_cylinder_is_exact_and_zero_on_it() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let (mesh, out) = (mesh_of(&start), text(&work.path("d.solb")));
    let wall = reference(&mesh).to_string();
    made(&["field", "distance", &start, "--cad", &model, "--faces", &wall, "-o", &out]);
    let found = scalars(&out);
    let mut on = 0;
    for (p, distance) in mesh.vertices.iter().zip(&found) {
        let expected = p[0].hypot(p[1]) - 0.5;
        assert!((distance - expected).abs() < 1e-12, "{distance} {expected} at {p:?}");
        if expected.abs() < 1e-9 {
            assert_eq!(*distance, 0.0);
            on += 1;
        }
    }
    assert!(on > 20, "{on}");
    // Without the model it is that from the triangles, whose chords rise above the cylinder.
    made(&["field", "distance", &start, "--faces", &wall, "-o", &out, "--report", &text(&work.path("r.json"))]);
    let flat = scalars(&out);
    assert!(flat.iter().zip(&found).all(|(flat, exact)| (flat - exact).abs() < 0.03 && *flat >= exact - 1e-12));
    let report: Value = serde_json::from_slice(&std::fs::read(work.path("r.json")).unwrap()).unwrap();
    assert_eq!((&report["on_faces"], &report["field"]), (&on.into(), &"distance".into()));
}

/// A mesh that `bootstrap` makes of a model, on it.
fn bootstrapped(work: &Workplace, path: &Path) -> (TetMesh, Model, Classification) {
    let out = text(&work.path("start.meshb"));
    made(&["bootstrap", &text(path), "-o", &out, "--complexity", "1500", "-q"]);
    let (mesh, model) = (mesh_of(&out), Model::read(path).unwrap());
    let (place, _) = classify::classify(Team::alone(), &mesh, &model, &classify::Options::default()).unwrap();
    (mesh, model, place)
}

/// The greatest distance of the triangles from the faces that they are on, at their centroids and the middles of their edges.
fn rise_of_chords(mesh: &TetMesh, place: &Classification, distance: impl Fn(u32, Vec3) -> Option<f64>) -> f64 {
    let mut greatest = 0.0;
    for (nodes, &face) in mesh.triangles.nodes.iter().zip(&place.faces) {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        let middles = [lerp(a, b, 0.5), lerp(b, c, 0.5), lerp(c, a, 0.5), lerp(lerp(a, b, 0.5), c, 1.0 / 3.0)];
        greatest = middles.into_iter().filter_map(|p| distance(face, p)).fold(greatest, f64::max);
    }
    greatest
}

/// On spline faces, against OpenCASCADE's own search at each vertex on each face, which misses some closest points on the blade, and against the mesh's
/// triangles, whose chords are the difference; and bit for bit on any number of threads.
#[test]
fn distances_from_several_spline_faces_are_those_of_opencascade() {
    for name in ["blade.brep", "duct.brep"] {
        let work = Workplace::new();
        let (mesh, model, place) = bootstrapped(&work, &data(name));
        let Model::Occt(occt) = &model else { panic!("a CAD model") };
        let faces: Vec<u32> = (0..model.topology().faces.len() as u32).collect();
        let found = distances(Team::alone(), &mesh, &place, &model, &faces);
        let by_triangles = from_triangles(Team::alone(), &mesh, &mesh.triangles.refs);
        let (evaluator, diagonal) = (occt.evaluator(), model.topology().diagonal());
        let chord = rise_of_chords(&mesh, &place, |face, p| evaluator.reference_distance(true, face, p));
        assert!(chord < 0.01 * diagonal, "{name} {chord} {diagonal}");
        let (mut looked, mut missed) = (0, 0);
        for (v, &p) in mesh.vertices.iter().enumerate() {
            if place.entities[v] != Entity::Interior {
                assert_eq!(found[v], 0.0);
                continue;
            }
            let each = faces.iter().filter_map(|&face| evaluator.reference_distance(true, face, p));
            let expected = each.fold(f64::INFINITY, f64::min);
            assert!(found[v] < expected + 1e-7 * diagonal, "{name} {} {expected} at {p:?}", found[v]);
            assert!((found[v] - by_triangles[v]).abs() < 1.5 * chord, "{name} {} {}", found[v], by_triangles[v]);
            missed += usize::from(found[v] < expected - 1e-7 * diagonal);
            looked += 1;
        }
        assert!(looked > 50 && 4 * missed < looked, "{name} {looked} {missed}");
        let pool = Pool::new(3).unwrap();
        let again = distances(Team::new(&pool, Plan::default()), &mesh, &place, &model, &faces);
        assert!(again.iter().zip(&found).all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
    }
}

/// The gradient and the second derivatives of the distance from single faces, by differences of exact distances: beside the faces, and about their
/// edges and corners.
#[test]
fn second_derivatives_of_the_distance_are_those_of_differences() {
    let models = ["cylinder", "torus", "sphere", "cube", "spheroid"];
    let paths = models.map(|name| Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("geometry/{name}.step")));
    let (mut beside, mut about) = (0, 0);
    for path in paths.into_iter().chain([data("nurbs-torus.brep")]) {
        let model = Model::read(&path).unwrap();
        let (topology, mut on, mut random) = (model.topology(), model.evaluator(), Random(7));
        let diagonal = topology.diagonal();
        for i in 0..400 {
            let p = random.within(topology.bounds, 0.3);
            let face = i % topology.faces.len() as u32;
            let mut foot = |p: Vec3| {
                let closest = on.closest_on_face(face, p, None);
                Foot::off_wall(&mut on, topology, (face, closest), p, 1e-9 * diagonal)
            };
            let (here, step) = (foot(p), 1e-3 * diagonal);
            let direction = unit([0; 3].map(|_| random.between([-1.0, 1.0])));
            let [before, after] = [-step, step].map(|s| foot(add(p, scale(direction, s))));
            let is_like = |other: &Foot| {
                other.is_inside == here.is_inside
                    && other.bends[0].is_finite() == here.bends[0].is_finite()
                    && dot(other.normal, here.normal) > 0.99
            };
            let radius = here.radii[0].min(here.radii[1]).min(here.distance);
            if radius < 0.03 * diagonal || !is_like(&before) || !is_like(&after) {
                continue;
            }
            let slope = (after.distance - before.distance) / (2.0 * step);
            assert!((slope - dot(here.normal, direction)).abs() < 2e-3, "{path:?} {face} {p:?}");
            let second = (after.distance - 2.0 * here.distance + before.distance) / (step * step);
            let found = here.hessian([1.0, 0.0]).quadratic(direction);
            assert!((second - found).abs() < 0.02 / radius, "{path:?} {face} {p:?}: {second} {found} {here:?}");
            *(if here.is_inside { &mut beside } else { &mut about }) += 1;
        }
    }
    assert!(beside > 300 && about > 100, "{beside} {about}");
}

#[test]
fn sizes_are_those_of_the_law_at_each_vertex() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let (mesh, out) = (mesh_of(&start), text(&work.path("m.solb")));
    let spec = format!("{}:h=1e-4,growth=1.3", reference(&mesh));
    let arguments = ["metric", "wall", &start, "--cad", &model, "--wall", &spec, "--hmax", "0.2", "-o", &out];
    made(&[&arguments[..], &["--exact"]].concat());
    let metrics = tensors(&out);
    for (&p, metric) in mesh.vertices.iter().zip(&metrics) {
        let distance = p[0].hypot(p[1]) - 0.5;
        let across = f64::min(1e-4 + 0.3 * distance.max(0.0), 0.2);
        let about = f64::min(0.25 + 0.3 * distance.max(0.0), 0.5 * (8.0 * across * p[0].hypot(p[1])).sqrt());
        let expected = if across >= 0.2 { [0.2; 3] } else { [across, about.clamp(across, 0.2), 0.2] };
        for (axis, expected) in axes(p).into_iter().zip(expected) {
            let found = length(metric, axis);
            assert!((found / expected - 1.0).abs() < 1e-8, "{found} {expected} at {p:?}");
        }
    }
}

#[test]
fn an_intersection_keeps_the_size_across_the_wall() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let mesh = mesh_of(&start);
    let [wall, flow, both] = ["w.solb", "f.solb", "b.solb"].map(|name| text(&work.path(name)));
    let spec = format!("{}:h=1e-5", reference(&mesh));
    made(&["metric", "wall", &start, "--cad", &model, "--wall", &spec, "--exact", "-o", &wall]);
    write_tensors(Path::new(&flow), mesh.vertices.iter().map(|p| isotropic(0.02 + 0.1 * p[2])));
    made(&["metric", "intersect", &wall, &flow, "-o", &both]);
    let mut on = 0;
    for (&p, metric) in mesh.vertices.iter().zip(tensors(&both)) {
        if (p[0].hypot(p[1]) - 0.5).abs() < 1e-9 {
            let found = length(&metric, axes(p)[0]);
            assert!((found / 1e-5 - 1.0).abs() < 1e-8, "{found}");
            assert!(length(&metric, axes(p)[2]) <= (0.02 + 0.1 * p[2]) * (1.0 + 1e-8));
            on += 1;
        }
    }
    assert!(on > 20);
}

fn inspected(mesh: &str, model: &str, spec: &str) -> Value {
    let told = made(&["inspect", mesh, "--cad", model, "--wall", spec, "--json"]);
    serde_json::from_str::<Value>(&told).unwrap()["walls"][0].clone()
}

fn figure(found: &Value, name: &str) -> f64 {
    found[name].as_f64().unwrap_or_else(|| panic!("{name} in {found}"))
}

/// Cycles of metric and adaptation, the metric made anew on each mesh. The first one has vertices 0.1 apart for sizes of 1e-3, and chords that are
/// 0.01 from the cylinder.
#[test]
fn layers_are_there_after_one_cycle_and_stay() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let spec = format!("{}:h=1e-3,growth=1.2", reference(&mesh_of(&start)));
    let (mut input, metric) = (start, text(&work.path("m.solb")));
    let (mut found, mut counts) = (Vec::new(), Vec::new());
    for cycle in 1..=3 {
        let out = text(&work.path(&format!("{cycle}.meshb")));
        made(&["metric", "wall", &input, "--cad", &model, "--wall", &spec, "-o", &metric]);
        made(&["adapt", &input, "--cad", &model, "--metric", &metric, "-o", &out, "--threads", "1"]);
        if cycle == 1 {
            // Of files, too.
            let by_files = text(&work.path("f.meshb"));
            made(&["adapt", &input, "--cad", &model, "--metric", &metric, "-o", &by_files, "--memory", "1GB"]);
            found.push(inspected(&by_files, &model, &spec));
            counts.push(mesh_of(&by_files).vertices.len());
        }
        found.push(inspected(&out, &model, &spec));
        counts.push(mesh_of(&out).vertices.len());
        input = out;
    }
    let last = counts[3];
    assert!(counts[0].max(counts[1]) < last + last / 2, "{counts:?}");
    for layers in &found {
        // A unit mesh has the vertices opposite to the wall's triangles at √(2/3) of the size.
        let mean = figure(layers, "mean") / figure(layers, "asked");
        assert!((0.7..0.95).contains(&mean), "{layers}");
        assert!(figure(layers, "deviation") < 0.2, "{layers}");
        let share = figure(layers, "points") / figure(layers, "points_asked");
        assert!((0.9..1.15).contains(&share), "{layers}");
    }
}

/// Figures of a mesh in the metric of walls made anew on it: the share of unit edges, and the least mean ratio.
fn judged(work: &Workplace, mesh: &str, model: &str, spec: &str) -> [f64; 2] {
    let metric = text(&work.path("anew.solb"));
    made(&["metric", "wall", mesh, "--cad", model, "--wall", spec, "--hmax", "0.3", "-o", &metric, "-q"]);
    let told = made(&["inspect", mesh, "--metric", &metric, "--json"]);
    let found: Value = serde_json::from_str(&told).unwrap();
    [figure(&found["metric"], "unit_edges"), figure(&found["mean_ratios"], "min")]
}

fn report_of(path: &str) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Edges of 0.1, whose middles are 0.0025 off the cylinder, for layers of 1e-5: drafts come first, and the result is what its own metric asks for. Then no
/// drafts are needed.
#[test]
fn thin_layers_follow_a_curved_wall_in_one_run() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let spec = format!("{}:h=1e-5,growth=1.2", reference(&mesh_of(&start)));
    let [out, again, report] = ["1.meshb", "2.meshb", "r.json"].map(|name| text(&work.path(name)));
    let adapt = |input: &str, out: &str| {
        let common =
            ["adapt", input, "--cad", &model, "--size", "0.3", "--wall", &spec, "-o", out, "--report", &report];
        let run = run(&common);
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        (stderr(&run), report_of(&report))
    };
    let (told, first) = adapt(&start, &out);
    let drafts = first["drafts"].as_array().unwrap();
    assert!(drafts.len() >= 2 && told.contains("drafts with layers"), "{told} {drafts:?}");
    assert_eq!(first["input_vertices"], mesh_of(&start).vertices.len());
    let thicker: Vec<f64> = drafts.iter().map(|draft| figure(draft, "thicker")).collect();
    assert!(thicker.is_sorted_by(|a, b| a > b) && thicker.last() == Some(&10.0), "{thicker:?}");
    let [unit, least] = judged(&work, &out, &model, &spec);
    assert!(unit > 0.9 && least > 0.2, "{unit} {least}");
    let layers = inspected(&out, &model, &spec);
    let mean = figure(&layers, "mean") / figure(&layers, "asked");
    let share = figure(&layers, "points") / figure(&layers, "points_asked");
    assert!((0.75..0.95).contains(&mean) && (0.95..1.1).contains(&share), "{layers}");
    let (told, second) = adapt(&out, &again);
    assert!(second.get("drafts").is_none() && !told.contains("draft"), "{told}");
}

/// The metric of a field lies on the first mesh: drafts have it by interpolation, with the complexity that is asked for.
#[test]
fn drafts_keep_the_complexity_of_a_field() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let [field, report] = ["u.solb", "r.json"].map(|name| text(&work.path(name)));
    let spec = format!("{}:h=1e-4,growth=1.2", reference(&mesh_of(&start)));
    made(&["field", "evaluate", &start, "--function", "tanh3", "-o", &field, "-q"]);
    let wanted = |options: &[&str], name: &str| {
        let out = text(&work.path(name));
        let common = ["adapt", &start, "--cad", &model, "--field", &field, "--wall", &spec, "-o", &out];
        made(&[&common[..], &["--report", &report], options].concat());
        let told = report_of(&report);
        assert!(!told["drafts"].as_array().unwrap().is_empty(), "{told}");
        assert_eq!(told["multiscale"]["fields"].as_array().map(Vec::len), Some(1), "{told}");
        (mesh_of(&out).vertices.len(), told)
    };
    let (vertices, told) = wanted(&["--complexity", "12000"], "c.meshb");
    assert_eq!(told["multiscale"]["complexity_wanted"], 12000.0);
    assert!((18_000..30_000).contains(&vertices), "{vertices}");
    // What must stay has fewer vertices than the metric asks for: it takes more than one mesh to meet a number.
    let (vertices, told) = wanted(&["--vertices", "9000", "--freeze", "1,7"], "v.meshb");
    let meeting = &told["vertices_wanted"];
    assert!(figure(meeting, "meshes") > 1.0 && meeting["is_met"] == true, "{told}");
    assert!((8_100..9_900).contains(&vertices), "{vertices}");
}

/// Drafts need a mesh in memory as a whole, and surfaces that its references name.
#[test]
fn it_is_said_where_drafts_would_help_and_are_not_made() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let spec = format!("{}:h=1e-4,growth=1.2", reference(&mesh_of(&start)));
    let out = text(&work.path("m.meshb"));
    let common = ["adapt", &start, "--cad", &model, "--size", "0.3", "--wall", &spec, "-o", &out];
    let by_parts = run(&[&common[..], &["--memory", "2GB"]].concat());
    assert!(by_parts.status.code() == Some(0), "{}", stderr(&by_parts));
    assert!(stderr(&by_parts).contains("part by part no drafts are made"), "{}", stderr(&by_parts));
    // Half of the cylinder has another reference.
    let (mut mesh, mixed) = (mesh_of(&start), text(&work.path("mixed.meshb")));
    let wall = reference(&mesh);
    let is_right =
        |nodes: &[u32; 3]| nodes.iter().map(|&v| mesh.vertices[v as usize]).map(|p| p[0] - p[1]).sum::<f64>() > 0.0;
    let refs = mesh.triangles.iter().map(|(nodes, r)| if r == wall && is_right(&nodes) { 77 } else { r }).collect();
    mesh.triangles.refs = refs;
    io::write_mesh(Path::new(&mixed), &mesh).unwrap();
    let spec = format!("{wall}+77:h=1e-4,growth=1.2");
    std::fs::remove_file(&out).unwrap();
    let run = run(&["adapt", &mixed, "--cad", &model, "--size", "0.3", "--wall", &spec, "-o", &out]);
    assert!(run.status.code() == Some(0) && stderr(&run).contains("several references"), "{}", stderr(&run));
}

/// The sides x = 1 and y = 1 of the cube meet at right angles: as two walls, and as one.
#[test]
fn a_corner_of_two_walls_has_the_layers_of_both() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let mesh = mesh_of(&start);
    let [input, out] = ["in.meshb", "m.solb"].map(|name| text(&work.path(name)));
    let side = |axis: usize| {
        let on = |v: &u32| mesh.vertices[*v as usize][axis] == 1.0;
        mesh.triangles.iter().find(|(nodes, _)| nodes.iter().all(on)).unwrap().1
    };
    let sides = [side(0), side(1)];
    io::write_mesh(Path::new(&input), &mesh).unwrap();
    let [a, b] = sides.map(|side| format!(r#""{side}": {{"name": "sides"}}"#));
    std::fs::write(work.path("in.names.json"), format!(r#"{{"triangles": {{{a}, {b}}}}}"#)).unwrap();
    let two = format!("{}:h=1e-3,{}:h=2e-3", sides[0], sides[1]);
    let several = format!("{}+{}:h=1e-3", sides[0], sides[1]);
    for (spec, first) in [(two.as_str(), [1e-3, 2e-3]), ("sides:h=1e-3", [1e-3; 2]), (several.as_str(), [1e-3; 2])] {
        made(&["metric", "wall", &input, "--cad", &model, "--wall", spec, "--exact", "-o", &out]);
        for (p, metric) in mesh.vertices.iter().zip(tensors(&out)) {
            for (axis, direction) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].into_iter().enumerate() {
                let expected = f64::min(first[axis] + 0.2 * (1.0 - p[axis]), 3f64.sqrt() / 10.0);
                let found = length(&metric, direction);
                assert!((found / expected - 1.0).abs() < 1e-6, "{spec}: {found} {expected} at {p:?}");
            }
        }
    }
}

/// The metric of Spalding's law is exact at the vertices: on a mesh that was adapted to it the sizes on the wall stay.
#[test]
fn spaldings_law_has_its_complexity_and_stays() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let wall = reference(&mesh_of(&start));
    let spec = format!("{wall}:re=1e4,law=spalding");
    let (mut input, metric) = (start, text(&work.path("m.solb")));
    let mut sizes = Vec::new();
    for cycle in 1..=3 {
        let (out, report) = (text(&work.path(&format!("{cycle}.meshb"))), text(&work.path("r.json")));
        let wanted = ["--complexity", "2000", "--report", &report];
        let arguments = ["metric", "wall", &input, "--cad", &model, "--wall", &spec, "-o", &metric];
        made(&[&arguments[..], &wanted].concat());
        let told: Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        assert!((figure(&told["metric"], "complexity_between") / 2000.0 - 1.0).abs() < 0.01, "{told}");
        sizes.push(told["walls"][0]["first_heights"].clone());
        made(&["adapt", &input, "--cad", &model, "--metric", &metric, "-o", &out, "--threads", "1"]);
        input = out;
    }
    let [second, third] = [1, 2].map(|i: usize| sizes[i][0].as_f64().unwrap());
    assert!((second / third - 1.0).abs() < 0.1, "{sizes:?}");
    let refused = complaint(&run(&["metric", "wall", &input, "--cad", &model, "--wall", &spec, "-o", &metric]));
    assert!(refused.contains("--complexity"), "{refused}");
}

#[test]
fn adapt_keeps_the_layers_whatever_the_field_asks_for() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let spec = format!("{}:h=1e-3,growth=1.2", reference(&mesh_of(&start)));
    let mut input = PathBuf::from(&start);
    let field = text(&work.path("u.solb"));
    for cycle in 1..=3 {
        made(&["field", "evaluate", &text(&input), "--function", "tanh3", "-o", &field, "-q"]);
        let wanted = ["--cad", &model, "--field", &field, "--complexity", "3000", "--wall", &spec];
        let found = work.adapt(&input, &wanted);
        input = work.path(&format!("{cycle}.meshb"));
        io::write_mesh(&input, &found.mesh).unwrap();
    }
    let layers = inspected(&text(&input), &model, &spec);
    let share = figure(&layers, "points") / figure(&layers, "points_asked");
    assert!((0.9..1.3).contains(&share) && figure(&layers, "mean") < 1e-3, "{layers}");
    // Layers that leave nothing to the field are enlarged, and that is said.
    made(&["field", "evaluate", &text(&input), "--function", "tanh3", "-o", &field, "-q"]);
    let few = ["--cad", &model, "--field", &field, "--complexity", "600", "--wall", &spec];
    let run = work.command(&input, &few).output().unwrap();
    assert!(
        run.status.code() == Some(0) && stderr(&run).contains("sizes in the layers are enlarged"),
        "{}",
        stderr(&run)
    );
}

#[test]
fn what_is_wrong_with_a_wall_is_said() {
    let (work, [model, start]) = (Workplace::new(), cube_cylinder());
    let out = text(&work.path("m.solb"));
    let wall = reference(&mesh_of(&start));
    let refused = |spec: &str| {
        let run = run(&["metric", "wall", &start, "--cad", &model, "--wall", spec, "--exact", "-o", &out]);
        let message = complaint(&run);
        assert!(!Path::new(&out).exists(), "{message}");
        message
    };
    for (spec, part) in [
        ("99:h=1e-4".to_owned(), "no surface with reference 99; its surfaces are"),
        ("wing:h=1e-4".to_owned(), "no surface or region called wing"),
        (format!("{wall}:h=0"), "give a positive number"),
        (format!("{wall}:h=1e-4,growth=1"), "give a number above 1"),
        (format!("{wall}:yplus=1"), "yplus needs the Reynolds number"),
        (format!("{wall}:h=1e-4,size=1"), "there are h, growth"),
    ] {
        let message = refused(&spec);
        assert!(message.contains(part), "{spec}: {message}");
    }
    let faces = complaint(&run(&["field", "distance", &start, "--cad", &model, "--faces", "wing", "-o", &out]));
    assert!(faces.contains("start.meshb") && faces.contains("--faces") && faces.contains("called wing"), "{faces}");
    let inner = run(&["inspect", &start, "--cad", &model, "--wall", &format!("{wall}:re=1e5,law=spalding")]);
    assert!(complaint(&inner).contains("give growth=1.2"));
}
