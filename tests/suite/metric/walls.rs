//! Distances and layers where there is no CAD model: the triangles of the mesh are the walls.

use crate::common::adapting::{Workplace, complaint, cube, stderr, text};
use crate::common::program;
use geo_adapt::mesh::io;
use geo_adapt::metric::Sym3;
use geo_adapt::sizing::layer::spalding;
use std::path::Path;
use std::process::Output;

fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

fn made(arguments: &[&str]) -> String {
    let run = run(arguments);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    String::from_utf8(run.stdout).unwrap()
}

fn values(path: &str) -> Vec<f64> {
    io::read_solution(Path::new(path)).unwrap().content.fields.remove(0).values
}

#[test]
fn distances_y_plus_and_u_plus_of_sides_of_a_cube() {
    let work = Workplace::new();
    let mesh = cube(4, |_| 1);
    let (input, out) = (text(&work.mesh(&mesh)), text(&work.path("d.solb")));
    let distance = ["field", "distance", &input, "-o", &out];
    // x = 0 and y = 1.
    let with = |more: &[&str]| {
        made(&[&distance[..], &["--faces", "1,4"], more].concat());
        values(&out)
    };
    let plain = with(&[]);
    for (p, found) in mesh.vertices.iter().zip(&plain) {
        assert_eq!(*found, f64::min(p[0], 1.0 - p[1]), "{p:?}");
    }
    let unit = spalding::viscous_length(1e5, 2.0);
    let (y_plus, u_plus) =
        (with(&["--yplus", "--re", "1e5", "--length", "2"]), with(&["--spalding", "--re", "1e5", "--length", "2"]));
    for ((distance, y), u) in plain.iter().zip(&y_plus).zip(&u_plus) {
        assert!((y * unit - distance).abs() < 1e-12 && (*u == 0.0) == (*distance == 0.0));
        assert!((spalding::height(*u)[0] - y).abs() <= 1e-10 * y, "{u} {y}");
    }
    let refused = complaint(&run(&[&distance[..], &["--faces", "9"]].concat()));
    assert!(refused.contains("no surface with reference 9; its surfaces are 1, 2, 3, 4, 5, 6"), "{refused}");
    assert!(complaint(&run(&[&distance[..], &["--faces", "1", "--yplus"]].concat())).contains("--re"));
}

#[test]
fn layers_on_a_side_of_a_cube_and_their_measure() {
    let work = Workplace::new();
    let mesh = cube(4, |_| 1);
    let (input, out) = (text(&work.mesh(&mesh)), text(&work.path("m.solb")));
    let metric = ["metric", "wall", &input, "-o", &out, "--hmax", "0.5"];
    made(&[&metric[..], &["--exact", "--wall", "5:h=1e-3,growth=1.5,tangential=0.1"]].concat());
    for (p, terms) in mesh.vertices.iter().zip(values(&out).as_chunks::<6>().0) {
        let found = Sym3(*terms);
        let (across, along) = (1e-3 + 0.5 * p[2], f64::min(0.1 + 0.5 * p[2], 0.5));
        let expected = if across < 0.5 { [along, along, across] } else { [0.5; 3] };
        for (i, expected) in expected.into_iter().enumerate() {
            assert!((found.at(i, i).powf(-0.5) / expected - 1.0).abs() < 1e-8, "{found:?} at {p:?}");
        }
    }
    // The mesh has one cell of 0.25 where layers of 1e-3 are asked for.
    let told = made(&["inspect", &input, "--wall", "5:h=1e-3,growth=1.5", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    let wall = &told["walls"][0];
    assert_eq!((&wall["wall"], &wall["vertices"], &wall["mean"]), (&"5".into(), &25.into(), &0.25.into()), "{wall}");
    // With a complexity sizes along the wall and outside change, those across stay.
    let scaled = [&metric[..], &["--wall", "5:h=0.05,growth=1.5", "--complexity", "400", "--exact"]].concat();
    made(&scaled);
    for (p, terms) in mesh.vertices.iter().zip(values(&out).as_chunks::<6>().0) {
        if p[2] == 0.0 {
            assert!((Sym3(*terms).at(2, 2).powf(-0.5) / 0.05 - 1.0).abs() < 1e-8);
        }
    }
    let shown = made(&["metric", "show", &input, &out, "--json"]);
    let shown: serde_json::Value = serde_json::from_str(&shown).unwrap();
    let complexity = shown["complexity_between"].as_f64().unwrap();
    assert!((complexity / 400.0 - 1.0).abs() < 0.01, "{complexity}");
    // A surface, no region.
    let refused = complaint(&run(&[&metric[..], &["--wall", "region:1:h=1"]].concat()));
    assert!(refused.contains("region"), "{refused}");
}
