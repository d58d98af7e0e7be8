//! A changed configuration: what of it the steps that are done depend on, and what has not run yet and may change.
use super::config::{Config, Difference, differences};
use super::layout::Layout;

/// What has changed since the loop was begun.
#[derive(Debug, Default, PartialEq)]
pub struct Changes {
    /// Finished steps would come out differently, or were made without it.
    pub refused: Vec<String>,
    /// Nothing that depends on it is done.
    pub taken: Vec<String>,
}

impl Changes {
    /// Of the loop in a folder.
    pub fn of(layout: &Layout, old: &Config, new: &Config) -> Self {
        let mut changes = Self::default();
        for Difference { key, text } in differences(old, new) {
            let list = if touches(layout, &key, old, new) { &mut changes.refused } else { &mut changes.taken };
            list.push(text);
        }
        changes
    }
}

/// Whether a finished step depends on a key.
fn touches(layout: &Layout, key: &str, old: &Config, new: &Config) -> bool {
    let is_done = |step: &str| !layout.finished(step).is_empty();
    match key.split('.').next().unwrap_or_default() {
        "solver" | "probes" => is_done("solve"),
        "goal" if key.starts_with("goal.terms") || key == "goal.boundary" => is_done("metric"),
        // Its errors are among the functionals of each solve.
        "goal" => is_done("solve"),
        "metric" if key == "metric.fields" => is_done("metric"),
        "metric" | "adapt" => is_done("adapt"),
        "schedule" => {
            // What only ends the loop may change at any time.
            let mut old = old.schedule.clone();
            old.max_complexity = new.schedule.max_complexity;
            layout.finished("adapt").into_iter().any(|cycle| old.of_cycle(cycle) != new.schedule.of_cycle(cycle))
        }
        // Without it the second solve began anew.
        "transfer" => is_done("transfer") || layout.finished("solve").into_iter().any(|cycle| cycle > 1),
        _ => layout.is_done(&layout.start()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::config::parse;
    use super::*;

    const BEGUN: &str = "[mesh]\ncube = 3\n[solver.analytic]\nfunction = 'sinfun3'\n[metric]\nfields = ['u']\nhmax = 1\n[schedule]\ncomplexity = 100\ncycles = 4\n[transfer]\nmethod = 'none'\n";

    #[test]
    fn what_has_not_run_may_change() {
        let root = tempfile::tempdir().unwrap();
        let layout = Layout::new(root.path().into());
        let done = |folder: std::path::PathBuf| {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join("done.json"), "{}").unwrap();
        };
        let old = parse(BEGUN).unwrap();
        let refused = |from: &str, to: &str| {
            let changes = Changes::of(&layout, &old, &parse(&BEGUN.replace(from, to)).unwrap());
            assert_eq!(changes.refused.len() + changes.taken.len(), 1, "{changes:?}");
            changes.taken.is_empty()
        };
        let all = [
            ("cube = 3", "cube = 4"),
            ("sinfun3", "tanh3"),
            ("'u'", "'v'"),
            ("hmax = 1", "hmax = 2"),
            ("complexity = 100", "complexity = 200"),
            ("'none'", "'conservative'"),
        ];
        let all_refused = || all.map(|(from, to)| refused(from, to));
        assert_eq!(all_refused(), [false; 6]);
        done(layout.start());
        assert_eq!(all_refused(), [true, false, false, false, false, false]);
        done(layout.step(1, "solve"));
        // A step that was begun is done again.
        std::fs::create_dir_all(layout.step(1, "metric")).unwrap();
        assert_eq!(all_refused(), [true, true, false, false, false, false]);
        done(layout.step(1, "metric"));
        assert_eq!(all_refused(), [true, true, true, false, false, false]);
        done(layout.step(1, "adapt"));
        assert_eq!(all_refused(), [true, true, true, true, true, false]);
        // The first cycle has the same complexity.
        assert!(!refused("complexity = 100", "complexity = 100\nfactor = 3"));
        done(layout.step(2, "solve"));
        assert_eq!(all_refused(), [true; 6]);
    }
}
