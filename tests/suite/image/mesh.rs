//! `geo-adapt image-mesh` makes a valid mesh of a 3D image, near its surfaces, of round tetrahedra, on any number of threads; and `adapt` takes it.
use crate::common::adapting::{Workplace, areas, faces, isotropic, stderr, text, volumes};
use crate::common::program;
use geo_adapt::image::{Encoding, Frame, Image, Kind, write};
use geo_adapt::mesh::vector::{Vec3, area2, distance, dot, lerp, norm, scale, sub};
use geo_adapt::mesh::{TetMesh, io, validity};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Half a voxel of the images here, and a little.
const HALF: f64 = 0.55;

/// A box of voxels about the origin; `value` is asked at their centres.
fn image(sizes: [usize; 3], spacings: Vec3, kind: Kind, value: impl Fn(Vec3) -> f64) -> Image {
    let origin = std::array::from_fn(|i| -0.5 * (sizes[i] - 1) as f64 * spacings[i]);
    let axes = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { spacings[i] } else { 0.0 }));
    let frame = Frame::new(origin, axes).unwrap();
    let [x, y, z] = sizes;
    let index = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    let values: Vec<f64> = index.map(|index| value(frame.point(index.map(|i| i as f64)))).collect();
    Image::new(sizes, frame, kind, values)
}

fn labels(sizes: [usize; 3], label: impl Fn(Vec3) -> u8) -> Image {
    image(sizes, [1.0; 3], Kind::Uint8, |p| f64::from(label(p)))
}

fn torus(p: Vec3) -> f64 {
    6.0 - (p[0].hypot(p[1]) - 13.0).hypot(p[2])
}

struct Meshed {
    mesh: TetMesh,
    report: Value,
}

/// Meshes an image on so many threads, and checks what holds for every image.
fn mesh_on(threads: &str, image: &Image, arguments: &[&str]) -> Meshed {
    let work = Workplace::new();
    let [input, output, report] = ["in.nrrd", "out.meshb", "report.json"].map(|name| work.path(name));
    write(&input, image, Encoding::Gzip).unwrap();
    let mut command = program();
    command.arg("image-mesh").arg(&input).arg("-o").arg(&output).args(["--threads", threads]).args(arguments);
    let run = command.arg("--report").arg(&report).output().unwrap();
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(run.stderr.is_empty(), "{}", stderr(&run));
    let read = io::read_mesh(&output).unwrap();
    assert!(read.notices.is_empty());
    let inspected = program().arg("inspect").arg(&output).output().unwrap();
    assert_eq!(inspected.status.code(), Some(0), "{}", String::from_utf8_lossy(&inspected.stdout));
    let report: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    let meshed = Meshed { mesh: read.content, report };
    check(&meshed);
    if threads == "1" {
        assert_eq!(meshed.report["counts"]["conflicts"], 0);
    }
    meshed
}

/// On one, two and four threads.
fn mesh(image: &Image, arguments: &[&str]) -> Vec<Meshed> {
    ["1", "2", "4"].map(|threads| mesh_on(threads, image, arguments)).into()
}

fn check(Meshed { mesh, report }: &Meshed) {
    assert!(validity::check(mesh).is_valid(), "{:?}", validity::check(mesh));
    let places: BTreeSet<_> = mesh.vertices.iter().map(|p| p.map(f64::to_bits)).collect();
    assert_eq!(places.len(), mesh.vertices.len(), "a vertex twice");
    assert_eq!(report["tets"], mesh.tets.len());
    // Faces between regions have triangles as those of the boundary have, and no other.
    let between = faces(mesh).values().filter(|(_, regions)| regions.len() == 1 || regions[0] != regions[1]).count();
    assert_eq!(between, mesh.triangles.len());
    let bound = report["limits"]["radius_edge"].as_f64().unwrap();
    let ratios = mesh.tets.nodes.iter().filter_map(|nodes| radius_edge(nodes.map(|v| mesh.vertices[v as usize])));
    let greatest = ratios.fold(0.0, f64::max);
    let told = report["radius_edge"]["greatest"].as_f64().unwrap();
    assert!(greatest < told * (1.0 + 1e-5), "{greatest} {told}");
    assert_eq!(report["radius_edge"]["above_inside"], 0, "{report}");
    assert!(greatest <= bound || report["radius_edge"]["above_at_surfaces"].as_u64().unwrap() > 0);
}

/// Circumradius over shortest edge, by Crelle: from the products of opposite edges. None of a tetrahedron too flat for the formula.
fn radius_edge([a, b, c, d]: [Vec3; 4]) -> Option<f64> {
    let products = [distance(a, b) * distance(c, d), distance(a, c) * distance(b, d), distance(a, d) * distance(b, c)];
    let [p, q, r] = products;
    let area = ((p + q + r) * (p + q - r) * (p - q + r) * (q + r - p)).sqrt();
    let volume6 = dot(area2(a, b, c), sub(d, a));
    let radius = area / (4.0 * volume6);
    let flat = volume6 < 1e-4 * distance(a, b).max(distance(a, c)).max(distance(a, d)).powi(3);
    let edges = [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
    let shortest = edges.iter().map(|[a, b]| distance(*a, *b)).fold(f64::INFINITY, f64::min);
    (!flat).then_some(radius / shortest)
}

fn near(value: f64, exact: f64, part: f64) {
    assert!((value - exact).abs() < part * exact, "{value} is not within {part} of {exact}");
}

/// Vertices − edges + triangles of the surfaces.
fn euler(mesh: &TetMesh) -> i64 {
    let triangles = &mesh.triangles.nodes;
    let vertices: BTreeSet<u32> = triangles.iter().flatten().copied().collect();
    let edge = |a: u32, b: u32| [a.min(b), a.max(b)];
    let edges: BTreeSet<_> = triangles.iter().flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]).collect();
    vertices.len() as i64 - edges.len() as i64 + triangles.len() as i64
}

/// How far along a direction from the origin the triangles are; each direction meets one.
fn radii(mesh: &TetMesh, directions: usize) -> impl Iterator<Item = f64> + '_ {
    (0..directions).map(move |n| {
        let height = 1.0 - (2 * n + 1) as f64 / directions as f64;
        let (sin, cos) = (2.399963 * n as f64).sin_cos();
        let flat = (1.0 - height * height).sqrt();
        let direction = [flat * cos, flat * sin, height];
        let corners = mesh.triangles.nodes.iter().map(|nodes| nodes.map(|v| mesh.vertices[v as usize]));
        let hits: Vec<f64> = corners
            .filter_map(|[a, b, c]| {
                let side = |p: Vec3, q: Vec3| dot(direction, area2([0.0; 3], p, q));
                let meets = side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0;
                let normal = area2(a, b, c);
                meets.then(|| dot(normal, a) / dot(normal, direction))
            })
            .collect();
        assert_eq!(hits.len(), 1, "along {direction:?}: {hits:?}");
        hits[0]
    })
}

#[test]
fn a_grey_ball_is_met_to_the_distance_asked_for() {
    let grey = image([36; 3], [1.0; 3], Kind::Float, |p| 12.0 - norm(p));
    for (distance, threads) in [("0.4", "1"), ("0.1", "1"), ("0.1", "2")] {
        let arguments = ["--isovalue", "0", "--size", "5", "--surface-distance", distance];
        let Meshed { mesh, report } = mesh_on(threads, &grey, &arguments);
        let distance: f64 = distance.parse().unwrap();
        // What the image itself is off by: linear interpolation of a distance between voxels.
        let image = 1.0 / (4.0 * 12.0);
        for radius in radii(&mesh, 400) {
            assert!((radius - 12.0).abs() < distance + image, "{radius}");
        }
        let sizes = mesh.tets.nodes.iter().map(|nodes| nodes.map(|v| mesh.vertices[v as usize]));
        let longest = sizes.map(|[a, b, ..]| norm(sub(a, b))).fold(0.0, f64::max);
        assert!(longest <= 2.0 * 5.0, "an edge of {longest} fits in no sphere of radius 5");
        near(volumes(&mesh)[&1], 4.0 / 3.0 * PI * 12.0_f64.powi(3), 4.0 * distance / 12.0);
        assert_eq!(euler(&mesh), 2);
        assert_eq!(report["counts"]["lost"], 0);
    }
}

#[test]
fn a_smaller_size_makes_more_tetrahedra_and_no_longer_edges() {
    let ball = labels([24; 3], |p| u8::from(norm(p) < 8.0));
    let coarse = mesh_on("1", &ball, &[]);
    let fine = mesh_on("2", &ball, &["--size", "1.5", "--radius-edge", "1.9"]);
    assert!(fine.mesh.tets.len() > 5 * coarse.mesh.tets.len());
    for Meshed { mesh, .. } in [coarse, fine] {
        near(volumes(&mesh)[&1], 4.0 / 3.0 * PI * 8.0_f64.powi(3), 0.06);
    }
}

#[test]
fn a_torus_keeps_its_hole() {
    for Meshed { mesh, report } in mesh(&labels([44, 44, 18], |p| u8::from(torus(p) > 0.0)), &[]) {
        near(volumes(&mesh)[&1], 2.0 * PI * PI * 13.0 * 36.0, 0.06);
        assert_eq!(euler(&mesh), 0);
        for (&v, on) in mesh.triangles.nodes.iter().flatten().zip(std::iter::repeat(&mesh.vertices)) {
            assert!(torus(on[v as usize]).abs() < 0.9, "the voxels are not nearer themselves");
        }
        assert_eq!(report["left_out"], 0);
    }
}

#[test]
fn nested_labels_have_a_surface_between_them() {
    let nested = labels([32; 3], |p| if norm(p) < 6.0 { 7 } else { 3 * u8::from(norm(p) < 12.0) });
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    for Meshed { mesh, report } in mesh(&nested, &["--surface-distance", "0.3"]) {
        let volumes = volumes(&mesh);
        assert_eq!(volumes.keys().copied().collect::<Vec<_>>(), [3, 7]);
        near(volumes[&7], ball(6.0), 0.1);
        near(volumes[&3], ball(12.0) - ball(6.0), 0.06);
        assert_eq!(report["surfaces"][0]["between"], serde_json::json!([0, 3]));
        assert_eq!(report["surfaces"][1]["between"], serde_json::json!([3, 7]));
        let areas = areas(&mesh);
        assert_eq!(areas.keys().copied().collect::<Vec<_>>(), [1, 2]);
        near(areas[&1], 4.0 * PI * 144.0, 0.1);
        near(areas[&2], 4.0 * PI * 36.0, 0.1);
        // Two spheres.
        assert_eq!(euler(&mesh), 4);
    }
}

#[test]
fn two_halves_and_the_outside_meet_in_a_line() {
    let halves = labels([24; 3], |p| if norm(p) > 9.0 { 0 } else { 1 + u8::from(p[0] > 0.0) });
    for Meshed { mesh, report } in mesh(&halves, &[]) {
        let volumes = volumes(&mesh);
        let half = 2.0 / 3.0 * PI * 9.0_f64.powi(3);
        near(volumes[&1], half, 0.07);
        near(volumes[&2], half, 0.07);
        let between: Vec<&Value> =
            report["surfaces"].as_array().unwrap().iter().map(|surface| &surface["between"]).collect();
        assert_eq!(between, [&serde_json::json!([0, 1]), &serde_json::json!([0, 2]), &serde_json::json!([1, 2])]);
        near(areas(&mesh)[&3], PI * 81.0, 0.1);
    }
}

#[test]
fn one_voxel_is_not_lost_beside_large_tetrahedra() {
    // A voxel far from everything, and one of another label within a ball.
    let specks = labels([40; 3], |p| match p.map(|x| x as i32) {
        [15, 15, 15] => 9,
        [2, 3, 4] => 4,
        _ => u8::from(norm(p) < 12.0),
    });
    for Meshed { mesh, .. } in mesh(&specks, &["--size", "6"]) {
        let volumes = volumes(&mesh);
        assert_eq!(volumes.keys().copied().collect::<Vec<_>>(), [1, 4, 9]);
        // Where the voxel's weight is above a half: a volume of 0.27, and less by its corners.
        assert!((0.2..0.4).contains(&volumes[&9]) && (0.2..0.4).contains(&volumes[&4]), "{volumes:?}");
        let speck = mesh.tets.iter().filter(|&(_, region)| region == 9).flat_map(|(nodes, _)| nodes);
        assert!(speck.map(|v| mesh.vertices[v as usize]).all(|p| distance(p, [15.5; 3]) < HALF));
    }
}

#[test]
fn what_touches_the_border_ends_there() {
    let full = labels([10, 12, 14], |_| 1);
    for Meshed { mesh, .. } in mesh(&full, &["--surface-distance", "0.1"]) {
        // Edges are rounded: a tenth of a voxel for each along them.
        near(volumes(&mesh)[&1], 10.0 * 12.0 * 14.0 - 0.1 * 144.0, 0.01);
        for p in &mesh.vertices {
            assert!(p[0].abs() < HALF + 4.5 && p[1].abs() < HALF + 5.5 && p[2].abs() < HALF + 6.5, "{p:?}");
        }
        assert_eq!(euler(&mesh), 2);
    }
    let grey = image([10, 12, 14], [1.0; 3], Kind::Int16, |_| 100.0);
    near(volumes(&mesh_on("1", &grey, &["--isovalue", "50", "--surface-distance", "0.1"]).mesh)[&1], 1680.0, 0.02);
}

#[test]
fn voxels_may_be_long() {
    let ball = image([34, 34, 12], [1.0, 1.0, 3.0], Kind::Uint16, |p| f64::from(u8::from(norm(p) < 13.0)));
    for Meshed { mesh, .. } in mesh(&ball, &[]) {
        near(volumes(&mesh)[&1], 4.0 / 3.0 * PI * 13.0_f64.powi(3), 0.08);
        assert_eq!(euler(&mesh), 2);
    }
}

#[test]
fn the_mesh_lies_where_the_header_says() {
    // Turned about the third axis, mirrored and moved.
    let straight = labels([16; 3], |p| u8::from(norm(p) < 6.0));
    let values = (0..straight.len()).map(|voxel| straight.value(voxel));
    let frame = Frame::new([100.0, -50.0, 7.0], [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, -2.0]]).unwrap();
    let turned = Image::new([16; 3], frame, Kind::Uint8, values);
    let Meshed { mesh, .. } = mesh_on("1", &turned, &[]);
    near(volumes(&mesh)[&1], 2.0 * 4.0 / 3.0 * PI * 216.0, 0.1);
    let middle = frame.point([7.5; 3]);
    let mean =
        mesh.vertices.iter().fold([0.0; 3], |mean, &p| lerp(mean, sub(p, middle), 1.0 / mesh.vertices.len() as f64));
    assert!(norm(scale(mean, 1.0)) < 1.0, "{mean:?}");
}

#[test]
fn noise_becomes_a_valid_mesh() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 30)
    };
    let values: Vec<f64> = (0..14 * 14 * 14).map(|_| random()).collect();
    let noise = Image::new([14; 3], Frame::of_spacings([1.0; 3]).unwrap(), Kind::Int8, values);
    for Meshed { mesh, .. } in mesh(&noise, &["--surface-distance", "0.4"]) {
        assert_eq!(volumes(&mesh).len(), 3);
    }
}

#[test]
fn the_mesh_is_adapted_like_any_other() {
    let work = Workplace::new();
    let nested = labels([24; 3], |p| if norm(p) < 5.0 { 2 } else { u8::from(norm(p) < 10.0) });
    let Meshed { mesh, .. } = mesh_on("2", &nested, &[]);
    let (input, metric) = (work.mesh(&mesh), work.metric(&mesh, |p| isotropic(1.0 + 0.2 * norm(p))));
    let adapted = work.adapt(&input, &["--metric", &metric]);
    assert_eq!(volumes(&adapted.mesh).len(), 2);
    assert!(
        adapted.report["statistics"]["metric"]["unit_edges"].as_f64().unwrap_or(0.0) > 0.85,
        "{}",
        adapted.report["statistics"]["metric"]
    );
}

#[test]
fn the_table_has_what_the_report_has() {
    let work = Workplace::new();
    let input = work.path("in.nrrd");
    write(&input, &labels([12; 3], |p| 5 * u8::from(norm(p) < 4.0)), Encoding::Text).unwrap();
    let output = text(&work.path("out.mesh"));
    let mut command = program();
    let run = command.arg("image-mesh").arg(&input).args(["-o", &output, "--threads", "1"]).output().unwrap();
    let table = String::from_utf8(run.stdout).unwrap();
    for part in
        ["vertices", "region 5", "between outside and region 5", "radius-edge ratio", "vertices a second on 1 thread"]
    {
        assert!(table.contains(part), "{table}");
    }
    let quiet = program().arg("image-mesh").arg(&input).args(["-o", &output, "--quiet"]).output().unwrap();
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty() && quiet.status.success());
}
