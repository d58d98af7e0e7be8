//! The listing of a model for people: entities count from 1.
use super::listing::Face;
use crate::geometry::{ClosedGap, EdgeEntity, Geometry, Label, Model, Topology, VertexEntity};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

/// The listing.
pub fn describe(model: &Model) -> String {
    let topology = model.topology();
    let mut text = String::new();
    let faces = Face::all(model);
    let rows: Vec<_> = faces.iter().map(|face| face_row(face, model)).collect();
    let head = ["", "surface", "name", "area", "centre", "normal", "neighbours", "edges"];
    table(&mut text, "Faces", &head, &rows);
    let rows: Vec<_> = faces.iter().map(|face| shape_row(face, topology.diagonal())).collect();
    table(&mut text, "Their boxes and parameters", &["", "from", "to", "u", "v", "tolerance"], &rows);
    let rows: Vec<_> = topology.edges.iter().zip(0..).map(|(edge, i)| edge_row(i, edge, model)).collect();
    table(&mut text, "Edges", &["", "curve", "length", "t", "vertices", "tolerance", "faces", ""], &rows);
    let row = |(vertex, i): (&VertexEntity, u32)| {
        let [x, y, z] = vertex.point.map(|x| number_beside(x, topology.diagonal()));
        vec![(i + 1).to_string(), x, y, z, format!("{:.1e}", vertex.tolerance), list(&vertex.edges)]
    };
    let rows: Vec<_> = topology.vertices.iter().zip(0..).map(row).collect();
    table(&mut text, "Vertices", &["", "x", "y", "z", "tolerance", "edges"], &rows);
    let row =
        |gap: &ClosedGap| vec![(gap.edge + 1).to_string(), format!("{:.1e}", gap.before), format!("{:.1e}", gap.after)];
    let rows: Vec<_> = model.closed_gaps().iter().map(row).collect();
    if !rows.is_empty() {
        table(&mut text, "Edges that were moved onto their faces", &["", "off them", "now"], &rows);
    }
    let names = model.names();
    for (title, labels) in
        [("Names of solids", &names.tetrahedra), ("Names of faces", &names.triangles), ("Names of edges", &names.edges)]
    {
        if !labels.is_empty() {
            table(&mut text, title, &["", "name", "colour"], &label_rows(labels));
        }
    }
    summarize(&mut text, topology);
    let bridged = model.faces_on_bridge();
    if !bridged.is_empty() {
        let _ = writeln!(
            text,
            "by OpenCASCADE     faces {} (no native evaluation of their surface: slower)",
            list(&bridged)
        );
    }
    text
}

fn face_row(face: &Face<'_>, model: &Model) -> Vec<String> {
    let size = model.topology().diagonal();
    let label = model.names().triangles.get(&(face.number as i32));
    let normal = match face.normal {
        _ if face.closed => "all round".into(),
        None => "-".into(),
        Some(normal) => triple(normal, 1.0),
    };
    vec![
        face.number.to_string(),
        name(&face.entity.kind),
        label.and_then(|label| label.name.clone()).unwrap_or_else(|| "-".into()),
        face.area.map_or("-".into(), number),
        face.centre.map_or("-".into(), |centre| triple(centre, size)),
        normal,
        numbers(&face.neighbours),
        list(&face.entity.edges),
    ]
}

fn shape_row(face: &Face<'_>, size: f64) -> Vec<String> {
    let entity = face.entity;
    vec![
        face.number.to_string(),
        triple(entity.bounds[0], size),
        triple(entity.bounds[1], size),
        interval(entity.range[0], entity.period[0]),
        interval(entity.range[1], entity.period[1]),
        format!("{:.1e}", entity.tolerance),
    ]
}

fn edge_row(index: u32, edge: &EdgeEntity, model: &Model) -> Vec<String> {
    let mark = match (edge.seam, edge.degenerate) {
        (true, _) => "seam",
        (_, true) => "degenerate",
        _ => "",
    };
    vec![
        (index + 1).to_string(),
        name(&edge.kind),
        model.edge_length(index).map_or("-".into(), number),
        interval(edge.range, edge.period),
        edge.vertices.map(|v| v.map_or("-".into(), |v| (v + 1).to_string())).join(" "),
        format!("{:.1e}", edge.tolerance),
        list(&edge.faces),
        mark.into(),
    ]
}

fn label_rows(labels: &BTreeMap<i32, Label>) -> Vec<Vec<String>> {
    let cell = |text: &Option<String>| text.clone().unwrap_or_else(|| "-".into());
    labels.iter().map(|(number, label)| vec![number.to_string(), cell(&label.name), cell(&label.colour)]).collect()
}

/// How many entities of each kind there are.
pub fn counts(topology: &Topology) -> [String; 4] {
    let count = |n: usize, one: &str, more: &str| format!("{n} {}", if n == 1 { one } else { more });
    [
        count(topology.solids as usize, "solid", "solids"),
        count(topology.faces.len(), "face", "faces"),
        count(topology.edges.len(), "edge", "edges"),
        count(topology.vertices.len(), "vertex", "vertices"),
    ]
}

/// What tells each face from others, in a line, by its number.
pub fn about(model: &Model) -> BTreeMap<i32, String> {
    let size = model.topology().diagonal();
    let line = |face: Face<'_>| {
        let mut parts = vec![name(&face.entity.kind)];
        parts.extend(face.area.map(|area| format!("area {}", number(area))));
        parts.extend(face.centre.map(|centre| format!("centre {}", triple(centre, size))));
        parts.extend(match face.normal {
            Some(normal) if !face.closed => Some(format!("normal {}", triple(normal, 1.0))),
            _ => None,
        });
        parts.push(format!("neighbours {}", numbers(&face.neighbours)));
        (face.number as i32, parts.join("  ·  "))
    };
    Face::all(model).into_iter().map(line).collect()
}

/// What is said of a model that was written.
pub fn written(model: &Model, to: &Path) -> String {
    let mut text = String::new();
    summarize(&mut text, model.topology());
    let _ = writeln!(text, "written            {}", to.display());
    text
}

fn summarize(text: &mut String, topology: &Topology) {
    let corner = |point: [f64; 3]| point.map(|x| number_beside(x, topology.diagonal())).join(" ");
    let [low, high] = topology.bounds;
    let seams = topology.edges.iter().filter(|edge| edge.seam).count();
    let degenerate = topology.edges.iter().filter(|edge| edge.degenerate).count();
    let [solids, faces, edges, vertices] = counts(topology);
    let _ = writeln!(text, "{solids}, {faces}, {edges} ({seams} seam, {degenerate} degenerate), {vertices}");
    let _ = writeln!(text, "box                {}  to  {}", corner(low), corner(high));
    let _ = writeln!(text, "diagonal           {}", number(topology.diagonal()));
    let _ = writeln!(text, "largest tolerance  {:.1e}", topology.tolerance);
}

/// The name that JSON has for a kind.
fn name(kind: &impl Serialize) -> String {
    serde_json::to_value(kind).ok().and_then(|value| value.as_str().map(String::from)).unwrap_or_default()
}

/// A range of parameters, and its period.
fn interval(range: [f64; 2], period: Option<f64>) -> String {
    let [low, high] = range.map(|x| number_beside(x, range[1] - range[0]));
    let period = period.map_or(String::new(), |period| format!(" of {}", number(period)));
    format!("{low}..{high}{period}")
}

/// The number, or 0 where it is negligible beside `size`.
fn number_beside(x: f64, size: f64) -> String {
    number(if x.abs() < 1e-6 * size { 0.0 } else { x })
}

/// Six digits, without trailing zeros; what rounds to nothing is 0.
fn number(x: f64) -> String {
    if x != 0.0 && (x.abs() < 1e-4 || x.abs() >= 1e7) {
        return if x.abs() < 1e-12 { "0".into() } else { format!("{x:.5e}") };
    }
    let digits = if x == 0.0 { 0 } else { (5 - x.abs().log10().floor() as i32).clamp(0, 9) as usize };
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

/// Three numbers, without blanks: a cell, and an argument of `--name NAME=near:`.
fn triple(vector: [f64; 3], size: f64) -> String {
    vector.map(|x| number_beside(x, size)).join(",")
}

fn numbers(numbers: &[u32]) -> String {
    numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(" ")
}

/// Indices from 1.
fn list(indices: &[u32]) -> String {
    indices.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(" ")
}

/// Appends a table; the last columns are not padded.
fn table(text: &mut String, title: &str, head: &[&str], rows: &[Vec<String>]) {
    let mut widths: Vec<_> = head.iter().map(|cell| cell.chars().count()).collect();
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let _ = writeln!(text, "{title}");
    let head: Vec<_> = head.iter().map(|cell| cell.to_string()).collect();
    for row in std::iter::once(&head).chain(rows) {
        let cells: Vec<_> = row
            .iter()
            .zip(&widths)
            .enumerate()
            // The number to the right, the rest to the left.
            .map(|(k, (cell, &width))| if k == 0 { format!("{cell:>width$}") } else { format!("{cell:<width$}") })
            .collect();
        let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
    }
    let _ = writeln!(text);
}
