//! Tables and histograms as text, for `inspect` and the report of `adapt`.
use crate::geometry::fidelity::Fidelity;
use crate::mesh::vector::Vec3;
use crate::metric::statistics::{Class, Distribution, Statistics};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Width of the longest bar of a histogram, in characters.
const BAR: usize = 40;

/// References that are listed; of more only the number is given.
const LISTED: usize = 16;

/// A text table that grows row by row.
#[derive(Default)]
pub struct Table {
    text: String,
}

impl Table {
    /// Empty.
    pub fn new() -> Self {
        Self::default()
    }

    /// The text so far; lines end with a newline.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A row: what, and the figure.
    pub fn row(&mut self, name: &str, value: impl std::fmt::Display) {
        let _ = writeln!(self.text, "{name:<26} {value}");
    }

    /// A line as it is.
    pub fn line(&mut self, line: &str) {
        let _ = writeln!(self.text, "{line}");
    }

    /// Least, mean and greatest value, and the histogram with a bar a class. Empty classes at both ends are left out.
    pub fn distribution(&mut self, name: &str, distribution: &Distribution) {
        let Distribution { min, mean, max, classes, .. } = distribution;
        self.row(name, format_args!("least {}   mean {}   greatest {}", figure(*min), figure(*mean), figure(*max)));
        let Some(first) = classes.iter().position(|class| class.count > 0) else { return };
        let last = classes.iter().rposition(|class| class.count > 0).unwrap_or(first);
        let highest = classes.iter().map(|class| class.count).max().unwrap_or(1);
        for class in &classes[first..=last] {
            let share = 100.0 * class.count as f64 / distribution.count as f64;
            let bar = "#".repeat((class.count * BAR).div_ceil(highest));
            let _ = writeln!(self.text, "  {:>17} {:>10} {share:>6.2} %  {bar}", range(class), class.count);
        }
    }

    /// The figures of a mesh, in a metric when there is one.
    pub fn statistics(&mut self, statistics: &Statistics) {
        self.row("vertices", statistics.vertices);
        self.row("tetrahedra", format_args!("{}{}", statistics.tets, references("region", &statistics.regions)));
        self.row("triangles", format_args!("{}{}", statistics.triangles, references("reference", &statistics.patches)));
        self.row(
            "tagged edges",
            format_args!("{}{}", statistics.tagged_edges, references("reference", &statistics.curves)),
        );
        self.row("volume", figure(statistics.volume));
        let mut unit = "model units";
        if let Some(figures) = &statistics.metric {
            self.row("complexity", figure(figures.complexity));
            self.row("vertices / complexity", figure(figures.vertices_per_complexity));
            self.row("unit edges (1/√2 to √2)", format_args!("{:.2} %", 100.0 * figures.unit_edges));
            unit = "in the metric";
        }
        self.distribution(&format!("edge length, {unit}"), &statistics.edge_lengths);
        self.distribution("mean ratio", &statistics.mean_ratios);
    }

    /// The fidelity of the mesh to its model.
    pub fn fidelity(&mut self, fidelity: &Fidelity) {
        self.row("vertices on the model", fidelity.vertices);
        let farthest = [
            ("farthest from the model", &fidelity.from_model),
            ("farthest from its entity", &fidelity.from_entity),
            ("farthest that had to stay", &fidelity.held),
        ];
        for (name, found) in farthest {
            if let Some(found) = found {
                let (vertex, entity) = (found.vertex + 1, found.entity);
                let far = figure(found.distance);
                self.row(name, format_args!("{far} (vertex {vertex} on {entity} at {})", place(found.at)));
            }
        }
        if let Some(worst) = &fidelity.worst_normal {
            let (triangle, face, at) = (worst.triangle + 1, worst.face + 1, place(worst.at));
            let (value, mean) = (figure(worst.degrees), figure(fidelity.mean_normal_degrees));
            self.row(
                "worst normal deviation",
                format_args!("{value}° (triangle {triangle} on face {face} at {at}), mean {mean}°"),
            );
        }
    }
}

/// A point for people: six decimals; in powers of ten where it is very small or large, as on a model of micrometres.
pub fn place(point: Vec3) -> String {
    let magnitude = point.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let is_usual = magnitude == 0.0 || (1e-2..1e9).contains(&magnitude);
    let number = |x: f64| if is_usual { format!("{x:.6}") } else { format!("{x:.6e}") };
    let [x, y, z] = point.map(number);
    format!("({x}, {y}, {z})")
}

/// Four significant figures, in powers of ten when very small or large.
pub fn figure(x: f64) -> String {
    let magnitude = x.abs();
    if magnitude != 0.0 && !(1e-3..1e7).contains(&magnitude) {
        return format!("{x:.3e}");
    }
    let digits = if magnitude == 0.0 { 0 } else { (3 - magnitude.log10().floor() as i32).clamp(0, 6) };
    format!("{x:.*}", digits as usize)
}

fn range(class: &Class) -> String {
    match (class.low, class.high) {
        (None, Some(high)) => format!("≤ {high:.2}"),
        (Some(low), None) => format!("> {low:.2}"),
        (low, high) => format!("{:.2} – {:.2}", low.unwrap_or(0.0), high.unwrap_or(0.0)),
    }
}

/// References with their counts, in parentheses.
fn references(name: &str, counts: &BTreeMap<i32, usize>) -> String {
    if counts.is_empty() {
        return String::new();
    }
    let plural = if counts.len() == 1 { "" } else { "s" };
    let mut text = format!(" ({} {name}{plural}", counts.len());
    if counts.len() <= LISTED {
        let each: Vec<String> = counts.iter().map(|(reference, count)| format!("{reference}: {count}")).collect();
        let _ = write!(text, "; {}", each.join(", "));
    }
    text + ")"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_figures() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.000"),
            (0.12345, "0.1235"),
            (1234.56, "1235"),
            (2.5e-5, "2.500e-5"),
            (-3e9, "-3.000e9"),
        ];
        for (x, text) in cases {
            assert_eq!(figure(x), text);
        }
    }

    #[test]
    fn a_histogram_as_text() {
        let mut table = Table::new();
        table.distribution("value", &Distribution::of(&[0.5, 1.5, 1.6], &[-1.0, 0.0, 1.0, 2.0, 3.0], false));
        let expected = format!(
            "{:<26} least 0.5000   mean 1.200   greatest 1.600\n  {:>17} {:>10} {:>6} %  {}\n  {:>17} {:>10} {:>6} %  {}\n",
            "value",
            "0.00 – 1.00",
            1,
            "33.33",
            "#".repeat(20),
            "1.00 – 2.00",
            2,
            "66.67",
            "#".repeat(40)
        );
        assert_eq!(table.text(), expected);
    }

    #[test]
    fn references_with_counts() {
        assert_eq!(references("region", &BTreeMap::from([(1, 5), (7, 2)])), " (2 regions; 1: 5, 7: 2)");
        assert_eq!(references("region", &(0..20).map(|i| (i, 1)).collect()), " (20 regions)");
    }

    #[test]
    fn a_point_of_a_small_model_is_told_too() {
        assert_eq!(place([0.5, -0.25, 1200.0]), "(0.500000, -0.250000, 1200.000000)");
        assert_eq!(place([0.0; 3]), "(0.000000, 0.000000, 0.000000)");
        assert_eq!(place([1.25e-6, 0.0, -3e-7]), "(1.250000e-6, 0.000000e0, -3.000000e-7)");
    }
}
