//! `geo-adapt bootstrap` of a closed surface of triangles: a first mesh of a scan or an exported part.
#![cfg(unix)]

use crate::common::adapting::{complaint, stderr};
use crate::common::program;
use geo_adapt::mesh::vector::{Vec3, norm, volume6};
use geo_adapt::mesh::{TetMesh, io, validity};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Triangles by their corners.
type Soup = Vec<[Vec3; 3]>;

/// A sphere of n rings of 2n quadrilaterals.
fn sphere(n: u32, radius: f64, centre: Vec3) -> Soup {
    let at = |i: u32, j: u32| -> Vec3 {
        let (theta, phi) = (PI * f64::from(i) / f64::from(n), PI * f64::from(j % (2 * n)) / f64::from(n));
        let sine = if i == 0 || i == n { 0.0 } else { theta.sin() };
        let direction = [sine * phi.cos(), sine * phi.sin(), theta.cos()];
        [0, 1, 2].map(|k| centre[k] + radius * direction[k])
    };
    let mut soup = Soup::new();
    for (i, j) in (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if i + 1 < n {
            soup.push([a, b, c]);
        }
        if i > 0 {
            soup.push([a, c, d]);
        }
    }
    soup
}

/// The sides of a box, two triangles each.
fn cuboid(low: Vec3, high: Vec3) -> Soup {
    let at = |k: usize| -> Vec3 { std::array::from_fn(|i| if k >> i & 1 == 0 { low[i] } else { high[i] }) };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(at)).collect()
}

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a binary STL.
    fn stl(&self, name: &str, soup: &Soup) -> PathBuf {
        let mut bytes = vec![b' '; 80];
        bytes.extend((soup.len() as u32).to_le_bytes());
        for corners in soup {
            bytes.extend([0u8; 12]);
            corners.iter().flatten().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
            bytes.extend([0u8; 2]);
        }
        std::fs::write(self.path(name), bytes).unwrap();
        self.path(name)
    }

    fn run(&self, surface: &Path, arguments: &[&str]) -> Output {
        let mut command = program();
        command.arg("bootstrap").arg(surface).arg("-o").arg(self.path("out.meshb")).args(arguments);
        command.env("GEO_ADAPT_GMSH", "/nowhere").env("GEO_ADAPT_NETGEN_PYTHON", "/nowhere").output().unwrap()
    }

    fn mesh(&self, surface: &Path, arguments: &[&str]) -> TetMesh {
        let run = self.run(surface, arguments);
        // On a slow machine it says how long it will take.
        let said: Vec<String> = stderr(&run).lines().map(str::to_owned).collect();
        let notes: Vec<_> = said.iter().filter(|line| !line.starts_with("the metric asks for about")).collect();
        assert_eq!((run.status.code(), notes), (Some(0), Vec::<&String>::new()));
        let mesh = io::read_mesh(&self.path("out.meshb")).unwrap().content;
        assert!(validity::check(&mesh).is_valid(), "{:?}", validity::check(&mesh));
        mesh
    }
}

/// The volume of each region.
fn volumes(mesh: &TetMesh) -> BTreeMap<i32, f64> {
    let mut volumes = BTreeMap::new();
    for (nodes, region) in mesh.tets.iter() {
        let [a, b, c, d] = nodes.map(|v| mesh.vertices[v as usize]);
        *volumes.entry(region).or_default() += volume6(a, b, c, d) / 6.0;
    }
    volumes
}

#[test]
fn a_ball_of_triangles_is_filled_and_stays_round() {
    let place = Place::new();
    let surface = place.stl("ball.stl", &sphere(12, 1.0, [0.0; 3]));
    let mesh = place.mesh(&surface, &["--segments", "4"]);
    let on_surface = mesh.triangles.nodes.iter().flatten().map(|&v| norm(mesh.vertices[v as usize]));
    let (least, most) = on_surface.fold((f64::INFINITY, 0.0f64), |(least, most), r| (least.min(r), most.max(r)));
    // The flat triangles are 0.02 inside it.
    assert!(least > 0.998 && most < 1.002, "{least} {most}");
    let volume: f64 = volumes(&mesh).values().sum();
    assert!(volume > 0.97 * 4.0 / 3.0 * PI, "{volume}");
    let coarse = place.mesh(&surface, &["--no-adapt", "--flat-surface"]);
    assert!(coarse.tets.len() < mesh.tets.len() && place.path("out.meshb").exists());
}

/// A ball of few triangles in a box: a flat wall of the box is 0.02 from the triangles, and smooth patches through the ball's vertices bulge
/// through it by 0.03.
#[test]
fn triangles_whose_smooth_patches_go_through_each_other_are_taken_as_they_are() {
    let place = Place::new();
    let ball = sphere(5, 1.0, [0.0; 3]);
    let wall = ball.iter().flatten().map(|p| p[0]).fold(0.0, f64::max) + 0.02;
    assert!((0.96..0.98).contains(&wall), "{wall}");
    let surface = place.stl("near.stl", &[ball, cuboid([-2.0; 3], [wall, 2.0, 2.0])].concat());
    let run = place.run(&surface, &[]);
    let said = stderr(&run);
    assert_eq!(run.status.code(), Some(0), "{said}");
    assert!(
        said.contains("smooth patches do not fit this surface (they go through each other near (0.9")
            && said.contains("give --flat-surface"),
        "{said}"
    );
    let mesh = io::read_mesh(&place.path("out.meshb")).unwrap().content;
    assert!(validity::check(&mesh).is_valid());
    // As with that option, byte for byte.
    let before = std::fs::read(place.path("out.meshb")).unwrap();
    place.mesh(&surface, &["--flat-surface"]);
    assert!(before == std::fs::read(place.path("out.meshb")).unwrap());
}

#[test]
fn surfaces_within_each_other_bound_solids_and_voids_in_turn() {
    let place = Place::new();
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    let nested: Soup = [1.0, 0.7, 0.4].into_iter().flat_map(|radius| sphere(12, radius, [0.0; 3])).collect();
    let mesh = place.mesh(&place.stl("nested.stl", &nested), &[]);
    let found = volumes(&mesh);
    assert_eq!(found.len(), 2, "{found:?}");
    let total: f64 = found.values().sum();
    let exact = ball(1.0) - ball(0.7) + ball(0.4);
    assert!((total / exact - 1.0).abs() < 0.1, "{total} {exact}");
    // Beside each other, with sharp edges.
    let two: Soup = [cuboid([0.0; 3], [1.0; 3]), cuboid([2.0, 0.0, 0.0], [4.0, 1.0, 1.0])].concat();
    let found = volumes(&place.mesh(&place.stl("two.stl", &two), &[]));
    assert_eq!(found.len(), 2);
    assert!((found.values().sum::<f64>() - 3.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn what_a_surface_calls_its_parts_is_what_the_mesh_calls_them() {
    let place = Place::new();
    let mut text = String::new();
    // Sides of a box: two triangles each.
    for (side, triangles) in cuboid([0.0; 3], [1.0; 3]).chunks(2).enumerate() {
        let name = ["inlet", "outlet", "wall", "wall", "wall", "wall"][side];
        text += &format!("solid {name}\n");
        for corners in triangles {
            text += "facet normal 0 0 0\nouter loop\n";
            corners.iter().for_each(|[x, y, z]| text += &format!("vertex {x} {y} {z}\n"));
            text += "endloop\nendfacet\n";
        }
        text += &format!("endsolid {name}\n");
    }
    let surface = place.path("duct.stl");
    std::fs::write(&surface, text).unwrap();
    for arguments in [&[][..], &["--no-adapt"]] {
        let mesh = place.mesh(&surface, arguments);
        let names = std::fs::read_to_string(place.path("out.names.json")).unwrap();
        let names: serde_json::Value = serde_json::from_str(&names).unwrap();
        for (reference, name, area) in [(1, "inlet", 1.0), (2, "outlet", 1.0), (3, "wall", 4.0)] {
            assert_eq!(names["triangles"][reference.to_string()]["name"], name);
            let of = mesh.triangles.iter().filter(|(_, at)| *at == reference);
            let found: f64 = of
                .map(|(nodes, _)| {
                    let [a, b, c] = nodes.map(|v| mesh.vertices[v as usize]);
                    0.5 * norm(geo_adapt::mesh::vector::area2(a, b, c))
                })
                .sum();
            assert!((found - area).abs() < 1e-9, "{name}: {found}");
        }
    }
}

#[test]
fn holes_crossings_and_what_it_cannot_do_are_told() {
    let place = Place::new();
    let told = |soup: &Soup, arguments: &[&str]| {
        let message = complaint(&place.run(&place.stl("part.stl", soup), arguments));
        assert!(message.contains("part.stl") && !place.path("out.meshb").exists(), "{message}");
        message
    };
    let ball = sphere(8, 1.0, [0.0; 3]);
    let message = told(&ball[..ball.len() - 1].to_vec(), &[]);
    assert!(message.contains("not closed") && message.contains("3 edges"), "{message}");
    let crossing = [ball.clone(), sphere(8, 1.0, [1.2, 0.1, 0.03])].concat();
    assert!(told(&crossing, &[]).contains("cross near"));
    assert!(told(&ball, &["--far-field", "box:3"]).contains("--far-field"));
    assert!(told(&ball, &["--mesher", "gmsh"]).contains("--mesher"));
    assert!(told(&Soup::new(), &[]).contains("surface"));
    let flat: Soup = vec![[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]];
    told(&flat, &[]);
    let message = told(&ball, &["--time-limit", "1e-9"]);
    assert!(message.contains("--time-limit"), "{message}");
}

#[test]
fn parts_that_share_triangles_are_solids_beside_each_other() {
    let place = Place::new();
    // The side that both have is there twice, looking either way.
    let two: Soup = [cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])].concat();
    let surface = place.stl("parts.stl", &two);
    let run = place.run(&surface, &[]);
    assert!(run.status.success() && stderr(&run).contains("2 triangles are there twice"), "{}", stderr(&run));
    let found = volumes(&io::read_mesh(&place.path("out.meshb")).unwrap().content);
    assert_eq!(found.len(), 2);
    assert!(found.values().all(|volume| (volume - 1.0).abs() < 1e-9), "{found:?}");
}
