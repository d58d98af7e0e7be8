//! Thin layers that cross curved walls at an angle.

use crate::common::adapting::Workplace;
use geo_adapt::mesh::io;
use geo_adapt::mesh::vector::Vec3;
use geo_adapt::metric::Sym3;

/// Within a layer across y a chord of the spheroid rises by hundreds of layers along the wall's normal, though in its own layer by a tenth of an edge.
#[test]
fn a_thin_layer_that_crosses_a_spheroid_leaves_no_very_bad_cells_at_its_wall() {
    let work = Workplace::new();
    let (model, start) = work.coarse_start("spheroid.step");
    let layer = |[_, y, _]: Vec3| {
        let across = (2e-5 + (y + 0.12).abs() / 3.0).min(0.17);
        Sym3::diagonal(0.17_f64.powi(-2), across.powi(-2), 0.17_f64.powi(-2))
    };
    let metric = work.metric(&io::read_mesh(&start).unwrap().content, layer);
    let found = work.adapt(&start, &["--cad", &model, "--metric", &metric, "--complexity", "1500"]);
    let [figures, fidelity] = ["statistics", "fidelity"].map(|name| &found.report[name]);
    let ratios = &figures["mean_ratios"];
    let bad: u64 =
        ratios["classes"].as_array().unwrap()[..5].iter().map(|class| class["count"].as_u64().unwrap()).sum();
    assert_eq!(ratios["classes"][4]["high"], 0.3);
    assert!(ratios["min"].as_f64() > Some(0.15) && bad < 20, "{ratios}");
    assert!(figures["metric"]["unit_edges"].as_f64() > Some(0.9), "{}", figures["metric"]);
    // No triangle looks to the model's inside.
    assert!(fidelity["worst_normal"]["degrees"].as_f64() < Some(90.0), "{fidelity}");
    assert_eq!(found.report["off_model"], serde_json::json!([]));
}
