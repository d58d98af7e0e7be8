//! Starts OpenFOAM's programs, the solver alone or in several processes.
use super::drive::Plan;
use crate::cycle::process::last_lines;
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where OpenFOAM's own settings lie: its variable, or where Debian has them.
fn installation() -> Option<PathBuf> {
    let debian = || Some(PathBuf::from("/usr/share/openfoam")).filter(|folder| folder.is_dir());
    std::env::var_os("WM_PROJECT_DIR").map(PathBuf::from).or_else(debian)
}

/// Runs the solver as `system/` of the case says; what the programs say goes to `log`.
///
/// # Errors
/// With the last lines of the log, where one of them fails.
pub fn solve(case: &Path, plan: &Plan, log: &Path) -> Result<(), String> {
    File::create(log).map_err(|error| format!("{}: {error}", log.display()))?;
    if plan.processes < 2 {
        return run(case, log, &[&plan.program]);
    }
    let count = plan.processes.to_string();
    let dictionary = format!(
        "FoamFile {{ version 2.0; format ascii; class dictionary; object decomposeParDict; }}\n\
         numberOfSubdomains {count};\nmethod simple;\ncoeffs {{ n ({count} 1 1); delta 0.001; }}\n"
    );
    let path = case.join("system/decomposeParDict");
    std::fs::write(&path, dictionary).map_err(|error| format!("{}: {error}", path.display()))?;
    // The other programs lie beside the solver.
    let beside = |name: &str| Path::new(&plan.program).with_file_name(name).to_string_lossy().into_owned();
    run(case, log, &[&beside("decomposePar"), "-force", "-latestTime"])?;
    let solved = run(case, log, &["mpirun", "-np", &count, &plan.program, "-parallel"]);
    // Of a solve that failed too, where it can be: it shows where.
    let joined = solved.and(run(case, log, &[&beside("reconstructPar"), "-latestTime"]));
    for process in 0..plan.processes {
        let _ = std::fs::remove_dir_all(case.join(format!("processor{process}"))); // made anew each time
    }
    joined
}

fn run(case: &Path, log: &Path, words: &[&str]) -> Result<(), String> {
    let named = |error: std::io::Error| format!("{}: {error}", log.display());
    let sink = OpenOptions::new().append(true).open(log).map_err(named)?;
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).current_dir(case).stdin(Stdio::null());
    command.stdout(sink.try_clone().map_err(named)?).stderr(sink);
    // Ends where a number is none, instead of going on with it. The others let OpenMPI work for root, as in containers, and start more
    // processes than there are cores, as it was asked to.
    command.env("FOAM_SIGFPE", "true").env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command.env("OMPI_MCA_rmaps_base_oversubscribe", "1");
    if let Some(folder) = installation() {
        command.env("WM_PROJECT_DIR", folder);
    }
    let status =
        command.status().map_err(|error| format!("{} could not be started ({error}): is it installed?", words[0]))?;
    if status.success() {
        return Ok(());
    }
    Err(format!("{} failed ({status}); the end of {}:\n{}", words.join(" "), log.display(), last_lines(log)))
}
