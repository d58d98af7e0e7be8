//! SU2: its configuration is written from a few flow conditions, or the user's is amended; restart and history are read.
//!
//! Options by SU2's documentation (su2code.github.io/docs_v7: Configuration File, Custom Output, Restart File), versions 7 and 8.
mod cfg;
mod conditions;
mod history;

pub use conditions::{Conditions, Model};

use super::{Job, Solver, handover};
use crate::cycle::data::{Call, Solved};
use crate::cycle::launch::{self, find_program};
use crate::formats::Dataset;
use cfg::Cfg;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// `[solver.su2]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The program, on the PATH or with its folder.
    #[serde(default = "program")]
    pub program: String,
    /// Processes: above 1 it is started by mpirun.
    #[serde(default = "one")]
    pub processes: u32,
    /// A configuration of SU2 to be amended; its names of files are replaced, all else stays.
    pub config: Option<PathBuf>,
    /// Or the flow, of which a configuration is made.
    pub flow: Option<Conditions>,
    /// Iterations at most of a solve; of a `config` its own ITER without.
    pub iterations: Option<u32>,
    /// Further options of SU2, which win over all others: { CFL_NUMBER = "5" }.
    #[serde(default)]
    pub set: BTreeMap<String, String>,
    /// Columns of the history that are functionals.
    #[serde(default = "coefficients")]
    pub functionals: Vec<String>,
}

fn program() -> String {
    "SU2_CFD".into()
}

fn one() -> u32 {
    1
}

fn coefficients() -> Vec<String> {
    vec!["CL".into(), "CD".into()]
}

/// Names of our files in the folder of a step. SU2 adds .csv to what it reads and writes.
const MESH: &str = "mesh.su2";
const BEFORE: &str = "before";
const RESTART: &str = "restart";
const HISTORY: &str = "history";
const CONFIG: &str = "su2.cfg";

impl Config {
    /// The configuration of a solve.
    fn cfg(&self, base: &Path, restarts: bool) -> Result<Cfg, String> {
        let mut cfg = match (&self.config, &self.flow) {
            (Some(path), None) => Cfg::read(&base.join(path))?,
            (None, Some(flow)) => flow.cfg(),
            _ => return Err("[solver.su2]: give one of config (a file of SU2) and flow (Mach number and so on)".into()),
        };
        for (key, value) in [
            ("MESH_FILENAME", MESH),
            ("MESH_FORMAT", "SU2"),
            ("RESTART_SOL", if restarts { "YES" } else { "NO" }),
            ("SOLUTION_FILENAME", BEFORE),
            ("READ_BINARY_RESTART", "NO"),
            ("RESTART_FILENAME", RESTART),
            ("OUTPUT_FILES", "(RESTART_ASCII)"),
            ("TABULAR_FORMAT", "CSV"),
            ("CONV_FILENAME", HISTORY),
        ] {
            cfg.set(key, value);
        }
        // What is made from the conservative variables, and the coefficients.
        cfg.set_missing("VOLUME_OUTPUT", "(COORDINATES, SOLUTION, PRIMITIVE)");
        cfg.set_missing("HISTORY_OUTPUT", "(ITER, RMS_RES, AERO_COEFF)");
        if let Some(iterations) = self.iterations {
            cfg.set("ITER", &iterations.to_string());
        }
        self.set.iter().for_each(|(key, value)| cfg.set(key, value));
        Ok(cfg)
    }
}

impl Solver for Config {
    fn check(&self, base: &Path) -> Result<(), String> {
        self.cfg(base, false)?;
        let remedy = "install SU2 (https://su2code.github.io) and put its bin folder on the PATH, or give [solver.su2] program with its folder";
        if find_program(&self.program, base).is_none() {
            return Err(format!("[solver.su2] {} is not there: {remedy}", self.program));
        }
        launch::check("[solver.su2]", self.processes)
    }

    fn inputs(&self, base: &Path) -> Vec<PathBuf> {
        self.config.iter().map(|path| base.join(path)).collect()
    }

    fn functionals(&self) -> Option<Vec<String>> {
        Some(self.functionals.clone())
    }

    fn result(&self, data: &Dataset, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let (mesh, fields) = (folder.join(MESH), folder.join(RESTART).with_extension("csv"));
        handover::write_mesh(&mesh, data)?;
        handover::write_fields(&fields, data)?;
        Ok(vec![mesh, fields])
    }

    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String> {
        let data = job.dataset()?;
        handover::write_mesh(&job.folder.join(MESH), &data)?;
        if job.before.is_some() {
            handover::write_fields(&job.folder.join(BEFORE).with_extension("csv"), &data)?;
        }
        self.cfg(job.base, job.before.is_some())?.write(&job.folder.join(CONFIG))?;
        let program = find_program(&self.program, job.base).unwrap_or_else(|| self.program.clone().into());
        let mut words = launch::words(self.processes);
        words.extend([program.to_string_lossy().into_owned(), CONFIG.into()]);
        Ok(vec![Call { words, env: launch::environment(self.processes), folder: job.folder.to_path_buf() }])
    }

    fn collect(&self, job: &Job<'_>) -> Result<Solved, String> {
        let fields = handover::read_fields(&job.folder.join(RESTART).with_extension("csv"), job, &[])?;
        let functionals = history::last(&job.folder.join(HISTORY).with_extension("csv"), &self.functionals)?;
        Ok(Solved { fields, functionals })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(text: &str) -> Config {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_users_configuration_keeps_what_is_not_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let text = "% mine\nMACH_NUMBER= 0.84 % transonic\nMESH_FILENAME= old.su2\nRESTART_SOL=YES\nMARKER_FAR= ( far, \\\n  away )\nVOLUME_OUTPUT= (COORDINATES, SOLUTION)\nITER= 9\n";
        std::fs::write(folder.path().join("mine.cfg"), text).unwrap();
        let config = config("config = 'mine.cfg'\nset = { CFL_NUMBER = '5' }");
        let written = config.cfg(folder.path(), false).unwrap().text();
        for line in [
            "MESH_FILENAME= mesh.su2",
            "RESTART_SOL= NO",
            "MACH_NUMBER= 0.84 % transonic",
            "CFL_NUMBER= 5",
            "ITER= 9",
            "VOLUME_OUTPUT= (COORDINATES, SOLUTION)",
        ] {
            assert_eq!(written.lines().filter(|found| *found == line).count(), 1, "{line}\n{written}");
        }
        assert!(written.contains("MARKER_FAR= ( far, \\\n  away )") && !written.contains("old.su2"), "{written}");
        assert!(config.cfg(folder.path(), true).unwrap().text().contains("RESTART_SOL= YES"));
    }

    #[test]
    fn one_of_file_and_flow() {
        let none = config("iterations = 3").check(Path::new("/")).unwrap_err();
        assert!(none.contains("give one of config"), "{none}");
        let program = config("program = 'no-such-su2'\nflow = { mach = 0.5, walls = ['w'], farfield = ['f'] }");
        assert!(program.check(Path::new("/")).unwrap_err().contains("no-such-su2 is not there"));
    }
}
