//! Configurations of somebody else, on a machine whose operator says which solvers there are: a service's. They lead out of no folder.
use super::{Config, Loaded};
use crate::cycle::solver::{Choice, command};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The solvers of an operator, a TOML file: a table for each, by its name.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(transparent)]
pub struct Solvers {
    named: BTreeMap<String, Solver>,
}

/// A solver of an operator.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Solver {
    /// As `[solver.command]` has it.
    command: command::Config,
    /// Folders and files besides the system's programs that it reads.
    #[serde(default)]
    reads: Vec<PathBuf>,
}

impl Solvers {
    /// Reads the file of an operator.
    ///
    /// # Errors
    /// When it cannot be read, or says what cannot be: the message names the file, the place and the remedy.
    pub fn read(path: &Path) -> Result<Self, String> {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let text = std::fs::read_to_string(path).map_err(|error| named(&error))?;
        let solvers: Self = toml::from_str(&text).map_err(|error| named(&error.to_string().trim_end()))?;
        for (name, Solver { command, reads }) in &solvers.named {
            let check = crate::cycle::solver::Solver::check(command, Path::new(""));
            check.map_err(|error| named(&format!("[{name}.command]: {error}")))?;
            if let Some(relative) = reads.iter().find(|path| !path.is_absolute()) {
                let text = format!("[{name}] reads: {}: give a path from / on", relative.display());
                return Err(named(&text));
            }
        }
        Ok(solvers)
    }

    /// Their names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.named.keys().map(String::as_str)
    }

    /// What they read besides the system's programs.
    pub fn reads(&self) -> impl Iterator<Item = &Path> {
        self.named.values().flat_map(|solver| solver.reads.iter().map(PathBuf::as_path))
    }

    /// The solver that a configuration names, in its place.
    fn resolve(&self, choice: &mut Choice) -> Result<(), String> {
        let known = || {
            let names: Vec<&str> = self.names().collect();
            if names.is_empty() { "none is set up".into() } else { format!("there are {}", names.join(", ")) }
        };
        match choice {
            Choice::Analytic(_) => Ok(()),
            Choice::Named(wanted) => {
                let found = self.named.get(&wanted.name);
                let found =
                    found.ok_or_else(|| format!("[solver.named] name: there is no {:?}; {}", wanted.name, known()))?;
                *choice = Choice::Command(found.command.clone());
                Ok(())
            }
            Choice::Command(_) | Choice::Su2(_) | Choice::Openfoam(_) => Err(format!(
                "[solver]: only [solver.analytic] and solvers of the operator may be used here, as [solver.named] with their name: {}",
                known()
            )),
        }
    }
}

impl Loaded {
    /// Reads and checks a configuration of somebody else, which may use the analytic solver and these, and whose words name no folder.
    ///
    /// # Errors
    /// As [`Loaded::read`]; and when it asks for what it may not.
    pub fn read_confined(path: &Path, solvers: &Solvers) -> Result<Self, String> {
        Self::read_as(path, |config| {
            check_words(config)?;
            if config.adapt.processes() > 1 {
                return Err("[adapt] processes: one may be used here; leave it out".into());
            }
            solvers.resolve(&mut config.solver)
        })
    }
}

/// Refuses words that could lead out of the folder of the configuration, or to another machine.
fn check_words(config: &Config) -> Result<(), String> {
    fn check(place: &str, value: &Value) -> Result<(), String> {
        match value {
            Value::String(text) if text.contains(['/', '\\', '\0']) || text.contains("..") => {
                Err(format!("{place}: {text:?}: no folders here; give the plain name of a file beside this one"))
            }
            Value::String(text) if text.starts_with("--server") => {
                Err(format!("{place}: {text:?}: may not be used here; leave it out"))
            }
            Value::Array(values) => values.iter().try_for_each(|value| check(place, value)),
            Value::Object(values) => values.iter().try_for_each(|(name, value)| {
                let place = if place.is_empty() { name.clone() } else { format!("{place}.{name}") };
                check(&place, &Value::String(name.clone()))?;
                check(&place, value)
            }),
            _ => Ok(()),
        }
    }
    check("", &serde_json::to_value(config).map_err(|error| error.to_string())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAST: &str = "[mesh]\nfile = 'a.meshb'\n[solver.analytic]\nfunction = 'sinfun3'\n[metric]\n[schedule]\ncomplexity = 100\ncycles = 2\n";

    fn read(text: &str, solvers: &str) -> Result<Loaded, String> {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a.meshb"), "").unwrap();
        std::fs::write(at("loop.toml"), text).unwrap();
        std::fs::write(at("solvers.toml"), solvers).unwrap();
        Loaded::read_confined(&at("loop.toml"), &Solvers::read(&at("solvers.toml"))?)
    }

    #[test]
    fn only_the_operators_solvers_are_used() {
        let own = "[heat]\nreads = ['/opt/heat']\ncommand.run = 'heat {mesh} {solution_out}'\n";
        assert!(matches!(read(LEAST, "").unwrap().config.solver, Choice::Analytic(_)));
        let named = LEAST.replace("[solver.analytic]\nfunction = 'sinfun3'", "[solver.named]\nname = 'heat'");
        let Choice::Command(found) = read(&named, own).unwrap().config.solver else { panic!("not resolved") };
        assert_eq!(found.run, "heat {mesh} {solution_out}");
        assert!(read(&named, "").unwrap_err().contains("there is no \"heat\"; none is set up"));
        assert!(read(&named.replace("heat", "fire"), own).unwrap_err().contains("there are heat"));
        let command = named.replace("named]\nname = 'heat'", "command]\nrun = 'cat x'");
        assert!(read(&command, own).unwrap_err().contains("[solver]: only [solver.analytic]"));
    }

    #[test]
    fn no_word_leads_out() {
        let out = |line: &str, with: &str| read(&LEAST.replace(line, with), "").unwrap_err();
        assert!(out("'a.meshb'", "'/etc/passwd'").contains("mesh.file: \"/etc/passwd\": no folders here"));
        assert!(out("[metric]", "[adapt]\noptions = ['--report', '../x']\n[metric]").contains("adapt.options"));
        assert!(out("[metric]", "[adapt]\noptions = ['--server=a:1']\n[metric]").contains("may not be used"));
        assert!(out("[metric]", "[adapt]\nprocesses = 2\n[metric]").contains("[adapt] processes"));
        assert!(out("[metric]", "[probes.'a/b']\nfield='u'\nat=[0,0,0]\n[metric]").contains("no folders here"));
    }

    #[test]
    fn the_operators_file_is_checked() {
        let bad = |text: &str| read(LEAST, text).unwrap_err();
        assert!(
            bad("[heat]\ncommand.run = 'heat {msh}'\n")
                .contains("[heat.command]: [solver.command] run: {msh} is not known")
        );
        assert!(
            bad("[heat]\nreads = ['opt']\ncommand.run = 'heat'\n").contains("[heat] reads: opt: give a path from / on")
        );
        assert!(bad("[heat]\nrun = 'heat'\n").contains("unknown field `run`"));
    }
}
