//! Bars: seconds by step, one above the other, and the histograms of a mesh.
use super::axis::Axis;
use super::text::short;
use crate::cycle::history::History;
use crate::cycle::layout::STEPS;
use serde_json::Value;
use std::fmt::Write;

/// Size of a chart, pixels.
const SIZE: [f64; 2] = [460.0, 300.0];
/// Size of a histogram.
const SMALL: [f64; 2] = [300.0, 190.0];

/// Seconds of each cycle, its steps above each other.
pub fn seconds(history: &History) -> String {
    let totals: Vec<f64> = history.cycles.iter().map(|cycle| cycle.seconds.values().sum()).collect();
    let up = Axis::from_zero(totals.iter().copied().fold(0.0, f64::max) * 1.05, [SIZE[1] - 44.0, 12.0]);
    let mut svg = format!(
        "<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"seconds by cycle\">",
        SIZE[0], SIZE[1]
    );
    for (value, text) in up.ticks() {
        let y = up.at(value);
        let _ = write!(
            svg,
            "<line class=\"grid\" x1=\"64\" x2=\"446\" y1=\"{y:.1}\" y2=\"{y:.1}\"/><text class=\"up\" x=\"56\" y=\"{y:.1}\">{text}</text>"
        );
    }
    let wide = 382.0 / history.cycles.len().max(1) as f64;
    for (at, cycle) in history.cycles.iter().enumerate() {
        let left = 64.0 + wide * (at as f64 + 0.12);
        let mut below = 0.0;
        for step in STEPS {
            let Some(&seconds) = cycle.seconds.get(step) else { continue };
            let (low, high) = (up.at(below), up.at(below + seconds));
            let _ = write!(
                svg,
                "<rect class=\"{step}\" x=\"{left:.1}\" y=\"{high:.1}\" width=\"{:.1}\" height=\"{:.1}\"><title>cycle {}, {step}: {} s</title></rect>",
                wide * 0.76,
                (low - high).max(0.0),
                cycle.cycle,
                short(seconds)
            );
            below += seconds;
        }
        // Of many cycles only some are named.
        if at % history.cycles.len().div_ceil(16) == 0 {
            let _ = write!(
                svg,
                "<text class=\"across\" x=\"{:.1}\" y=\"{}\">{}</text>",
                left + wide * 0.38,
                SIZE[1] - 28.0,
                cycle.cycle
            );
        }
    }
    let _ = write!(svg, "<text class=\"title\" x=\"262\" y=\"{}\">cycle</text></svg>", SIZE[1] - 6.0);
    let used = STEPS.iter().filter(|&&step| history.cycles.iter().any(|cycle| cycle.seconds.contains_key(step)));
    let legend: String =
        used.map(|step| format!("<span class=\"key\"><i class=\"{step}\"></i>{step}</span>")).collect();
    format!("<figure><figcaption><b>seconds</b> {legend}</figcaption>{svg}</figure>")
}

/// A histogram of a distribution as `adapt --report` has it; classes of unit length stand out with `lengths`.
pub fn histogram(distribution: &Value, title: &str, lengths: bool) -> String {
    let Some(classes) = distribution["classes"].as_array() else { return String::new() };
    let counts: Vec<f64> = classes.iter().map(|class| class["count"].as_f64().unwrap_or(0.0)).collect();
    let total: f64 = counts.iter().sum();
    let up = Axis::from_zero(counts.iter().copied().fold(0.0, f64::max), [SMALL[1] - 40.0, 16.0]);
    let wide = (SMALL[0] - 8.0) / counts.len().max(1) as f64;
    let mut svg =
        format!("<svg class=\"small\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{title}\">", SMALL[0], SMALL[1]);
    for (at, (class, count)) in classes.iter().zip(&counts).enumerate() {
        let [low, high] = ["low", "high"].map(|end| class[end].as_f64());
        let left = 4.0 + wide * at as f64;
        let (top, bottom) = (up.at(*count), up.at(0.0));
        let unit = lengths && low.is_some_and(|low| low > 0.7) && high.is_some_and(|high| high < 1.5);
        let range = match (low, high) {
            (None, Some(high)) => format!("at most {}", short(high)),
            (Some(low), None) => format!("above {}", short(low)),
            (low, high) => format!("{} to {}", short(low.unwrap_or(0.0)), short(high.unwrap_or(0.0))),
        };
        let share = if total > 0.0 { 100.0 * count / total } else { 0.0 };
        if *count > 0.0 {
            let _ = write!(
                svg,
                "<rect class=\"{}\" x=\"{:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\"><title>{range}: {count} ({share:.2} %)</title></rect>",
                if unit { "unit" } else { "bar" },
                left + 1.0,
                wide - 2.0,
                bottom - top
            );
        }
        if share >= 0.05 {
            let text = if share >= 9.95 { format!("{share:.0}") } else { format!("{share:.1}") };
            let _ = write!(
                svg,
                "<text class=\"share\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
                left + wide / 2.0,
                top - 4.0
            );
        }
        if let Some(high) = high {
            let text = trimmed(high);
            let _ =
                write!(svg, "<text class=\"bound\" x=\"{:.1}\" y=\"{}\">{text}</text>", left + wide, SMALL[1] - 26.0);
        }
    }
    let figure = |which: &str| distribution[which].as_f64().map_or_else(|| "–".into(), short);
    let _ = write!(
        svg,
        "<text class=\"title\" x=\"{}\" y=\"{}\">least {}, mean {}, greatest {}</text></svg>",
        SMALL[0] / 2.0,
        SMALL[1] - 6.0,
        figure("min"),
        figure("mean"),
        figure("max")
    );
    format!("<figure class=\"histogram\"><figcaption>{title}, % of all</figcaption>{svg}</figure>")
}

/// Two decimals at most.
fn trimmed(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::history::Cycle;
    use serde_json::json;

    #[test]
    fn bars_stand_on_each_other() {
        let cycle = Cycle { cycle: 1, seconds: [("solve", 1.0), ("adapt", 3.0)].into(), ..Cycle::default() };
        let html = seconds(&History { cycles: vec![cycle], ..History::default() });
        assert_eq!(html.matches("<rect").count(), 2);
        assert!(html.contains("cycle 1, adapt: 3 s") && !html.contains("transfer"), "{html}");
    }

    #[test]
    fn a_histogram_has_a_bar_a_class() {
        let middle = std::f64::consts::FRAC_1_SQRT_2;
        let classes = json!([{ "low": 0.0, "high": middle, "count": 1 }, { "low": middle, "high": 1.0, "count": 2 }, { "low": 1.0, "high": null, "count": 1 }]);
        let html = histogram(&json!({ "classes": classes, "min": 0.5, "mean": 1.0, "max": 2.0 }), "lengths", true);
        assert!(html.contains("0.7071 to 1: 2 (50.00 %)") && html.contains("above 1: 1 (25.00 %)"), "{html}");
        assert_eq!((html.matches("class=\"unit\"").count(), html.matches("class=\"bar\"").count()), (1, 2));
        assert_eq!(histogram(&json!(null), "none", false), "");
    }
}
