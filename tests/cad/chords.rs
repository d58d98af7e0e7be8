//! `geo-adapt adapt --limit-chords`: thin layers on a curved wall get sizes that straight edges can have.

use crate::common::adapting::{Adapted, Workplace, text};
use geo_adapt::api::{Adapter, ChordLimit, Error, MeshView, Settings};
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

/// At the wall sizes of 0.1 about the axis, 0.5 away from it, and `across`: the chords rise by 0.0025.
fn sizes_at_wall(p: Vec3, across: f64) -> Sym3 {
    let grown = across * (p[0].hypot(p[1]) / 0.5).powi(20).min(100.0);
    Sym3::from_sizes(axes(p), [grown, 0.1, 0.1])
}

/// What came of a metric on the start mesh, and what was said of its sizes along the wall.
fn made_of(metric_at: impl Fn(Vec3) -> Sym3, arguments: &[&str]) -> (Adapted, Option<String>) {
    let ([model, start], work) = (cube_cylinder(), Workplace::new());
    let metric = work.metric(&io::read_mesh(&start).unwrap().content, metric_at);
    let [model, report] = [text(&model), text(&work.path("report.json"))];
    let given = ["--cad", &model, "--metric", &metric, "--complexity", "400", "--threads", "1", "--report", &report];
    let output = work.command(&start, &[&given, arguments].concat()).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    (work.result(), said.lines().find(|line| line.contains("sizes along curved walls")).map(str::to_owned))
}

/// At 2e-4 unit edges would dive through 12.5 layers at the wall, at 4e-3 through 0.6.
#[test]
fn sizes_that_no_edge_along_the_wall_can_have_are_cut_by_default() {
    let deep = |p| sizes_at_wall(p, 2e-4);
    let [(cut, told), (asked, silent), (left, also_silent)] =
        [&[][..], &["--limit-chords"], &["--limit-chords=off"]].map(|arguments| made_of(deep, arguments));
    let told = told.unwrap();
    assert!(told.contains("through up to") && told.contains("--limit-chords=off"), "{told}");
    assert!(silent.is_none() && also_silent.is_none());
    assert!(cut.report["chords"]["share"] == 0.5 && cut.report["chords"]["vertices"].as_u64() > Some(50));
    assert!(cut.mesh == asked.mesh && cut.report["chords"] == asked.report["chords"]);
    assert!(left.report["chords"].is_null());
    assert!(figure(&cut, "unit_edges") > 0.9 && figure(&left, "unit_edges") < 0.85);
    assert!(cut.mesh.vertices.len() < left.mesh.vertices.len());

    let (shallow, told) = made_of(|p| sizes_at_wall(p, 4e-3), &[]);
    assert!(shallow.report["chords"].is_null() && told.is_none());
}

/// Deep at one of 51 vertices of the wall, no more than 2 %.
#[test]
fn sizes_that_are_too_long_at_a_few_vertices_are_told_and_left() {
    let at = |p: Vec3| p[0].hypot(p[1] - 0.5) < 1e-9 && p[2].abs() < 1e-9;
    let (found, told) = made_of(|p| sizes_at_wall(p, if at(p) { 1e-4 } else { 2e-3 }), &[]);
    let told = told.unwrap();
    assert!(told.contains("at 1 of 51 vertices") && told.contains("--limit-chords cuts"), "{told}");
    assert!(found.report["chords"].is_null());
}

/// Read by slices, its sizes inside are not at hand.
#[test]
fn sizes_of_a_mesh_that_is_read_by_slices_are_told_and_left() {
    let (found, told) = made_of(|p| sizes_at_wall(p, 2e-4), &["--memory", "1GB"]);
    let told = told.unwrap();
    assert!(told.contains("at 51 of 51 vertices") && told.contains("--limit-chords cuts"), "{told}");
    assert!(found.report["chords"].is_null());
}

/// The library does as the program.
#[test]
fn the_library_cuts_the_same_sizes() {
    let [model, start] = cube_cylinder();
    let input = io::read_mesh(&start).unwrap().content;
    let metric: Vec<Sym3> = input.vertices.iter().map(|&p| sizes_at_wall(p, 2e-4)).collect();
    let settings = Settings { threads: 1, complexity: Some(400.0), ..Settings::default() };
    let mut adapter = Adapter::on_cad(&model, settings).unwrap();
    let mut adapt = |chords| {
        adapter.settings().chords = chords;
        adapter.adapt(&MeshView::of(&input), &metric)
    };
    let (expected, _) = made_of(|p| sizes_at_wall(p, 2e-4), &[]);
    let found = adapt(ChordLimit::Auto).unwrap();
    let told = found.chords.unwrap();
    // As text, too: the last digit of a number may be lost on the way through it.
    let as_text = serde_json::to_string(&told).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&as_text).unwrap(), expected.report["chords"]);
    assert_eq!(found.mesh.vertices, expected.mesh.vertices);
    assert!(found.metric.iter().zip(&expected.metrics).all(|(a, b)| *a == b.0));
    assert_eq!(adapt(ChordLimit::Share(0.5)).unwrap().mesh, found.mesh);
    assert!(adapt(ChordLimit::Off).unwrap().chords.is_none());
    for share in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(matches!(adapt(ChordLimit::Share(share)), Err(Error::Share { .. })), "{share}");
    }
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
