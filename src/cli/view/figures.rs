//! What is told beside the picture, and the edges of a model.
use crate::cli::table::figure;
use crate::geometry::{Evaluate, Geometry, Model};
use crate::mesh::vector::Vec3;
use crate::metric::Statistics;

/// Chords of a curve that is not straight.
const CHORDS: u32 = 96;

/// The edges of a model as polygons.
pub fn edges_of(model: &Model) -> Vec<Vec<Vec3>> {
    let mut evaluator = model.evaluator();
    let topology = model.topology();
    let edges = (0..topology.edges.len() as u32).filter(|&edge| topology.is_ridge(edge));
    edges
        .map(|edge| {
            let [first, last] = topology.edges[edge as usize].range;
            let along = |i: u32| first + (last - first) * f64::from(i) / f64::from(CHORDS);
            (0..=CHORDS).map(|i| evaluator.edge_frame(edge, along(i)).point).collect()
        })
        .collect()
}

/// A row of the table.
pub fn row(name: &str, value: &str) -> [String; 2] {
    [name.into(), value.into()]
}

/// The figures of a mesh for its page.
pub fn figures(statistics: &Statistics) -> Vec<[String; 2]> {
    let (lengths, ratios) = (&statistics.edge_lengths, &statistics.mean_ratios);
    let mut rows = vec![
        row("vertices", &statistics.vertices.to_string()),
        row("tetrahedra", &statistics.tets.to_string()),
        row("triangles", &statistics.triangles.to_string()),
        row("tagged edges", &statistics.tagged_edges.to_string()),
    ];
    if statistics.tets > 0 {
        rows.push(row("volume", &figure(statistics.volume)));
        rows.push(row("mean ratio, least", &figure(ratios.min)));
        rows.push(row("mean ratio, mean", &figure(ratios.mean)));
        let unit = if statistics.metric.is_some() { "in the metric" } else { "model units" };
        for (what, value) in [("least", lengths.min), ("mean", lengths.mean), ("greatest", lengths.max)] {
            rows.push(row(&format!("edge length, {unit}, {what}"), &figure(value)));
        }
    }
    if let Some(metric) = &statistics.metric {
        rows.push(row("unit edges (1/√2 to √2)", &format!("{:.2} %", 100.0 * metric.unit_edges)));
        rows.push(row("complexity", &figure(metric.complexity)));
        rows.push(row("vertices / complexity", &figure(metric.vertices_per_complexity)));
    }
    rows
}
