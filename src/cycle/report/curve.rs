//! Functionals against the number of vertices.
use super::axis::Axis;
use super::text::{escaped, short};
use crate::cycle::history::{Cycle, History};
use std::fmt::Write;

/// Size of a chart, pixels, and the room for its axes at the left and below.
const SIZE: [f64; 2] = [460.0, 300.0];
const LEFT: f64 = 64.0;
const BELOW: f64 = 44.0;

/// Complexities that the order of an error is fitted to.
const FITTED: usize = 3;

/// A chart for each functional.
pub fn functionals(history: &History) -> String {
    let names: Vec<&String> = history.cycles.first().map_or_else(Vec::new, |cycle| cycle.functionals.keys().collect());
    names.into_iter().map(|name| chart(history, name)).collect()
}

/// The last cycle of each complexity.
fn last_of_each(history: &History) -> Vec<&Cycle> {
    let cycles = &history.cycles;
    let ends =
        (0..cycles.len()).filter(|&at| cycles.get(at + 1).is_none_or(|next| next.complexity != cycles[at].complexity));
    ends.map(|at| &cycles[at]).collect()
}

/// p of the line ln value = c - p ln vertices through the last complexities, by least squares.
fn order(history: &History, name: &str) -> Option<f64> {
    let points: Vec<[f64; 2]> = last_of_each(history)
        .into_iter()
        .filter(|cycle| cycle.complexity.is_some())
        .filter_map(|cycle| Some([(cycle.vertices as f64).ln(), cycle.functionals.get(name)?.ln()]))
        .collect();
    let points = &points[points.len().checked_sub(FITTED)?..];
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>()
        / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    slope.is_finite().then_some(-slope)
}

fn chart(history: &History, name: &str) -> String {
    let points: Vec<(&Cycle, [f64; 2])> = history
        .cycles
        .iter()
        .filter_map(|cycle| Some((cycle, [cycle.vertices as f64, *cycle.functionals.get(name)?])))
        .filter(|(_, [x, y])| *x > 0.0 && y.is_finite())
        .collect();
    let values: Vec<f64> = points.iter().map(|(_, point)| point[1]).collect();
    let positive = values.iter().all(|&value| value > 0.0);
    let spread = values.iter().copied().fold(0.0, f64::max) / values.iter().copied().fold(f64::INFINITY, f64::min);
    let logarithmic = positive && (spread > 8.0 || name.contains("error"));
    let across = Axis::of(&points.iter().map(|(_, point)| point[0]).collect::<Vec<_>>(), true, [LEFT, SIZE[0] - 14.0]);
    let up = Axis::of(&values, logarithmic, [SIZE[1] - BELOW, 12.0]);
    let mut svg = format!(
        "<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{} against vertices\">",
        SIZE[0],
        SIZE[1],
        escaped(name)
    );
    grid(&mut svg, &across, &up);
    let _ =
        write!(svg, "<text class=\"title\" x=\"{}\" y=\"{}\">vertices</text>", (LEFT + SIZE[0]) / 2.0, SIZE[1] - 6.0);
    let places: Vec<String> =
        points.iter().map(|(_, [x, y])| format!("{:.1},{:.1}", across.at(*x), up.at(*y))).collect();
    let _ = write!(svg, "<polyline class=\"line\" points=\"{}\"/>", places.join(" "));
    let last: Vec<u32> = last_of_each(history).iter().map(|cycle| cycle.cycle).collect();
    for (cycle, [x, y]) in &points {
        let class = if last.contains(&cycle.cycle) { "point" } else { "point early" };
        let _ = write!(
            svg,
            "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.5\"><title>cycle {}: {x} vertices, {} {}</title></circle>",
            across.at(*x),
            up.at(*y),
            cycle.cycle,
            escaped(name),
            short(*y)
        );
    }
    svg += "</svg>";
    // A functional that does not go to zero has no order.
    let note = order(history, name).filter(|_| name.contains("error")).map_or_else(String::new, |order| {
        format!(
            ": falls with vertices to the power {:.2} over the last {FITTED} complexities (second order is 0.67)",
            order
        )
    });
    format!("<figure><figcaption><b>{}</b>{note}</figcaption>{svg}</figure>", escaped(name))
}

/// Lines and numbers at the ticks.
pub fn grid(svg: &mut String, across: &Axis, up: &Axis) {
    for (value, text) in up.ticks() {
        let y = up.at(value);
        let _ =
            write!(svg, "<line class=\"grid\" x1=\"{LEFT}\" x2=\"{}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>", SIZE[0] - 14.0);
        let _ = write!(svg, "<text class=\"up\" x=\"{}\" y=\"{:.1}\">{text}</text>", LEFT - 8.0, y);
    }
    for (value, text) in across.ticks() {
        let x = across.at(value);
        let _ = write!(svg, "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"12\" y2=\"{}\"/>", SIZE[1] - BELOW);
        let _ = write!(svg, "<text class=\"across\" x=\"{x:.1}\" y=\"{}\">{text}</text>", SIZE[1] - BELOW + 16.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(values: &[(f64, usize, f64)]) -> History {
        let mut history = History::default();
        for (at, &(complexity, vertices, value)) in values.iter().enumerate() {
            let functionals = [("error <L2>".to_owned(), value)].into();
            history.cycles.push(Cycle {
                cycle: at as u32 + 1,
                complexity: Some(complexity),
                vertices,
                functionals,
                ..Cycle::default()
            });
        }
        history
    }

    #[test]
    fn the_order_is_that_of_the_last_of_each_complexity() {
        // The first at a complexity is far off; errors fall with N^-2/3.
        let rows: Vec<(f64, usize, f64)> = (0..4)
            .flat_map(|n| {
                let v = 1000 << n;
                [(f64::from(n), v, 9.0), (f64::from(n), v, (v as f64).powf(-2.0 / 3.0))]
            })
            .collect();
        let history = history(&rows);
        assert!((order(&history, "error <L2>").unwrap() - 2.0 / 3.0).abs() < 1e-12);
        let html = functionals(&history);
        assert!(html.contains("power 0.67") && html.contains("error &lt;L2&gt;"), "{html}");
        assert_eq!(html.matches("class=\"point\"").count(), 4);
        assert_eq!(html.matches("class=\"point early\"").count(), 4);
    }

    #[test]
    fn a_single_cycle_is_drawn_too() {
        let html = functionals(&history(&[(1.0, 10, -3.0)]));
        assert!(html.contains("circle") && !html.contains("NaN") && !html.contains("inf"), "{html}");
    }
}
