//! Any program: a command for the shell that is told where the mesh is and where its solution shall go.
use super::{Job, Solver, handover};
use crate::cycle::data::{Call, Solved, quoted, text};
use crate::formats::{self, Dataset, Format};
use crate::mesh::stack::Stack;
use regex_lite::Regex;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// `[solver.command]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The command, for sh, started in the folder of the step. In it stand {mesh}, {solution_in} (the last solution on this mesh; `none` in
    /// the first cycle), {solution_out}, {fields}, {folder} (of the step), {config} (the folder of this configuration), {cycle}, {threads}.
    pub run: String,
    /// The name of the mesh's file; its ending is its format.
    #[serde(default = "mesh")]
    pub mesh: PathBuf,
    /// The name of the file of the last solution; its ending is its format.
    #[serde(default = "solution_in")]
    pub solution_in: PathBuf,
    /// The name of the file that the program writes; its ending is its format.
    #[serde(default = "solution_out")]
    pub solution_out: PathBuf,
    /// What its fields are called, where the format has no names.
    #[serde(default)]
    pub fields: Vec<String>,
    /// A command for the adjoint, started after `run`, with {adjoint_out} besides; a program that gives both at once needs none.
    pub adjoint: Option<String>,
    /// The name of the file that it writes, whose fields are added to the solution's; its ending is its format.
    #[serde(default = "adjoint_out")]
    pub adjoint_out: PathBuf,
    /// What its fields are called, where the format has no names.
    #[serde(default)]
    pub adjoint_fields: Vec<String>,
    /// A JSON file that the program writes, an object of numbers: {"drag": 0.02}.
    pub functionals: Option<PathBuf>,
    /// Functionals found in what the program prints: the last match of a regular expression, the number in its first parentheses.
    #[serde(default)]
    pub printed: BTreeMap<String, String>,
}

fn mesh() -> PathBuf {
    "mesh.meshb".into()
}

fn solution_in() -> PathBuf {
    "before.solb".into()
}

fn solution_out() -> PathBuf {
    "solution.solb".into()
}

fn adjoint_out() -> PathBuf {
    "adjoint.solb".into()
}

/// What may stand in braces.
const PLACES: [&str; 9] =
    ["mesh", "solution_in", "solution_out", "fields", "folder", "config", "cycle", "threads", "adjoint_out"];

impl Config {
    /// The commands, each with its key.
    fn commands(&self) -> impl Iterator<Item = (&'static str, &str)> {
        [("run", self.run.as_str())].into_iter().chain(self.adjoint.as_deref().map(|adjoint| ("adjoint", adjoint)))
    }

    /// A command with its places filled.
    fn filled(&self, command: (&str, &str), job: &Job<'_>) -> Result<String, String> {
        let before = job.before.as_ref().map_or_else(|| "none".into(), |_| text(&job.folder.join(&self.solution_in)));
        let values = [
            text(&job.folder.join(&self.mesh)),
            before,
            text(&job.folder.join(&self.solution_out)),
            self.fields.join(","),
            text(job.folder),
            text(job.base),
            job.cycle.to_string(),
            job.threads.to_string(),
            text(&job.folder.join(&self.adjoint_out)),
        ];
        replace(command, |name| PLACES.iter().position(|place| *place == name).map(|at| quoted(&values[at])))
    }

    fn patterns(&self) -> Result<Vec<(&String, Regex)>, String> {
        let parse = |(name, pattern): (_, &String)| {
            let regex = Regex::new(pattern).map_err(|error| format!("[solver.command.printed] {name}: {error}"))?;
            if regex.captures_len() < 2 {
                return Err(format!("[solver.command.printed] {name}: put parentheses about the number: '{pattern}'"));
            }
            Ok((name, regex))
        };
        self.printed.iter().map(parse).collect()
    }
}

/// A command, given with its key, with each {name} replaced; {{ is a brace, and so is }}. What comes in for a name stays as it is.
fn replace((key, command): (&str, &str), value: impl Fn(&str) -> Option<String>) -> Result<String, String> {
    let (mut filled, mut rest) = (String::new(), command);
    let plain = |text: &str| text.replace("}}", "}");
    while let Some(at) = rest.find('{') {
        filled += &plain(&rest[..at]);
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix('{') {
            filled.push('{');
            rest = after;
            continue;
        }
        let Some((name, after)) = rest.split_once('}') else {
            return Err(format!("[solver.command] {key}: a {{ without its }}; write {{{{ for a brace of the shell"));
        };
        filled += &value(name).ok_or_else(|| {
            let known = PLACES.map(|place| format!("{{{place}}}")).join(" ");
            format!(
                "[solver.command] {key}: {{{name}}} is not known; there are {known}, and {{{{ for a brace of the shell"
            )
        })?;
        rest = after;
    }
    Ok(filled + &plain(rest))
}

impl Solver for Config {
    fn check(&self, _: &Path) -> Result<(), String> {
        for command in self.commands() {
            replace(command, |name| PLACES.contains(&name).then(String::new))?;
        }
        self.patterns()?;
        handover::check_mesh_format(&self.mesh).map_err(|error| format!("[solver.command] mesh: {error}"))?;
        handover::check_field_format(&self.solution_in)
            .map_err(|error| format!("[solver.command] solution_in: {error}"))?;
        handover::check_solution_format(&self.solution_out)
            .map_err(|error| format!("[solver.command] solution_out: {error}"))?;
        handover::check_solution_format(&self.adjoint_out)
            .map_err(|error| format!("[solver.command] adjoint_out: {error}"))?;
        Ok(())
    }

    fn check_stack(&self, stack: &Stack) -> Result<(), String> {
        formats::check_stack(&self.mesh, stack).map_err(|error| format!("[solver.command] mesh: {error}"))
    }

    fn functionals(&self) -> Option<Vec<String>> {
        // A file may hold any.
        self.functionals.is_none().then(|| self.printed.keys().cloned().collect())
    }

    fn result(&self, data: &Dataset, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let mut files = Vec::new();
        // What it reads, as it reads it: mesh, and solution before.
        for name in [&self.mesh, &self.solution_in] {
            let path = folder.join(name.file_name().unwrap_or(name.as_os_str()));
            let own = ["meshb", "solb"].map(Some);
            if own.contains(&path.extension().and_then(|ending| ending.to_str())) {
                continue;
            }
            let is_fields = Format::of(&path).is_ok_and(Format::is_fields);
            if is_fields { handover::write_fields(&path, data) } else { handover::write_mesh(&path, data) }?;
            files.push(path);
        }
        Ok(files)
    }

    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String> {
        let data = job.dataset()?;
        handover::write_mesh(&job.folder.join(&self.mesh), &data)?;
        if job.before.is_some() {
            handover::write_fields(&job.folder.join(&self.solution_in), &data)?;
        }
        let call = |command| {
            let words = vec!["sh".into(), "-c".into(), self.filled(command, job)?];
            Ok(Call { words, env: Vec::new(), folder: job.folder.to_path_buf() })
        };
        self.commands().map(call).collect()
    }

    fn collect(&self, job: &Job<'_>) -> Result<Solved, String> {
        let written = |name: &Path, place: &str, names: &[String]| {
            let path = job.folder.join(name);
            if !path.is_file() {
                return Err(format!(
                    "{}: the command ended well but did not write this; let it write to {{{place}}}",
                    path.display()
                ));
            }
            handover::read_fields(&path, job, names)
        };
        let mut fields = written(&self.solution_out, "solution_out", &self.fields)?;
        if self.adjoint.is_some() {
            fields.extend(written(&self.adjoint_out, "adjoint_out", &self.adjoint_fields)?);
        }
        let mut functionals = BTreeMap::new();
        if let Some(file) = &self.functionals {
            let path = job.folder.join(file);
            let named = |error: String| {
                format!("{}: {error}; it shall hold numbers by name, as {{\"drag\": 0.02}}", path.display())
            };
            let bytes = std::fs::read(&path).map_err(|error| named(error.to_string()))?;
            let found: BTreeMap<String, f64> =
                serde_json::from_slice(&bytes).map_err(|error| named(error.to_string()))?;
            functionals.extend(found);
        }
        let printed = self.patterns()?;
        if !printed.is_empty() {
            let log = job.folder.join("log.txt");
            let said = std::fs::read(&log).map_err(|error| format!("{}: {error}", log.display()))?;
            let said = String::from_utf8_lossy(&said);
            for (name, pattern) in printed {
                let last = pattern.captures_iter(&said).last();
                let word = last.as_ref().and_then(|found| found.get(1)).map(|found| found.as_str());
                let value = word.and_then(|word| word.parse().ok()).ok_or_else(|| {
                    format!(
                        "{}: nothing there is {name}, a number as '{pattern}' says; mend [solver.command.printed]",
                        log.display()
                    )
                })?;
                functionals.insert(name.clone(), value);
            }
        }
        Ok(Solved { fields, functionals })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(run: &str) -> Config {
        let quoted = serde_json::to_string(run).unwrap();
        toml::from_str(&format!("run = {quoted}")).unwrap()
    }

    fn job<'a>() -> Job<'a> {
        Job {
            folder: Path::new("/out/a b"),
            base: Path::new("/case"),
            cycle: 3,
            mesh: Path::new("/out/mesh.meshb"),
            before: None,
            threads: 2,
            thread_words: &[],
        }
    }

    fn filled(run: &str, job: &Job<'_>) -> String {
        config(run).filled(("run", run), job).unwrap()
    }

    #[test]
    fn places_are_filled_and_quoted() {
        let filled = filled("python {config}/s.py {mesh} {solution_in} -n {threads} ${{HOME}} {cycle}", &job());
        assert_eq!(filled, "python /case/s.py '/out/a b/mesh.meshb' none -n 2 ${HOME} 3");
    }

    #[test]
    fn braces_in_the_name_of_a_folder_stay() {
        let job = Job { folder: Path::new("/out/{{a}}"), base: Path::new("/ca}}se"), ..job() };
        let filled = filled("cd {folder}; {config}/s ${{HOME}} {cycle}}}", &job);
        assert_eq!(filled, "cd '/out/{{a}}'; '/ca}}se'/s ${HOME} 3}");
    }

    #[test]
    fn what_is_not_known_is_refused() {
        let refused = |run: &str| config(run).check(Path::new("/")).unwrap_err();
        assert!(refused("s {msh}").contains("{msh} is not known; there are {mesh}"));
        assert!(refused("s {mesh").contains("without its }"));
        let mut adjoint = config("s");
        adjoint.adjoint = Some("a {adjoint}".into());
        assert!(adjoint.check(Path::new("/")).unwrap_err().contains("adjoint: {adjoint} is not known"));
        let mut pattern = config("s");
        pattern.printed.insert("drag".into(), "CD = [0-9.]+".into());
        assert!(pattern.check(Path::new("/")).unwrap_err().contains("parentheses"));
        let mut format = config("s");
        format.mesh = "mesh.xyz".into();
        assert!(format.check(Path::new("/")).unwrap_err().contains("mesh.xyz"));
    }
}
