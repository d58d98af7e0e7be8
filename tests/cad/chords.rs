//! `geo-adapt adapt --limit-chords`: thin layers on a curved wall get sizes that straight edges can have.

use crate::common::adapting::{Adapted, Workplace, text};
use geo_adapt::mesh::io;
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::metric::Sym3;
use std::path::{Path, PathBuf};

/// The size across at the wall of the cylinder, radius 0.5 about z.
const FIRST: f64 = 1e-3;

fn cube_cylinder() -> [PathBuf; 2] {
    ["geometry/cube-cylinder.step", "cases/cube-cylinder/start.meshb"]
        .map(|path| Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
}

/// Along the radius, about the axis, along it.
fn axes(p: Vec3) -> [Vec3; 3] {
    let r = p[0].hypot(p[1]);
    let [x, y] = [p[0] / r, p[1] / r];
    [[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]]
}

/// A layer on the cylinder, 0.1 along it.
fn layer(p: Vec3) -> Sym3 {
    let across = (FIRST + 0.2 * (p[0].hypot(p[1]) - 0.5).max(0.0)).min(0.1);
    Sym3::from_sizes(axes(p), [across, 0.1, 0.1])
}

fn adapted(work: &Workplace, arguments: &[&str]) -> Adapted {
    let [model, start] = cube_cylinder();
    let metric = work.metric(&io::read_mesh(&start).unwrap().content, layer);
    work.adapt(&start, &[&["--cad", &text(&model), "--metric", &metric], arguments].concat())
}

fn figure(found: &Adapted, name: &str) -> f64 {
    found.report["statistics"]["metric"][name].as_f64().unwrap()
}

#[test]
fn a_layer_on_a_cylinder_gets_chords_that_follow_it() {
    let (free, cut) = (adapted(&Workplace::new(), &[]), adapted(&Workplace::new(), &["--limit-chords"]));
    assert!(free.report["chords"].is_null());
    let told = &cut.report["chords"];
    // 0.1 / (0.5 √(8 · 0.001 · 0.5)) = 3.16 at the wall.
    let greatest = told["greatest"].as_f64().unwrap();
    assert!(told["share"] == 0.5 && told["vertices"] == 51, "{told}");
    assert!((greatest - 3.162).abs() < 0.01, "{told}");
    assert_eq!(cut.report["off_model"], serde_json::json!([]));
    assert!(figure(&cut, "unit_edges") > figure(&free, "unit_edges").max(0.9), "{}", figure(&cut, "unit_edges"));
    // At the wall the size across is what it was, that about the axis 0.5 √(8 h R), that along it 0.1.
    let on_wall = |p: &Vec3| (p[0].hypot(p[1]) - 0.5).abs() < 1e-9;
    let wall = || cut.mesh.vertices.iter().zip(&cut.metrics).filter(|(p, _)| on_wall(p));
    assert!(wall().count() > 200);
    let length = |metric: &Sym3, direction: Vec3| metric.quadratic(direction).sqrt().recip();
    for (&p, metric) in wall() {
        let [across, about, along] = axes(p).map(|axis| length(metric, axis));
        // Between the vertices of the start mesh the axes turn, so that they are those of neither.
        assert!(about < 1.02 * 0.5 * (8.0 * FIRST * 0.5_f64).sqrt(), "{about} at {p:?}");
        assert!(across > 0.99 * FIRST && across < 1.5 * FIRST, "{across} at {p:?}");
        assert!((along / 0.1 - 1.0).abs() < 1e-6, "{along} at {p:?}");
    }
}

/// At the wall sizes of 0.1 about the axis, 0.5 away from it, and `across`: at 2e-4 they are 3.5 times √(8 h R), at 1e-3 1.6 times.
#[test]
fn sizes_that_no_edge_along_the_wall_can_have_are_told() {
    let [model, start] = cube_cylinder();
    let told = |across: f64, arguments: &[&str]| {
        let work = Workplace::new();
        let grown = |p: Vec3| across * (p[0].hypot(p[1]) / 0.5).powi(20).min(100.0);
        let sizes = |p: Vec3| Sym3::from_sizes(axes(p), [grown(p), 0.1, 0.1]);
        let metric = work.metric(&io::read_mesh(&start).unwrap().content, sizes);
        let model = text(&model);
        let arguments = [&["--cad", &model, "--metric", &metric, "--max-vertices", "400"], arguments].concat();
        let output = work.command(&start, &arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        said.lines().find(|line| line.contains("√(8 h R)")).map(str::to_owned)
    };
    let notice = told(2e-4, &[]).unwrap();
    assert!(notice.contains("3.5") && notice.contains("--limit-chords"), "{notice}");
    assert_eq!(told(2e-4, &["--limit-chords"]), None);
    assert_eq!(told(1e-3, &[]), None);
}

#[test]
fn the_complexity_is_met_after_the_cut() {
    for wanted in [500.0, 1500.0] {
        let found = adapted(&Workplace::new(), &["--limit-chords=0.35", "--complexity", &wanted.to_string()]);
        assert_eq!(found.report["chords"]["share"], 0.35);
        let has = figure(&found, "complexity");
        assert!((has / wanted - 1.0).abs() < 0.15, "{has} of {wanted}");
    }
}

#[test]
fn what_does_not_go_with_it_is_said() {
    let work = Workplace::new();
    let [model, start] = cube_cylinder();
    let refusal = |arguments: &[&str]| work.refusal(&start, &[&["--cad", &text(&model)], arguments].concat());
    let message = refusal(&["--analytic", "polar-1", "--limit-chords"]);
    assert!(message.contains("--limit-chords") && message.contains("--analytic"), "{message}");
    for share in ["0", "-0.5", "2", "much"] {
        let message = refusal(&["--size", "0.1", &format!("--limit-chords={share}")]);
        assert!(message.contains("--limit-chords") && message.contains("share above 0"), "{message}");
    }
    let message = refusal(&["--limit-chords"]);
    assert!(message.contains("--metric"), "{message}");
}
