//! `geo-adapt metric geometry`: sizes from the curvature of a model, and from what is thin or near.

use crate::common::adapting::volumes;
use crate::common::{program, shared_case};
use geo_adapt::geometry::classify::{self, Classification};
use geo_adapt::geometry::{Discrete, Entity, Evaluate, Geometry, Model};
use geo_adapt::mesh::vector::{Vec3, add, cross, distance, dot, scale, sub, unit};
use geo_adapt::mesh::{TetMesh, io, validity};
use geo_adapt::metric::field::complexity_between;
use geo_adapt::metric::{Field, Sym3, grade, plane_basis};
use geo_adapt::sizing::{Options, Summary, geometry_metric, resolved_metric};
use geo_adapt::tasks::{Plan, Pool, Team};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

const Z: Vec3 = [0.0, 0.0, 1.0];

fn model_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry").join(format!("{name}.step"))
}

fn model(name: &str) -> Model {
    Model::read(&model_path(name)).unwrap()
}

/// A surface mesh that grows piece by piece; points that coincide are one vertex.
#[derive(Default)]
struct Surface(TetMesh);

impl Surface {
    fn vertex(&mut self, p: Vec3) -> u32 {
        let known = self.0.vertices.iter().position(|&q| distance(p, q) < 1e-9);
        known.unwrap_or_else(|| {
            self.0.vertices.push(p);
            self.0.vertex_refs.push(0);
            self.0.vertices.len() - 1
        }) as u32
    }

    fn triangle(&mut self, corners: [Vec3; 3], reference: i32) {
        let nodes = corners.map(|p| self.vertex(p));
        if nodes[0] != nodes[1] && nodes[1] != nodes[2] && nodes[2] != nodes[0] {
            self.0.triangles.push(nodes, reference);
        }
    }

    /// A grid of n × m quadrilaterals, two triangles each; where a side has no length, one.
    fn grid(&mut self, [n, m]: [usize; 2], reference: i32, mut at: impl FnMut(f64, f64) -> Vec3) {
        let mut point = |i: usize, j: usize| at(i as f64 / n as f64, j as f64 / m as f64);
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
            self.triangle([a, b, c], reference);
            self.triangle([a, c, d], reference);
        }
    }
}

/// A frame (x, y, z) with this z.
fn frame(z: Vec3) -> [Vec3; 3] {
    let (x, y) = plane_basis(z);
    [x, y, z]
}

fn combine(origin: Vec3, [x, y, z]: [Vec3; 3], [a, b, c]: Vec3) -> Vec3 {
    add(origin, add(scale(x, a), add(scale(y, b), scale(z, c))))
}

/// A surface of revolution about z from (ρ, z) = profile(s), s in 0..1; closed about its axis.
fn revolved([n, m]: [usize; 2], reference: i32, surface: &mut Surface, profile: impl Fn(f64) -> [f64; 2]) {
    surface.grid([n, m], reference, |u, s| {
        let ([rho, z], (sin, cos)) = (profile(s), (TAU * u).sin_cos());
        if rho < 1e-12 { [0.0, 0.0, z] } else { [rho * cos, rho * sin, z] }
    });
}

fn sphere(n: usize) -> TetMesh {
    let mut surface = Surface::default();
    revolved([2 * n, n], 1, &mut surface, |s| [0.5 * (PI * s).sin(), -0.5 * (PI * s).cos()]);
    let axes = frame(unit([1.0, 2.0, 2.0]));
    surface.0.vertices.iter_mut().for_each(|p| *p = combine([0.1, 0.2, 0.3], axes, *p));
    surface.0
}

fn torus([n, m]: [usize; 2]) -> TetMesh {
    let mut surface = Surface::default();
    revolved([n, m], 1, &mut surface, |s| [1.0 + 0.3 * (TAU * s).cos(), 0.3 * (TAU * s).sin()]);
    surface.0
}

fn cylinder() -> TetMesh {
    let mut surface = Surface::default();
    revolved([24, 10], 1, &mut surface, |s| [0.25, s]);
    revolved([24, 4], 2, &mut surface, |s| [0.25 * s, 0.0]);
    revolved([24, 4], 3, &mut surface, |s| [0.25 * s, 1.0]);
    surface.0
}

fn cone() -> TetMesh {
    let mut surface = Surface::default();
    revolved([24, 12], 1, &mut surface, |s| [0.5 * s, 1.0 - s]);
    revolved([24, 4], 2, &mut surface, |s| [0.5 * s, 0.0]);
    surface.0
}

/// Each face of the wing as a grid between its edges, the flat ends as strips between their two curves.
fn wing(model: &Model, [n, m]: [usize; 2]) -> TetMesh {
    let (mut surface, mut evaluator) = (Surface::default(), model.evaluator());
    let topology = model.topology();
    for face in 0..2 {
        let [[u0, u1], [v0, v1]] = topology.faces[face as usize].range;
        surface.grid([n, m], face + 1, |s, t| {
            evaluator.face_frame(face as u32, [u0 + s * (u1 - u0), v0 + t * (v1 - v0)]).point
        });
    }
    for face in 2..4 {
        let edges: Vec<u32> = topology.faces[face].edges.clone();
        surface.grid([n, 4], face as i32 + 1, |s, t| {
            let [p, q] = [0, 1].map(|i: usize| {
                let [first, last] = topology.edges[edges[i] as usize].range;
                evaluator.edge_frame(edges[i], first + s * (last - first)).point
            });
            add(scale(p, 1.0 - t), scale(q, t))
        });
    }
    surface.0
}

/// A polygon in the plane of x and z, cut into triangles, drawn out from y = 0 to y = depth; each side has `m` strips.
fn prism(polygon: &[[f64; 2]], triangles: &[[usize; 3]], depth: f64, m: usize) -> TetMesh {
    let mut surface = Surface::default();
    for (reference, y) in [(1, 0.0), (2, depth)] {
        for t in triangles {
            surface.triangle(t.map(|i| [polygon[i][0], y, polygon[i][1]]), reference);
        }
    }
    for (i, [[a, b], [c, d]]) in (0..).zip((0..polygon.len()).map(|i| [polygon[i], polygon[(i + 1) % polygon.len()]])) {
        surface.grid([1, m], i + 3, |s, t| [a + s * (c - a), t * depth, b + s * (d - b)]);
    }
    surface.0
}

fn thin_plate() -> TetMesh {
    prism(&[[0.0, 0.0], [2.0, 0.0], [2.0, 0.02], [0.0, 0.02]], &[[0, 1, 2], [0, 2, 3]], 1.0, 1)
}

fn slot() -> TetMesh {
    let polygon = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.01, 1.0], [1.01, 0.4], [1.0, 0.4], [1.0, 1.0], [0.0, 1.0]];
    prism(&polygon, &[[0, 5, 6], [0, 6, 7], [0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]], 1.0, 1)
}

fn lies(mesh: &TetMesh, model: &Model) -> Classification {
    classify::classify(Team::alone(), mesh, model, &classify::Options::default()).unwrap().0
}

/// The curvature alone, between sizes that do not clip it.
fn bare(greatest: f64) -> Options {
    Options { segments: 2.0, least: 1e-3, greatest, aspect_ratio: None, cells: None, gradation: None }
}

fn sized(mesh: &TetMesh, model: &Model, options: &Options) -> (Vec<Sym3>, Classification, Summary) {
    let place = lies(mesh, model);
    let (logs, summary) = geometry_metric(Team::alone(), mesh, &place, model, options);
    assert!(logs.iter().all(|log| log.0.iter().all(|x| x.is_finite())), "a metric is not finite");
    (logs.iter().map(Sym3::exp).collect(), place, summary)
}

/// How far the sizes of a metric are from those of another, in the worst direction: |h/h_exact − 1|.
fn deviation(metric: &Sym3, exact: &Sym3) -> f64 {
    let relative = metric.congruent(&exact.inverse_sqrt()).eigen_jacobi().values;
    relative.into_iter().map(|x| (1.0 / x.sqrt() - 1.0).abs()).fold(0.0, f64::max)
}

/// Holds every vertex against its exact metric, to one per cent (and says how near it is).
fn check(name: &str, mesh: &TetMesh, metrics: &[Sym3], exact: impl Fn(Vec3) -> Sym3) {
    let off: Vec<f64> = mesh.vertices.iter().zip(metrics).map(|(&p, metric)| deviation(metric, &exact(p))).collect();
    let worst = (0..off.len()).max_by(|&a, &b| off[a].total_cmp(&off[b])).unwrap();
    println!("{name}: {} vertices, greatest deviation {:.1e}", off.len(), off[worst]);
    assert!(off[worst] < 0.01, "{name}: off by {} at {:?}: {:?}", off[worst], mesh.vertices[worst], metrics[worst]);
}

fn sizes_along(metric: &Sym3, direction: Vec3) -> f64 {
    metric.quadratic(direction).powf(-0.5)
}

#[test]
fn a_sphere_has_its_radius_everywhere_its_poles_too() {
    let (model, mesh) = (model("sphere"), sphere(20));
    let (metrics, _, summary) = sized(&mesh, &model, &bare(10.0));
    check("sphere", &mesh, &metrics, |_| Sym3::IDENTITY.times(16.0));
    assert_eq!(summary.singular, 2);
    let poles: Vec<usize> = (0..mesh.vertices.len())
        .filter(|&v| model.topology().vertices.iter().any(|pole| distance(pole.point, mesh.vertices[v]) < 1e-12))
        .collect();
    assert_eq!(poles.len(), 2);
    for pole in poles {
        let off = deviation(&metrics[pole], &Sym3::IDENTITY.times(16.0));
        assert!(off < 1e-9, "a pole is as good as any point: {off}");
    }
}

#[test]
fn a_torus_has_two_curvatures() {
    let (model, mesh) = (model("torus"), torus([48, 24]));
    let (metrics, ..) = sized(&mesh, &model, &bare(50.0));
    check("torus", &mesh, &metrics, |p| {
        let rho = p[0].hypot(p[1]);
        let (out, cos) = ([p[0] / rho, p[1] / rho, 0.0], (rho - 1.0) / 0.3);
        let normal = unit(sub(p, out));
        let along = cross(Z, out);
        let across = cross(normal, along);
        let long = (rho / (2.0 * cos.abs())).min(50.0);
        Sym3::from_sizes([along, across, normal], [long, 0.15, 0.15])
    });
}

#[test]
fn a_cylinder_and_its_rims() {
    let (model, mesh) = (model("cylinder"), cylinder());
    let (metrics, ..) = sized(&mesh, &model, &bare(10.0));
    check("cylinder", &mesh, &metrics, |p| {
        if p[0].hypot(p[1]) < 0.2499 { Sym3::IDENTITY.times(0.01) } else { Sym3::diagonal(64.0, 64.0, 0.01) }
    });
}

#[test]
fn a_cone_down_to_its_apex() {
    let (model, mesh) = (model("cone"), cone());
    let (metrics, _, summary) = sized(&mesh, &model, &bare(10.0));
    let slope = 5f64.sqrt();
    check("cone", &mesh, &metrics, |p| {
        let rho = p[0].hypot(p[1]);
        if p[2] > 1.0 - 1e-9 {
            // The limit from all around: the least size.
            return Sym3::IDENTITY.times(1e6);
        }
        if p[2] < 1e-9 && rho < 0.4999 {
            return Sym3::IDENTITY.times(0.01);
        }
        let (out, around) = ([p[0] / rho, p[1] / rho, 0.0], [-p[1] / rho, p[0] / rho, 0.0]);
        let normal = unit(add(out, scale(Z, 0.5)));
        // κ = cos a/ρ, tan a = 0.5; the rim is a circle.
        let wall = rho * slope / 2.0 / 2.0;
        let along = if p[2] < 1e-9 { rho / 2.0 } else { wall };
        Sym3::from_sizes([around, cross(normal, around), normal], [along, 10.0, wall])
    });
    assert_eq!(summary.singular, 1);
}

#[test]
fn poles_without_a_closed_form_take_the_limit() {
    let model = model("spheroid");
    let mut surface = Surface::default();
    revolved([32, 32], 1, &mut surface, |s| [0.5 * (PI * s).sin(), -(PI * s).cos()]);
    let (metrics, _, summary) = sized(&surface.0, &model, &bare(10.0));
    assert_eq!(summary.singular, 2);
    let (a, b) = (1.0f64, 0.5f64);
    check("spheroid", &surface.0, &metrics, |p| {
        let rho = p[0].hypot(p[1]);
        // Along the meridian (ρ²/b⁴ + z²/a⁴)^(-3/2)/(a²b²), round it (…)^(-1/2)/b².
        let s = rho * rho / b.powi(4) + p[2] * p[2] / a.powi(4);
        let (meridian, parallel) = (s.powf(-1.5) / (a * a * b * b), s.powf(-0.5) / (b * b));
        let normal = unit([p[0] / (b * b), p[1] / (b * b), p[2] / (a * a)]);
        let around = if rho > 1e-9 { [-p[1] / rho, p[0] / rho, 0.0] } else { [0.0, 1.0, 0.0] };
        let h = [parallel, meridian].map(|k: f64| 1.0 / (2.0 * k));
        Sym3::from_sizes([around, cross(normal, around), normal], [h[0], h[1], h[0].min(h[1])])
    });
}

/// The metric of a face at a point from how its normal turns between closest points: nothing of the model's second derivatives is used.
fn by_differences(model: &Model, face: u32, p: Vec3, guess: [f64; 2], options: &Options) -> Option<Sym3> {
    const STEP: f64 = 1e-5;
    let mut evaluator = model.evaluator();
    let normal = evaluator.face_normal(face, guess);
    let (u, w) = plane_basis(normal);
    let mut at = |q: Vec3| {
        let on = evaluator.closest_on_face(face, q, Some(guess));
        (on.point, evaluator.face_normal(face, on.uv))
    };
    let [(d1, n1), (d2, n2)] = [u, w].map(|e| {
        let (ahead, behind) = (at(add(p, scale(e, STEP))), at(sub(p, scale(e, STEP))));
        (sub(ahead.0, behind.0), sub(ahead.1, behind.1))
    });
    // −S D = N in the basis (u, w).
    let [[a, c], [b, d]] = [d1, d2].map(|x| [dot(x, u), dot(x, w)]);
    let determinant = a * d - b * c;
    if determinant < STEP * STEP {
        return None;
    }
    let [[e, g], [f, h]] = [n1, n2].map(|x| [-dot(x, u), -dot(x, w)]);
    let (s11, s12) = ((e * d - f * c) / determinant, (f * a - e * b) / determinant);
    let (s21, s22) = ((g * d - h * c) / determinant, (h * a - g * b) / determinant);
    let shape = Sym3::outer(u, s11)
        .plus(Sym3::outer(w, s22))
        .plus(Sym3::outer(add(u, w), 0.25 * (s12 + s21)).plus(Sym3::outer(sub(u, w), -0.25 * (s12 + s21))));
    let (mean, half, cross_term) = (0.5 * (s11 + s22), 0.5 * (s11 - s22), 0.5 * (s12 + s21));
    let root = half.hypot(cross_term);
    let (sin, cos) = (0.5 * cross_term.atan2(half)).sin_cos();
    let first = add(scale(u, cos), scale(w, sin));
    assert!((shape.quadratic(first) - mean - root).abs() < 1e-6 * (1.0 + mean.abs() + root));
    let sizes = [mean + root, mean - root].map(|k| (1.0 / (2.0 * k.abs())).clamp(options.least, options.greatest));
    Some(Sym3::from_sizes([first, cross(normal, first), normal], [sizes[0], sizes[1], sizes[0].min(sizes[1])]))
}

#[test]
fn a_wing_turns_as_its_closest_points_do() {
    let model = model("wing");
    let mesh = wing(&model, [40, 20]);
    let options = Options { least: 1e-4, ..bare(2.0) };
    let (metrics, place, _) = sized(&mesh, &model, &options);
    let (mut seen, mut worst) = (0, 0.0f64);
    for (v, metric) in metrics.iter().enumerate() {
        let Entity::Face(face @ 0..2) = place.entities[v] else { continue };
        let Some(exact) = by_differences(&model, face, mesh.vertices[v], place.parameters[v], &options) else {
            continue;
        };
        let off = deviation(metric, &exact);
        assert!(off < 0.01, "off by {off} at {:?}: {metric:?} {exact:?}", mesh.vertices[v]);
        worst = worst.max(off);
        seen += 1;
    }
    println!("wing: {seen} vertices, greatest deviation {worst:.1e}");
    assert!(seen > 1300, "only {seen} vertices were compared");
    // At the nose all that its two faces ask for is granted: a radius of about 0.0158 chords, in half radians.
    let nose = (0..metrics.len()).filter(|&v| distance(mesh.vertices[v], [0.3, 1.0, 0.0]) < 1e-9);
    let sizes: Vec<f64> = nose.map(|v| sizes_along(&metrics[v], Z)).collect();
    assert!(sizes.len() == 1 && (0.003..0.012).contains(&sizes[0]), "{sizes:?}");
}

#[test]
fn a_thin_plate_is_fine_across_and_nowhere_else() {
    let (model, mesh) = (model("thin-plate"), thin_plate());
    let options = Options { gradation: None, ..Options::of(model.topology()) };
    let (metrics, _, summary) = sized(&mesh, &model, &options);
    for metric in &metrics {
        assert!((sizes_along(metric, Z) / 0.01 - 1.0).abs() < 1e-6, "{metric:?}");
        for along in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
            assert!((sizes_along(metric, along) / options.greatest - 1.0).abs() < 1e-6, "{metric:?}");
        }
    }
    assert_eq!(summary.at_gaps, 8);
    assert!((summary.nearest_gap.unwrap().distance - 0.02).abs() < 1e-12);
    let (metrics, _, summary) = sized(&mesh, &model, &Options { cells: None, ..options });
    assert!(metrics.iter().all(|m| deviation(m, &Sym3::IDENTITY.times(options.greatest.powi(-2))) < 1e-9));
    assert_eq!((summary.at_gaps, summary.nearest_gap), (0, None));
}

#[test]
fn a_fine_mesh_of_a_thin_plate_is_fine_across_only() {
    let model = model("thin-plate");
    let xs = [0.0, 0.004, 0.01, 0.02, 0.03, 0.05, 0.1, 0.5, 1.0, 2.0];
    let n = xs.len();
    let polygon: Vec<[f64; 2]> = xs.iter().map(|&x| [x, 0.0]).chain(xs.iter().rev().map(|&x| [x, 0.02])).collect();
    let triangles: Vec<[usize; 3]> =
        (0..n - 1).flat_map(|i| [[i, i + 1, 2 * n - 2 - i], [i, 2 * n - 2 - i, 2 * n - 1 - i]]).collect();
    let mesh = prism(&polygon, &triangles, 1.0, 5);
    let options = Options { gradation: None, ..Options::of(model.topology()) };
    let (metrics, ..) = sized(&mesh, &model, &options);
    for (p, metric) in mesh.vertices.iter().zip(&metrics) {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], Z].map(|axis| sizes_along(metric, axis));
        assert!((z / 0.01 - 1.0).abs() < 1e-6 && x.min(y) > 0.999 * options.greatest, "{p:?} {x} {y} {z}");
    }
}

#[test]
fn a_slot_is_seen_by_its_walls_only() {
    let (model, mesh) = (model("slot"), slot());
    let options = Options { gradation: None, ..Options::of(model.topology()) };
    // Without what comes from between the vertices: a mesh that is fine enough has none.
    let x = [1.0, 0.0, 0.0];
    let (metrics, ..) = sized(&mesh, &model, &options);
    for (p, metric) in mesh.vertices.iter().zip(&metrics) {
        let across = sizes_along(metric, x);
        if (p[0] - 1.005).abs() < 0.01 {
            assert!((across / 0.005 - 1.0).abs() < 1e-6, "{p:?} {across}");
        } else {
            assert!(across > 0.2, "{p:?} {across}");
        }
        assert!(sizes_along(metric, [0.0, 1.0, 0.0]) > 0.2, "{p:?}");
    }
}

#[test]
fn a_coarse_mesh_misses_no_gap() {
    let model = model("sphere-in-box");
    let mut surface = Surface::default();
    revolved([24, 12], 7, &mut surface, |s| [0.3 * (PI * s).sin(), -0.3 * (PI * s).cos()]);
    surface.0.vertices.iter_mut().for_each(|p| *p = add(*p, [0.9, 0.8, 0.6]));
    let low = surface.0.vertices.len();
    let faces = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];
    for ([i, j, k], side) in faces.into_iter().flat_map(|axes| [(axes, 0.0), (axes, 1.0)]) {
        surface.grid([1, 1], 1 + 2 * i as i32 + side as i32, |s, t| {
            let mut p = [0.0; 3];
            (p[i], p[j], p[k]) = (side, s, t);
            [2.0 * p[0], 1.6 * p[1], 1.2 * p[2]]
        });
    }
    let mesh = surface.0;
    assert_eq!(mesh.vertices.len() - low, 8);
    // The box has its corners only, 1.04 from the sphere: too far to see it. Where they are nearest, sphere and box are 0.3 apart.
    let options = Options { cells: Some(1.7), gradation: Some(1.1), ..bare(0.6) };
    let (metrics, _, summary) = sized(&mesh, &model, &options);
    assert!(summary.between > 0);
    // Samples lie 0.3 apart: one of them is near the foot.
    assert!((0.3..0.31).contains(&summary.nearest_gap.unwrap().distance), "{summary:?}");
    for (p, metric) in mesh.vertices.iter().zip(&metrics).skip(low) {
        let across = sizes_along(metric, Z);
        // Grown from where the sphere is nearest; beside it the gap is wider and this corner nearer.
        let foot = distance(*p, [0.9, 0.8, p[2]]);
        let most = 0.3 / 1.7 + 1.1f64.ln() * foot;
        assert!(across < 1.1 * most && across > 0.7 * most, "{across} {most}");
    }
}

/// The cone in n tetrahedra about its axis.
fn coarse_cone(n: u32) -> TetMesh {
    let mut mesh = TetMesh { vertices: vec![[0.0; 3], [0.0, 0.0, 1.0]], ..TetMesh::default() };
    for i in 0..n {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        mesh.vertices.push([0.5 * cos, 0.5 * sin, 0.0]);
        let [a, b] = [2 + i, 2 + (i + 1) % n];
        mesh.tets.push([0, a, b, 1], 1);
        mesh.triangles.push([a, b, 1], 1);
        mesh.triangles.push([0, b, a], 2);
    }
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    mesh
}

#[test]
fn a_few_vertices_resolve_an_apex_as_well_as_many() {
    let model = model("cone");
    let complexity = |n: u32| {
        let mesh = coarse_cone(n);
        let place = lies(&mesh, &model);
        let mut resolved =
            resolved_metric(Team::alone(), &mesh, &place, &model, (&Options::of(model.topology()), None));
        grade(Team::alone(), resolved.halved.as_ref().map_or(&mesh, |halved| &halved.mesh), &mut resolved.logs, 1.5);
        let on = resolved.mesh(&mesh);
        assert!(validity::check(on).is_valid());
        assert_eq!(resolved.added(), on.vertices.len() - mesh.vertices.len());
        let own = complexity_between(Team::alone(), &mesh, &resolved.logs[..mesh.vertices.len()]);
        let found = complexity_between(Team::alone(), on, &resolved.logs);
        println!("cone of {n} tetrahedra: {own:.0}, on a mesh that resolves it {found:.0}");
        assert!(own < 3.0 * found && own > 0.3 * found, "{n}: {own:.1e} {found}");
        // A unit of volume: the cone of six sides is smaller.
        found / volumes(&mesh).values().sum::<f64>()
    };
    let [few, many] = [complexity(6), complexity(48)];
    assert!((few / many - 1.0).abs() < 0.2, "{few} {many}");
}

#[test]
fn a_few_vertices_ask_for_no_more_than_the_geometry_does() {
    let model = model("cone");
    let mesh = coarse_cone(6);
    let place = lies(&mesh, &model);
    let options = Options { gradation: Some(1.5), ..Options::of(model.topology()) };
    let (logs, _) = geometry_metric(Team::alone(), &mesh, &place, &model, &options);
    let found = complexity_between(Team::alone(), &mesh, &logs);
    let resolved = resolved_metric(Team::alone(), &mesh, &place, &model, (&options, None));
    let right = complexity_between(Team::alone(), resolved.mesh(&mesh), &resolved.graded);
    println!("cone of 6 tetrahedra: {found:.0}, on a mesh that resolves it {right:.0}");
    // With ln M linear from the apex to the rim it was more by orders.
    assert!(found < 3.0 * right && found > 0.5 * right, "{found} {right}");
}

#[test]
fn sizes_grow_along_the_triangles_of_a_surface() {
    let (model, mesh) = (model("cone"), cone());
    let steep = bare(10.0);
    let options = Options { gradation: Some(1.3), ..steep };
    let (bare, ..) = sized(&mesh, &model, &steep);
    let (graded, _, summary) = sized(&mesh, &model, &options);
    assert!(summary.graded > 300, "{summary:?}");
    let growth = |metrics: &[Sym3]| {
        let edges = mesh.triangles.nodes.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let ends = edges.map(|ends| {
            let [p, q] = ends.map(|v| mesh.vertices[v as usize]);
            let [a, b] = ends.map(|v| sizes_along(&metrics[v as usize], unit(sub(q, p))));
            (a - b).abs() / distance(p, q)
        });
        ends.fold(0.0, f64::max)
    };
    // Physical growth is ln 1.3 a length; an eighth of it is not counted in space.
    assert!(growth(&bare) > 10.0 && growth(&graded) < 0.5, "{} {}", growth(&bare), growth(&graded));
}

#[test]
fn a_sphere_of_triangles_is_estimated() {
    let mesh = sphere(24);
    let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, 45.0).unwrap();
    let (logs, _) = geometry_metric(Team::alone(), &mesh, &place, &Model::Discrete(model), &bare(10.0));
    let off: Vec<f64> = logs.iter().map(|log| deviation(&log.exp(), &Sym3::IDENTITY.times(16.0))).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    println!("sphere of triangles: greatest deviation {:.3}, mean {mean:.3}", off.iter().copied().fold(0.0, f64::max));
    assert!(off.iter().all(|&x| x < 0.1) && mean < 0.03, "mean {mean}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let model = model("slot");
    for (model, mesh) in [(model, slot()), (self::model("torus"), torus([96, 48]))] {
        let place = lies(&mesh, &model);
        let options = Options::of(model.topology());
        let (alone, summary) = geometry_metric(Team::alone(), &mesh, &place, &model, &options);
        for threads in [2, 3] {
            let pool = Pool::new(threads).unwrap();
            let team = Team::new(&pool, Plan::default());
            assert_eq!(geometry_metric(team, &mesh, &place, &model, &options), (alone.clone(), summary));
        }
    }
}

/// Runs the program on a mesh; its exit code, and what it printed on both channels.
fn run(mesh: &TetMesh, arguments: &[&str]) -> (tempfile::TempDir, Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    io::write_mesh(&folder.path().join("in.meshb"), mesh).unwrap();
    let output = program()
        .current_dir(folder.path())
        .args(["metric", "geometry", "in.meshb"])
        .args(arguments)
        .output()
        .expect("the program starts");
    let text = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (folder, output.status.code(), text)
}

#[test]
fn the_command_writes_metric_table_and_report() {
    let mesh = sphere(20);
    let cad = model_path("sphere");
    let arguments = ["--cad", cad.to_str().unwrap(), "-o", "out.solb", "--gradation", "off", "--report", "r.json"];
    let (folder, code, text) = run(&mesh, &arguments);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("on faces") && text.contains("at poles and apices        2 vertices"), "{text}");
    let metrics = Field::read(&folder.path().join("out.solb"), mesh.vertices.len()).unwrap().content.metrics;
    // The diagonal is √3: a tenth of it is less than r/2.
    check("sphere by the command", &mesh, &metrics, |_| Sym3::IDENTITY.times(100.0 / 3.0));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(report["on_faces"], mesh.vertices.len());
    assert_eq!(report["options"]["segments"], 2.0);
    let (_folder, code, text) = run(&mesh, &["-o", "out.sol", "-q"]);
    assert_eq!((code, text.as_str()), (Some(0), ""), "without --cad, and quiet");
}

#[test]
fn errors_say_what_and_where() {
    let mesh = sphere(6);
    let cad = model_path("torus");
    let cad = cad.to_str().unwrap();
    for (arguments, expected) in [
        (vec!["--cad", "none.step", "-o", "out.solb"], "none.step"),
        (vec!["--cad", cad, "-o", "out.solb"], "in.meshb on"),
        (vec!["-o", "out.meshb"], "must end in .sol or .solb"),
        (vec!["-o", "out.solb", "--hmin", "2", "--hmax", "1"], "--hmin 2 is above --hmax 1"),
        (vec!["-o", "out.solb", "--feature-cells", "0"], "positive number, or off"),
        (vec!["-o", "out.solb", "--report", "in.json/r.json"], "there is no folder"),
    ] {
        let (folder, code, text) = run(&mesh, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {text}");
        assert!(text.contains(expected), "{arguments:?}: {text}");
        assert!(!folder.path().join("out.solb").exists());
    }
    let (_folder, code, text) = run(&TetMesh { triangles: Default::default(), ..sphere(6) }, &["-o", "out.solb"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("in.meshb") && text.contains("triangle"), "{text}");
}

#[test]
fn shared_meshes_have_finite_sizes_everywhere() {
    for (mesh, model) in [
        ("hemisphere-cylinder/hsc01.meshb", "hemisphere-cylinder/hemisph-cyl.stp"),
        ("onera-m6/onera_curvAdapt.meshb", "onera-m6/onera-m6-sharp-te.stp"),
        ("cube-cylinder/cube-cylinder.meshb", "cube-cylinder/cube-cylinder.step"),
    ] {
        let (Some(mesh), Some(path)) = (shared_case(mesh), shared_case(model)) else { return };
        let mesh = io::read_mesh(&mesh).unwrap().content;
        let model = Model::read(&path).unwrap();
        let options = Options::of(model.topology());
        let (metrics, place, summary) = sized(&mesh, &model, &options);
        println!("{}: {summary:?}", path.display());
        for (metric, entity) in metrics.iter().zip(&place.entities) {
            let sizes = metric.sizes();
            let within = |&h: &f64| h > options.least * (1.0 - 1e-6) && h < options.greatest * (1.0 + 1e-6);
            assert!(sizes.iter().all(within), "{entity}: {sizes:?}");
        }
        let inside = place.entities.iter().filter(|&&entity| entity == Entity::Interior).count();
        assert_eq!(summary.inside, inside);
    }
}
