//! Finds the programs that the loop starts, and starts one as several processes, by mpirun.
use super::data::text;
use super::error::Error;
use crate::process::{Log, Outcome, Runner, Stop, Tie, errors_or_last_lines};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// What starts several processes.
const MPIRUN: &str = "mpirun";

/// The exit code of mpirun where one of its processes was killed: 128 + SIGKILL.
pub const KILLED: i32 = 137;

/// For OpenMPI, which others do not read: root may start processes, as in containers, and more of them than there are cores, as it was asked to.
pub const ENVIRONMENT: [(&str, &str); 3] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
];

/// The path of a program: a path with a folder in it, from `base`, else what the PATH has.
pub fn find_program(name: &str, base: &Path) -> Option<PathBuf> {
    let found = |path: PathBuf| path.is_file().then_some(path);
    if name.contains('/') {
        return found(base.join(name));
    }
    std::env::split_paths(&std::env::var_os("PATH")?).find_map(|folder| found(folder.join(name)))
}

/// This program's own file.
///
/// # Errors
/// When the system does not tell.
pub fn own() -> Result<String, Error> {
    let program = std::env::current_exe();
    program.map(|path| text(&path)).map_err(|error| Error::Failed(format!("this program's own file: {error}")))
}

/// Refuses so many processes where they could not be started; `table` of the configuration asks for them.
///
/// # Errors
/// What is missing.
pub fn check(table: &str, processes: u32) -> Result<(), String> {
    if processes == 0 {
        return Err(format!("{table} processes: give 1 or more"));
    }
    if processes > 1 && find_program(MPIRUN, Path::new("")).is_none() {
        return Err(format!(
            "{table} processes is above 1, but there is no mpirun on the PATH: install an MPI (on Debian: apt install openmpi-bin), or give \
             processes = 1"
        ));
    }
    Ok(())
}

/// How long processes may take to meet: on many machines the program is read from one disk.
const PATIENCE: Duration = Duration::from_secs(120);

/// Starts so many processes of this program, which meet and end: whether mpirun is of the right MPI, and reaches its machines, is known before a
/// solver has worked for an hour. `log` is removed again where they do.
///
/// # Errors
/// Why they do not meet, by the last lines of the log; [`Error::Interrupted`].
pub fn meet(processes: u32, log: &Path, stop: &Stop) -> Result<(), Error> {
    let mut words = words(processes);
    let [program, ..] = &words[..] else { return Ok(()) };
    let mut command = Command::new(program);
    words.extend([own()?, "ranks".into()]);
    command.args(&words[1..]).envs(ENVIRONMENT);
    let failed = |error: std::io::Error| Error::Failed(format!("{}: {error}", log.display()));
    let said = Log::create(log).map_err(failed)?;
    let runner = Runner { tie: Tie::Bound, limit: Some(PATIENCE), stop: &stop.now, log: Some(&said) };
    let why = match runner.run(&mut command, |_| ()) {
        Ok(Outcome::Done) => return std::fs::remove_file(log).map_err(failed),
        Ok(Outcome::Interrupted) => return Err(Error::Interrupted),
        Ok(outcome) => format!("{outcome}: {}", errors_or_last_lines(log, &[])),
        Err(error) => error.to_string(),
    };
    Err(Error::Failed(format!("[adapt] processes = {processes}: `{}` {why}; see {}", words.join(" "), log.display())))
}

/// The words before those of a program that is started as so many processes; none for one.
pub fn words(processes: u32) -> Vec<String> {
    if processes < 2 { Vec::new() } else { vec![MPIRUN.into(), "-n".into(), processes.to_string()] }
}

/// What mpirun needs in its environment; nothing for one process.
pub fn environment(processes: u32) -> Vec<(String, String)> {
    let pairs = ENVIRONMENT.iter().filter(|_| processes > 1);
    pairs.map(|&(name, value)| (name.to_owned(), value.to_owned())).collect()
}
