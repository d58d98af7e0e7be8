//! Starts OpenFOAM's programs, the solver alone or in several processes.
use crate::cycle::launch::ENVIRONMENT;
use crate::process::{Log, Outcome, Runner, Tie, last_lines};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Where OpenFOAM's own settings lie: its variable, or where Debian has them.
fn installation() -> Option<PathBuf> {
    let debian = || Some(PathBuf::from("/usr/share/openfoam")).filter(|folder| folder.is_dir());
    std::env::var_os("WM_PROJECT_DIR").map(PathBuf::from).or_else(debian)
}

/// So many lines of a fatal error are shown.
const FATAL_LINES: usize = 4;

/// A program that solves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// Its name on the PATH, or its file.
    pub path: String,
    /// Processes of it; above 1 by mpirun.
    pub processes: u32,
}

/// Why a solve came to no good end.
pub enum Failure {
    /// It failed: other steps may do.
    BlewUp(String),
    /// It was ended, or could not be begun: nothing else will do.
    Stopped(String),
}

/// Runs the solver as `system/` of the case says; what the programs say goes to `log`.
///
/// # Errors
/// With the last lines of the log, where one of them fails.
pub fn solve(case: &Path, program: &Program, log: &Path, stop: &AtomicBool) -> Result<(), Failure> {
    let Program { path: solver, processes } = program;
    let named = |path: &Path, error: std::io::Error| Failure::Stopped(format!("{}: {error}", path.display()));
    Log::create(log).map_err(|error| named(log, error))?;
    let run = |words: &[&str]| run(case, log, stop, words);
    if *processes < 2 {
        return run(&[solver]);
    }
    let count = processes.to_string();
    let dictionary = format!(
        "FoamFile {{ version 2.0; format ascii; class dictionary; object decomposeParDict; }}\n\
         numberOfSubdomains {count};\nmethod simple;\ncoeffs {{ n ({count} 1 1); delta 0.001; }}\n"
    );
    let path = case.join("system/decomposeParDict");
    std::fs::write(&path, dictionary).map_err(|error| named(&path, error))?;
    // The other programs lie beside the solver.
    let beside = |name: &str| Path::new(solver).with_file_name(name).to_string_lossy().into_owned();
    run(&[&beside("decomposePar"), "-force", "-latestTime"])?;
    let solved = run(&["mpirun", "-np", &count, solver, "-parallel"]);
    // Of a solve that failed too, where it can be: it shows where.
    let joined = solved.and(run(&[&beside("reconstructPar"), "-latestTime"]));
    for process in 0..*processes {
        let _ = std::fs::remove_dir_all(case.join(format!("processor{process}"))); // made anew each time
    }
    joined
}

/// What OpenFOAM says of a fatal error, above the trace of its calls; else the end of the log.
fn why(log: &Path) -> String {
    let text = std::fs::read(log).map(|text| String::from_utf8_lossy(&text).into_owned()).unwrap_or_default();
    let lines = |at: usize| text[at..].lines().map(str::trim).filter(|line| !line.is_empty()).take(FATAL_LINES);
    text.find("FOAM FATAL").map_or_else(|| last_lines(log), |at| lines(at).collect::<Vec<_>>().join(" | "))
}

fn run(case: &Path, log: &Path, stop: &AtomicBool, words: &[&str]) -> Result<(), Failure> {
    let said = Log::open(log).map_err(|error| Failure::Stopped(format!("{}: {error}", log.display())))?;
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).current_dir(case);
    // Ends where a number is none, instead of going on with it.
    command.env("FOAM_SIGFPE", "true").envs(ENVIRONMENT);
    if let Some(folder) = installation() {
        command.env("WM_PROJECT_DIR", folder);
    }
    // In the group that the loop gave us, which ends as one.
    let outcome = Runner { tie: Tie::Shared, limit: None, stop, log: Some(&said) }.run(&mut command, |_| ());
    let outcome = outcome
        .map_err(|error| Failure::Stopped(format!("{} could not be started ({error}): is it installed?", words[0])))?;
    let told = || format!("{} {outcome}; the end of {}:\n{}", words.join(" "), log.display(), why(log));
    match outcome {
        Outcome::Done => Ok(()),
        Outcome::Code(_) | Outcome::Crashed(_) => Err(Failure::BlewUp(told())),
        _ => Err(Failure::Stopped(told())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fatal_error_is_told_without_its_trace() {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        std::fs::write(
            &log,
            "Time = 1\n\n--> FOAM FATAL ERROR: \n\n    [U[0 1 -2]] == [p]\n    From b\n    in c\n#0 d\n#1 e\n",
        )
        .unwrap();
        assert_eq!(why(&log), "FOAM FATAL ERROR: | [U[0 1 -2]] == [p] | From b | in c");
        std::fs::write(&log, "Time = 1\nsigFpe\n").unwrap();
        assert!(why(&log).contains("sigFpe"));
    }
}
