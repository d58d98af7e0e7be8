//! The user's bounds of the surface where the metric asks for a coarser one.

use crate::common::adapting::{Adapted, Workplace};
use geo_adapt::mesh::io;
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::metric::Sym3;
use serde_json::json;

/// Adapts the own first mesh of a model to a metric, and checks that all vertices arrived on the model. Splits where they have no room lead nowhere,
/// and take minutes.
fn bounded(model: &str, metric: impl Fn(Vec3) -> Sym3, bounds: &[&str]) -> Adapted {
    let work = Workplace::new();
    let (model, start) = work.coarse_start(model);
    let metric = work.metric(&io::read_mesh(&start).unwrap().content, metric);
    let found = work.adapt(&start, &[&["--cad", &model, "--metric", &metric], bounds].concat());
    assert_eq!(found.report["off_model"], json!([]));
    found
}

#[test]
fn the_chord_error_is_bounded_on_a_torus_far_below_the_sizes() {
    // Edges of the size that is asked for would stray by 0.1 across the tube.
    let size = 0.46_f64.powi(-2);
    let found = bounded("torus.step", |_| Sym3::diagonal(size, size, size), &["--hausdorff", "0.0037"]);
    assert_eq!(found.report["deviating"], 0);
    let ratios = &found.report["statistics"]["mean_ratios"];
    assert!(ratios["min"].as_f64() > Some(0.05), "{ratios}");
}

#[test]
fn normals_are_bounded_where_a_thin_layer_crosses_a_round_wall() {
    let layer = |[_, y, _]: Vec3| {
        let across = (2e-5 + (y + 0.12).abs() / 3.0).min(0.17);
        Sym3::diagonal(0.17_f64.powi(-2), across.powi(-2), 0.17_f64.powi(-2))
    };
    let found = bounded("spheroid.step", layer, &["--complexity", "1500", "--normal-deviation", "30"]);
    let figures = &found.report["statistics"];
    assert!(figures["mean_ratios"]["min"].as_f64() > Some(0.05), "{figures}");
    assert!(figures["metric"]["unit_edges"].as_f64() > Some(0.8), "{figures}");
    // Within the layer itself no straight triangle can be: it would have to be far shorter along the wall than is asked.
    let [beyond, triangles] = [found.report["deviating"].as_u64().unwrap() as usize, found.mesh.triangles.nodes.len()];
    assert!(beyond < triangles / 10, "{beyond} of {triangles}");
}
