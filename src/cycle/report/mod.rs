//! The report of a loop: one page that loads nothing, its charts drawn as SVG here, so that it needs no program either.
mod axis;
mod bars;
mod curve;
mod text;

use super::config::Config;
use super::error::Error;
use super::history::{Cycle, History};
use super::layout::Layout;
use crate::mesh::io::write_beside;
use crate::view::base64;
use std::fmt::Write;
use text::{escaped, short};

const FRAME: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");

/// Writes the page.
///
/// # Errors
/// When it cannot be written.
pub fn write(layout: &Layout, config: &Config, history: &History) -> Result<(), Error> {
    let page = page(layout, config, history);
    Ok(write_beside(&layout.page(), |file| file.write_all(page.as_bytes()))?)
}

fn page(layout: &Layout, config: &Config, history: &History) -> String {
    let title = layout.root().file_name().map_or_else(|| "loop".into(), |name| escaped(&name.to_string_lossy()));
    let parts = [
        ("title", title),
        ("style", STYLE.into()),
        (
            "state",
            history
                .ended
                .as_ref()
                .map_or_else(|| "still running".into(), |reason| format!("ended: {}", escaped(reason))),
        ),
        ("summary", summary(history)),
        ("curves", curve::functionals(history)),
        ("seconds", bars::seconds(history)),
        ("table", table(history)),
        ("meshes", meshes(layout, history)),
        ("config", escaped(&toml::to_string(config).unwrap_or_default())),
    ];
    // One pass, so that what is put in is never looked at again.
    let (mut page, mut rest) = (String::new(), FRAME);
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, behind) = after.split_once("}}").unwrap_or((after, ""));
        page += before;
        page += parts.iter().find(|(part, _)| *part == name).map_or("", |(_, text)| text);
        rest = behind;
    }
    page + rest
}

/// The last mesh in figures.
fn summary(history: &History) -> String {
    let Some(last) = history.cycles.last() else { return String::new() };
    let mut tiles = vec![("vertices", last.vertices.to_string()), ("tetrahedra", last.tets.to_string())];
    if let Some(share) = unit_edges(last) {
        tiles.push(("unit edges", format!("{:.1} %", 100.0 * share)));
    }
    tiles.extend(last.functionals.iter().map(|(name, &value)| (name.as_str(), short(value))));
    let seconds: f64 =
        history.cycles.iter().flat_map(|cycle| cycle.seconds.values()).sum::<f64>() + history.start_seconds;
    tiles.push(("time", text::duration(seconds)));
    tiles.iter().map(|(name, value)| format!("<div><b>{value}</b><span>{}</span></div>", escaped(name))).collect()
}

fn unit_edges(cycle: &Cycle) -> Option<f64> {
    cycle.statistics.as_ref()?["metric"]["unit_edges"].as_f64()
}

/// A row a cycle.
fn table(history: &History) -> String {
    let names: Vec<&String> = history.cycles.first().map_or_else(Vec::new, |cycle| cycle.functionals.keys().collect());
    let mut html = String::from(
        "<thead><tr><th>cycle<th>complexity<th>vertices<th>tetrahedra<th>unit edges<th>least ratio<th>mean ratio",
    );
    names.iter().for_each(|name| html += &format!("<th>{}", escaped(name)));
    html += "<th>seconds</tr></thead><tbody>";
    for cycle in &history.cycles {
        let ratio = |which: &str| cycle.statistics.as_ref().and_then(|all| all["mean_ratios"][which].as_f64());
        let dash = |value: Option<String>| value.unwrap_or_else(|| "–".into());
        let seconds: f64 = cycle.seconds.values().sum();
        let _ = write!(
            html,
            "<tr><td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}",
            cycle.cycle,
            dash(cycle.complexity.map(short)),
            cycle.vertices,
            cycle.tets,
            dash(unit_edges(cycle).map(|share| format!("{:.1} %", 100.0 * share))),
            dash(ratio("min").map(|value| format!("{value:.3}"))),
            dash(ratio("mean").map(|value| format!("{value:.3}"))),
        );
        names
            .iter()
            .for_each(|&name| html += &format!("<td>{}", dash(cycle.functionals.get(name).map(|&value| short(value)))));
        html += &format!("<td>{seconds:.1}</tr>");
    }
    html + "</tbody>"
}

/// How a mesh was adapted part by part.
fn by_processes(processes: usize) -> String {
    if processes > 1 { format!(", part by part by {processes} processes") } else { ", part by part".into() }
}

/// Each adapted mesh: pictures where there are, and its histograms.
fn meshes(layout: &Layout, history: &History) -> String {
    let mut html = String::new();
    for cycle in history.cycles.iter().rev() {
        let Some(statistics) = &cycle.statistics else { continue };
        let complexity =
            cycle.complexity.map_or_else(String::new, |complexity| format!("complexity {}, ", short(complexity)));
        let _ = write!(
            html,
            "<article><h3>Mesh of cycle {}: {complexity}{} vertices{}</h3><div class=\"row\">",
            cycle.cycle,
            cycle.vertices,
            cycle.processes.map_or_else(String::new, by_processes)
        );
        if cycle.pictures {
            for (file, what) in [("surface.png", "surface"), ("cut.png", "cut")] {
                if let Ok(bytes) = std::fs::read(layout.step(cycle.cycle, "picture").join(file)) {
                    let _ = write!(
                        html,
                        "<figure class=\"picture\"><img alt=\"{what} of the mesh of cycle {}\" src=\"data:image/png;base64,{}\"><figcaption>{what}</figcaption></figure>",
                        cycle.cycle,
                        base64(&bytes)
                    );
                }
            }
        }
        html += "<div class=\"histograms\">";
        html += &bars::histogram(&statistics["edge_lengths"], "edge lengths in the metric", true);
        html += &bars::histogram(&statistics["mean_ratios"], "mean ratios in the metric", false);
        html += "</div></div></article>";
    }
    html
}
