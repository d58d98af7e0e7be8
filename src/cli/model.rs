//! `geo-adapt model`.
use super::{Outcome, load};
use crate::geometry::{EdgeEntity, FaceEntity, Geometry, Label, Model, Names, Topology, VertexEntity};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt model`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model: .step, .stp, .iges, .igs, .brep or .egads
    file: PathBuf,
    /// Print JSON; there the indices count from 0
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let model = load::model(&arguments.file)?;
    let text =
        if arguments.json { serde_json::to_string_pretty(&Listing::new(&model))? + "\n" } else { describe(&model) };
    super::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// What --json prints.
#[derive(Serialize)]
struct Listing<'a> {
    solids: u32,
    bounds: [[f64; 3]; 2],
    diagonal: f64,
    tolerance: f64,
    faces: Vec<Face<'a>>,
    edges: Vec<Edge<'a>>,
    vertices: &'a [VertexEntity],
    /// By numbers from 1, as references of a mesh are.
    names: &'a Names,
}

#[derive(Serialize)]
struct Face<'a> {
    #[serde(flatten)]
    entity: &'a FaceEntity,
    area: Option<f64>,
}

#[derive(Serialize)]
struct Edge<'a> {
    #[serde(flatten)]
    entity: &'a EdgeEntity,
    length: Option<f64>,
}

impl<'a> Listing<'a> {
    fn new(model: &'a Model) -> Self {
        let topology = model.topology();
        let faces = topology.faces.iter().zip(0..).map(|(entity, i)| Face { entity, area: model.face_area(i) });
        let edges = topology.edges.iter().zip(0..).map(|(entity, i)| Edge { entity, length: model.edge_length(i) });
        Self {
            solids: topology.solids,
            bounds: topology.bounds,
            diagonal: topology.diagonal(),
            tolerance: topology.tolerance,
            faces: faces.collect(),
            edges: edges.collect(),
            vertices: &topology.vertices,
            names: model.names(),
        }
    }
}

/// The listing for people: entities count from 1.
fn describe(model: &Model) -> String {
    let topology = model.topology();
    let mut text = String::new();
    let rows: Vec<_> = topology.faces.iter().zip(0..).map(|(face, i)| face_row(i, face, model)).collect();
    table(&mut text, "Faces", &["", "surface", "area", "u", "v", "tolerance", "edges"], &rows);
    let rows: Vec<_> = topology.edges.iter().zip(0..).map(|(edge, i)| edge_row(i, edge, model)).collect();
    table(&mut text, "Edges", &["", "curve", "length", "t", "vertices", "tolerance", "faces", ""], &rows);
    let row = |(vertex, i): (&VertexEntity, u32)| {
        let [x, y, z] = vertex.point.map(|x| number_beside(x, topology.diagonal()));
        vec![(i + 1).to_string(), x, y, z, format!("{:.1e}", vertex.tolerance), list(&vertex.edges)]
    };
    let rows: Vec<_> = topology.vertices.iter().zip(0..).map(row).collect();
    table(&mut text, "Vertices", &["", "x", "y", "z", "tolerance", "edges"], &rows);
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

fn face_row(index: u32, face: &FaceEntity, model: &Model) -> Vec<String> {
    vec![
        (index + 1).to_string(),
        name(&face.kind),
        model.face_area(index).map_or("-".into(), number),
        interval(face.range[0], face.period[0]),
        interval(face.range[1], face.period[1]),
        format!("{:.1e}", face.tolerance),
        list(&face.edges),
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

fn summarize(text: &mut String, topology: &Topology) {
    let count = |n: usize, one: &str, more: &str| format!("{n} {}", if n == 1 { one } else { more });
    let seams = topology.edges.iter().filter(|edge| edge.seam).count();
    let degenerate = topology.edges.iter().filter(|edge| edge.degenerate).count();
    let parts = [
        count(topology.solids as usize, "solid", "solids"),
        count(topology.faces.len(), "face", "faces"),
        count(topology.edges.len(), "edge", "edges") + &format!(" ({seams} seam, {degenerate} degenerate)"),
        count(topology.vertices.len(), "vertex", "vertices"),
    ];
    let corner = |point: [f64; 3]| point.map(|x| number_beside(x, topology.diagonal())).join(" ");
    let [low, high] = topology.bounds;
    let _ = writeln!(text, "{}", parts.join(", "));
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
