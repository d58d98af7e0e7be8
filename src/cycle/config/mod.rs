//! The configuration of a loop, a TOML file: what it begins with, which solver, which metric, when it ends.
//!
//! All relative paths in it begin at the folder of the file.
mod check;
mod confined;
mod goal;
mod parts;
mod words;

pub use confined::Solvers;
pub use goal::{Goal, Until};
pub use parts::{
    Adapt, Converged, FIRST, Growth, Mesh, Metric, NormWord, Output, Probe, Schedule, Transfer, TransferMethod,
};
pub use words::option;

use super::solver::Choice;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What a configuration file says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Threads of our own steps, and what solvers are told; all cores without.
    pub threads: Option<u16>,
    /// The first mesh.
    pub mesh: Mesh,
    /// Who solves: exactly one of its tables.
    pub solver: Choice,
    /// Values of the solution at points, as further functionals, by their names.
    #[serde(default)]
    pub probes: BTreeMap<String, Probe>,
    /// The functional that the mesh is made for.
    pub goal: Option<Goal>,
    /// What sizes are made from.
    pub metric: Metric,
    /// How fine, and until when.
    pub schedule: Schedule,
    /// Further options of the adaptation.
    #[serde(default)]
    pub adapt: Adapt,
    /// How a solution comes to the next mesh.
    #[serde(default)]
    pub transfer: Transfer,
    /// Where everything goes.
    #[serde(default)]
    pub output: Output,
}

/// A configuration with the file that it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The file, absolute.
    pub path: PathBuf,
    /// Its folder, where relative paths begin.
    pub base: PathBuf,
    /// What it says.
    pub config: Config,
}

impl Loaded {
    /// Reads and checks a configuration.
    ///
    /// # Errors
    /// When the file cannot be read or says what cannot be: the message names file, line or key, and remedy.
    pub fn read(path: &Path) -> Result<Self, String> {
        Self::read_as(path, |_| Ok(()))
    }

    /// The same, with what `take` makes of it.
    fn read_as(path: &Path, take: impl FnOnce(&mut Config) -> Result<(), String>) -> Result<Self, String> {
        let named = |error: std::io::Error| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(path).map_err(named)?;
        let mut config = parse(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        take(&mut config).map_err(|error| format!("{}: {error}", path.display()))?;
        let path = path.canonicalize().map_err(named)?;
        let base = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
        let loaded = Self { path, base, config };
        loaded.check().map_err(|error| format!("{}: {error}", loaded.path.display()))?;
        Ok(loaded)
    }

    /// A path of the file, absolute, without `..` where it is there.
    pub fn at(&self, path: &Path) -> PathBuf {
        let joined = self.base.join(path);
        let whole = |path: &Path| path.canonicalize().ok();
        let beside = || Some(whole(joined.parent()?)?.join(joined.file_name()?));
        whole(&joined).or_else(beside).unwrap_or(joined)
    }

    /// The folder of the loop, absolute.
    pub fn output(&self) -> PathBuf {
        self.config.output.folder.as_deref().map_or_else(|| self.path.with_extension("cycle"), |folder| self.at(folder))
    }
}

/// Parses a configuration; an error begins with the line.
pub fn parse(text: &str) -> Result<Config, String> {
    toml::from_str(text).map_err(|error| {
        let before = error.span().map_or(text, |span| &text[..span.start.min(text.len())]);
        let line = before.matches('\n').count() + 1;
        format!("line {line}: {}; `geo-adapt cycle --example analytic` shows what can be there", error.message().trim())
    })
}

/// A key that two configurations differ in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// With its tables: `metric.fields`.
    pub key: String,
    /// What it was and is.
    pub text: String,
}

/// The keys, as `table.key`, in which two configurations differ so that finished steps would differ too. Only the end of the loop, what
/// is drawn, the threads, and by how many processes and in how much memory parts are adapted may differ.
pub fn differences(old: &Config, new: &Config) -> Vec<Difference> {
    let same_parts = old.adapt.is_by_parts() == new.adapt.is_by_parts();
    let comparable = |config: &Config| {
        let mut config = config.clone();
        config.threads = None;
        (config.adapt.threads, config.adapt.scratch) = (None, None);
        if same_parts {
            (config.adapt.processes, config.adapt.memory) = (None, None);
        }
        config.output = Output::default();
        config.schedule.cycles = None;
        config.schedule.max_complexity = None;
        config.schedule.converged = None;
        config.schedule.until = None;
        serde_json::to_value(config).unwrap_or_default()
    };
    let mut found = Vec::new();
    compare("", &comparable(old), &comparable(new), &mut found);
    found
}

fn compare(place: &str, old: &serde_json::Value, new: &serde_json::Value, found: &mut Vec<Difference>) {
    use serde_json::Value::{Null, Object};
    match (old, new) {
        (Object(a), Object(b)) => {
            let keys: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
            for key in keys {
                let inner = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
                compare(&inner, a.get(key).unwrap_or(&Null), b.get(key).unwrap_or(&Null), found);
            }
        }
        _ if old == new => {}
        _ => found.push(Difference { key: place.into(), text: format!("{place} was {old} and is {new}") }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAST: &str = "[mesh]\nfile = 'a.meshb'\n[solver.analytic]\nfunction = 'sinfun3'\n[metric]\n[schedule]\ncomplexity = 100\ncycles = 2\n";

    #[test]
    fn a_short_configuration_is_whole() {
        let config = parse(LEAST).unwrap();
        assert_eq!(config.mesh.file.as_deref(), Some(Path::new("a.meshb")));
        assert_eq!(config.schedule.factor, 2.0);
        assert!(config.output.pictures);
    }

    #[test]
    fn errors_name_the_line_and_what_there_is() {
        let unknown = parse(&LEAST.replace("cycles", "cycels")).unwrap_err();
        assert!(unknown.starts_with("line 8: unknown field `cycels`, expected one of"), "{unknown}");
        let kind = parse(&LEAST.replace("solver.analytic", "solver.analitic")).unwrap_err();
        assert!(kind.contains("line 3") && kind.contains("`analytic`"), "{kind}");
        let number = parse(&LEAST.replace("100", "'many'")).unwrap_err();
        assert!(number.starts_with("line 7: ") && number.contains("expected"), "{number}");
    }

    #[test]
    fn what_only_ends_the_loop_is_no_difference() {
        let old = parse(LEAST).unwrap();
        assert!(
            differences(&old, &parse(&LEAST.replace("cycles = 2", "cycles = 9\nmax_complexity = 1e6")).unwrap())
                .is_empty()
        );
        let new = parse(&LEAST.replace("sinfun3", "tanh3").replace("= 100", "= 200")).unwrap();
        assert_eq!(
            differences(&old, &new).into_iter().map(|difference| difference.text).collect::<Vec<_>>(),
            ["schedule.complexity was 100.0 and is 200.0", "solver.analytic.function was \"sinfun3\" and is \"tanh3\""]
        );
    }
}
