//! Tests of the smooth patches on surfaces that are known, and on such as leave nothing to fit.
use super::samples::cube;
use super::{Discrete, DiscreteOptions, complete_boundary};
use crate::geometry::{Entity, Evaluate, Geometry};
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, area2, cross, distance, dot, norm, scale, sub, unit};
use crate::tasks::Team;
use std::f64::consts::TAU;

/// Numbers in (−1, 1), the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn surface(vertices: Vec<Vec3>, triangles: &[[u32; 3]]) -> TetMesh {
    let mut mesh = TetMesh { vertex_refs: vec![0; vertices.len()], vertices, ..TetMesh::default() };
    triangles.iter().for_each(|&nodes| mesh.triangles.push(nodes, 1));
    mesh
}

/// A grid over the unit square of parameters, uneven; in u it closes, in v where asked for.
fn grid(counts: [u32; 2], closes: bool, point: impl Fn(f64, f64) -> Vec3) -> TetMesh {
    let [nu, nv] = counts;
    let rows = if closes { nv } else { nv + 1 };
    let mut numbers = Numbers(11);
    let mut vertices = Vec::new();
    for j in 0..rows {
        for i in 0..nu {
            let off = if closes || (j > 0 && j < nv) { 0.2 } else { 0.0 };
            let u = (f64::from(i) + 0.2 * numbers.next()) / f64::from(nu);
            vertices.push(point(u, (f64::from(j) + off * numbers.next()) / f64::from(nv)));
        }
    }
    let at = |i: u32, j: u32| (j % rows) * nu + i % nu;
    let mut triangles = Vec::new();
    for (i, j) in (0..nu * nv).map(|k| (k % nu, k / nu)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let pair = if numbers.next() > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        triangles.extend(pair);
    }
    surface(vertices, &triangles)
}

/// A round ball about the origin: a cube's surface blown up and shaken.
fn ball(n: u32, noise: f64) -> TetMesh {
    let mut mesh = cube(n);
    complete_boundary(Team::alone(), &mut mesh);
    let mut numbers = Numbers(3);
    for p in &mut mesh.vertices {
        let q = sub(*p, [0.5; 3]).map(|x| (std::f64::consts::FRAC_PI_2 * x).tan());
        let shaken = unit(q).map(|x| x + 0.2 / f64::from(n) * numbers.next());
        *p = scale(unit(shaken), 1.0 + noise * numbers.next());
    }
    mesh.triangles.refs.fill(1);
    mesh.tets = Default::default();
    mesh
}

fn torus(u: f64, v: f64) -> Vec3 {
    let [(sa, ca), (sb, cb)] = [u, v].map(|x| (TAU * x).sin_cos());
    [(1.0 + 0.4 * cb) * ca, (1.0 + 0.4 * cb) * sa, 0.4 * sb]
}

fn smooth(mesh: &TetMesh, ridge_angle_deg: f64) -> Discrete {
    Discrete::new(Team::alone(), mesh, &DiscreteOptions { ridge_angle_deg, smooth: true }).unwrap().0
}

/// Places over all triangles and points of the model there, with normals.
fn samples(model: &Discrete, mesh: &TetMesh, face: u32) -> Vec<(Vec3, Vec3)> {
    let mut evaluator = model.evaluator();
    let mut found = Vec::new();
    for nodes in &mesh.triangles.nodes {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        for (v, w) in [(0.33, 0.33), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.1, 0.2), (0.7, 0.2)] {
            let p = std::array::from_fn(|i| (1.0 - v - w) * a[i] + v * b[i] + w * c[i]);
            let on = evaluator.closest_on_face(face, p, None);
            let frame = evaluator.face_frame(face, on.uv);
            assert!(distance(frame.point, on.point) < 1e-10, "parameters name the point");
            found.push((on.point, frame.normal));
        }
    }
    found
}

#[test]
fn surfaces_come_out_to_the_fourth_order() {
    let on_torus = |p: Vec3| ((p[0].hypot(p[1]) - 1.0).hypot(p[2]) - 0.4).abs();
    let on_cylinder = |p: Vec3| (p[0].hypot(p[1]) - 1.0).abs();
    let cylinder = |u: f64, v: f64| [(TAU * u).cos(), (TAU * u).sin(), 2.0 * v];
    type Case<'a> = (&'a str, Box<dyn Fn(u32) -> TetMesh>, Box<dyn Fn(Vec3) -> f64>, f64);
    let cases: [Case; 3] = [
        ("ball", Box::new(|n| ball(n, 0.0)), Box::new(|p| (norm(p) - 1.0).abs()), 3e-5),
        ("torus", Box::new(|n| grid([5 * n, 2 * n], true, torus)), Box::new(on_torus), 7e-4),
        ("cylinder", Box::new(move |n| grid([4 * n, n], false, cylinder)), Box::new(on_cylinder), 1e-5),
    ];
    for (name, mesh, off, bound) in cases {
        let worst = [8, 16].map(|n| {
            let mesh = mesh(n);
            let model = smooth(&mesh, 60.0);
            assert_eq!(model.topology().faces.len(), 1, "{name}");
            samples(&model, &mesh, 0).iter().map(|(p, _)| off(*p)).fold(0.0, f64::max)
        });
        assert!(worst[0] < bound && worst[1] < worst[0] / 8.0, "{name}: {worst:?}");
    }
}

#[test]
fn normals_and_curvatures_are_those_of_the_ball() {
    let mesh = ball(8, 0.0);
    let model = smooth(&mesh, 60.0);
    let mut evaluator = model.evaluator();
    for (p, normal) in samples(&model, &mesh, 0) {
        assert!(distance(normal, unit(p)) < 3e-3, "{p:?} {normal:?}");
        let on = evaluator.closest_on_face(0, p, None);
        let frame = evaluator.face_frame(0, on.uv);
        assert!(frame.curvatures.iter().all(|k| (k + 1.0).abs() < 0.03), "{:?}", frame.curvatures);
        assert!(norm(sub(unit(cross(frame.du, frame.dv)), frame.normal)) < 1e-12);
    }
}

#[test]
fn the_foot_of_a_point_is_perpendicular_whatever_the_guess() {
    let mesh = ball(8, 0.0);
    let model = smooth(&mesh, 60.0);
    let mut evaluator = model.evaluator();
    let mut numbers = Numbers(5);
    for _ in 0..300 {
        let direction = unit(std::array::from_fn(|_| numbers.next()));
        let p = scale(direction, 1.0 + 0.4 * numbers.next());
        let guess = [(1.0 + numbers.next()) * 300.0, 0.3];
        let on = evaluator.closest_on_face(0, p, Some(guess));
        assert!((on.distance - (norm(p) - 1.0).abs()).abs() < 3e-5, "{on:?}");
        let normal = evaluator.face_normal(0, on.uv);
        // Across a kink of patches, which meet nearly without one, it may lie by as much as their normals differ.
        assert!(norm(cross(unit(sub(p, on.point)), normal)) < 3e-3, "{on:?}");
    }
    let lost = evaluator.closest_on_face(0, [f64::NAN; 3], None);
    assert!(lost.distance.is_nan() || lost.distance >= 0.0);
}

#[test]
fn a_line_between_references_leaves_the_ball_smooth() {
    let mut mesh = ball(8, 0.0);
    let mut block = cube(8);
    complete_boundary(Team::alone(), &mut block);
    for t in 0..mesh.triangles.len() {
        let middle = block.triangles.nodes[t].iter().map(|&v| block.vertices[v as usize][2]).sum::<f64>();
        mesh.triangles.refs[t] = if middle > 1.5 { 1 } else { 2 };
    }
    let model = smooth(&mesh, 60.0);
    assert_eq!([model.topology().edges.len(), model.topology().faces.len()], [1, 2]);
    let mut evaluator = model.evaluator();
    let length = model.topology().edges[0].range[1];
    for k in 0..200 {
        let t = length * f64::from(k) / 200.0;
        let p = evaluator.edge_frame(0, t).point;
        assert!((norm(p) - 1.0).abs() < 1e-3, "{}", norm(p));
        let normals = [0, 1].map(|face| {
            let uv = evaluator.edge_on_face(0, t, face).unwrap();
            evaluator.face_normal(face, uv)
        });
        assert!(distance(normals[0], normals[1]) < 0.02, "{normals:?}");
    }
}

/// A tin: a cylinder of height 2 between two disks.
fn tin(n: u32) -> TetMesh {
    let mut mesh = grid([4 * n, n], false, |u, v| [(TAU * u).cos(), (TAU * u).sin(), 2.0 * v]);
    for (row, z) in [(0, 0.0), (n, 2.0)] {
        let middle = mesh.vertices.len() as u32;
        mesh.vertices.push([0.0, 0.0, z]);
        for i in 0..4 * n {
            let [a, b] = [row * 4 * n + i, row * 4 * n + (i + 1) % (4 * n)];
            mesh.triangles.push(if row == 0 { [b, a, middle] } else { [a, b, middle] }, 1);
        }
    }
    mesh.vertex_refs = vec![0; mesh.vertices.len()];
    mesh
}

#[test]
fn a_tin_keeps_its_rims_and_its_lids() {
    let mesh = tin(8);
    let (model, classification) = Discrete::from_mesh(Team::alone(), &mesh, 45.0).unwrap();
    let topology = model.topology();
    assert_eq!([topology.vertices.len(), topology.edges.len(), topology.faces.len()], [0, 2, 3]);
    let mut evaluator = model.evaluator();
    for (edge, entity) in topology.edges.iter().enumerate() {
        let length = entity.range[1];
        assert!((length - TAU).abs() < 1e-5, "{length}");
        for k in 0..500 {
            let t = length * f64::from(k) / 500.0;
            let frame = evaluator.edge_frame(edge as u32, t);
            let off = (frame.point[0].hypot(frame.point[1]) - 1.0).abs();
            assert!(off < 2e-6 && frame.point[2] == frame.point[2].round(), "{off} {frame:?}");
            assert!((frame.curvature() - 1.0).abs() < 0.02 && (norm(frame.d1) - 1.0).abs() < 0.01);
            for &face in &entity.faces {
                let uv = evaluator.edge_on_face(edge as u32, t, face).unwrap();
                assert!(
                    distance(evaluator.face_frame(face, uv).point, frame.point) < 1e-11,
                    "the rim is on both faces"
                );
                // What lies on the rim lies on the faces beside it.
                assert!(evaluator.closest_on_face(face, frame.point, None).distance < 1e-11);
            }
            let off = evaluator.closest_on_edge(edge as u32, scale(frame.point, 1.1), Some(t + 0.4));
            assert!((off.distance - 0.1 * norm(frame.point)).abs() < 0.2, "{off:?}");
        }
    }
    for (v, entity) in classification.entities.iter().enumerate() {
        let Entity::Face(face) = *entity else { continue };
        let on = evaluator.closest_on_face(face, mesh.vertices[v], None);
        assert!(on.distance < 1e-13 && distance(on.point, classification.projected[v]) < 1e-12);
    }
    let lids: Vec<u32> = (0..3).filter(|&f| topology.faces[f as usize].edges.len() == 1).collect();
    for face in lids {
        for k in 0..100 {
            let angle = TAU * f64::from(k) / 100.0;
            // Beyond the chords, within the rim.
            let p = [0.999 * angle.cos(), 0.999 * angle.sin(), topology.faces[face as usize].bounds[0][2]];
            let on = evaluator.closest_on_face(face, p, None);
            assert!(on.distance < 1e-12, "{on:?}");
            assert!(evaluator.face_frame(face, on.uv).curvatures == [0.0; 2]);
        }
    }
}

#[test]
fn planes_and_straight_ridges_stay_exact() {
    // A block with rounded edges along y: planes go over into quarters of cylinders without a ridge.
    let (r, per) = (0.3, 4u32);
    let mut profile: Vec<[f64; 2]> = Vec::new();
    for (k, centre) in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].iter().enumerate() {
        for i in 0..=per {
            let angle = TAU * (k as f64 + f64::from(i) / f64::from(per)) / 4.0;
            profile.push([centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]);
        }
        let next = [[-1.0, 1.0 + r], [-1.0 - r, -1.0], [1.0, -1.0 - r], [1.0 + r, 1.0]][k];
        let last = profile[profile.len() - 1];
        profile
            .extend([0.25, 0.5, 0.75].map(|s| [last[0] + s * (next[0] - last[0]), last[1] + s * (next[1] - last[1])]));
    }
    let n = profile.len() as u32;
    let mesh = grid_of(&profile, 6);
    let model = smooth(&mesh, 45.0);
    assert_eq!(model.topology().faces.len(), 1);
    let mut round = 0.0f64;
    for (p, normal) in samples(&model, &mesh, 0) {
        let [x, z] = [p[0].abs(), p[2].abs()];
        if x < 1.0 - 1e-6 || z < 1.0 - 1e-6 {
            let off = if x < z { (z - 1.0 - r).abs() } else { (x - 1.0 - r).abs() };
            assert!(off < 1e-12, "{p:?}");
            assert!(normal.iter().filter(|c| c.abs() > 1e-9).count() == 1, "{normal:?}");
        } else {
            round = round.max(((x - 1.0).hypot(z - 1.0) - r).abs());
        }
    }
    assert!(round < 5e-3 * r, "{round} at {n} points");
    // The open ends are ridges: their straight parts are straight.
    let mut evaluator = model.evaluator();
    for edge in 0..model.topology().edges.len() as u32 {
        for k in 0..400 {
            let p =
                evaluator.edge_frame(edge, model.topology().edges[edge as usize].range[1] * f64::from(k) / 400.0).point;
            let [x, z] = [p[0].abs(), p[2].abs()];
            let straight = (x < 1.0 - 1e-9).then_some(z).or((z < 1.0 - 1e-9).then_some(x));
            assert!(straight.is_none_or(|height| (height - 1.0 - r).abs() < 1e-12), "{p:?}");
        }
    }
}

/// A profile (x, z), closed, drawn along y.
fn grid_of(profile: &[[f64; 2]], rows: u32) -> TetMesh {
    let n = profile.len() as u32;
    let vertices = (0..=rows).flat_map(|j| profile.iter().map(move |&[x, z]| [x, 0.37 * f64::from(j), z])).collect();
    let at = |i: u32, j: u32| j * n + i % n;
    let cells = (0..n * rows).map(|k| (k % n, k / n));
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j + 1), at(i + 1, j)], [at(i, j), at(i, j + 1), at(i + 1, j + 1)]])
        .collect();
    surface(vertices, &triangles)
}

#[test]
fn noise_does_not_make_it_overshoot() {
    let noise = 0.01;
    let mesh = ball(16, noise);
    let model = smooth(&mesh, 60.0);
    for (p, _) in samples(&model, &mesh, 0) {
        assert!((norm(p) - 1.0).abs() < 1.5 * noise, "{}", norm(p));
    }
}

#[test]
fn what_tells_nothing_stays_flat() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let flat = |mesh: &TetMesh| {
        let (model, classification) = Discrete::from_mesh(Team::alone(), mesh, 45.0).unwrap();
        let mut evaluator = model.evaluator();
        for (nodes, &face) in mesh.triangles.nodes.iter().zip(&classification.faces) {
            let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
            let p = std::array::from_fn(|i| 0.2 * a[i] + 0.3 * b[i] + 0.5 * c[i]);
            let on = evaluator.closest_on_face(face, p, None);
            assert!(on.distance < 1e-15, "{on:?}");
            let normal = unit(area2(a, b, c));
            assert!(normal == [0.0; 3] || dot(evaluator.face_normal(face, on.uv), normal).abs() > 1.0 - 1e-12);
        }
        [model.topology().vertices.len(), model.topology().edges.len(), model.topology().faces.len()]
    };
    assert_eq!(flat(&surface(corners[..3].to_vec(), &[[0, 1, 2]])), [3, 3, 1]);
    assert_eq!(flat(&surface(corners.to_vec(), &[[0, 1, 2], [1, 0, 3]])), [4, 5, 2]);
    let closed = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    assert_eq!(flat(&surface(corners.to_vec(), &closed)), [4, 6, 4]);
    // Triangles without area, and one beside a sound one.
    flat(&surface(vec![[1.0; 3]; 3], &[[0, 1, 2]]));
    flat(&surface(vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]], &[[0, 1, 2], [0, 2, 3]]));
}

#[test]
fn a_tetrahedron_without_ridges_is_left_flat_for_its_normals_turn_too_far() {
    let corners = vec![[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
    let mesh = surface(corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let model = smooth(&mesh, 180.0);
    assert_eq!([model.topology().edges.len(), model.topology().faces.len()], [0, 1]);
    let mut evaluator = model.evaluator();
    for nodes in &mesh.triangles.nodes {
        let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
        let middle = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        assert!(evaluator.closest_on_face(0, middle, None).distance < 1e-12);
    }
}

#[test]
fn far_off_and_tiny_it_is_the_same_surface() {
    let mesh = ball(8, 0.0);
    let expected = samples(&smooth(&mesh, 60.0), &mesh, 0);
    for (size, offset) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e4)] {
        let mut moved = mesh.clone();
        moved.vertices.iter_mut().for_each(|p| *p = p.map(|x| size * x + offset));
        let model = smooth(&moved, 60.0);
        let mut evaluator = model.evaluator();
        for (p, normal) in expected.iter().step_by(7) {
            let asked = p.map(|x| size * x + offset);
            let on = evaluator.closest_on_face(0, asked, None);
            assert!(on.distance < 1e-7 * size, "{size} {offset}: {on:?}");
            // On a common side either triangle may be found.
            assert!(distance(evaluator.face_normal(0, on.uv), *normal) < 3e-3);
        }
    }
}
