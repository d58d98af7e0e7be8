//! SU2: its configuration is written from a few flow conditions, or the user's is amended; restart and history are read. `drive` runs it (a process of
//! its own, `geo-adapt su2 FOLDER`), and again where it diverges.
//!
//! Options by SU2's documentation (su2code.github.io/docs_v7: Configuration File, Custom Output, Restart File), versions 7 and 8.
mod cfg;
mod conditions;
pub mod drive;
mod history;

pub use conditions::{Conditions, Model};

use super::{Job, Solver, handover};
use crate::cycle::data::{Call, Solved, text};
use crate::cycle::launch::{self, find_program};
use crate::formats::Dataset;
use cfg::Cfg;
use drive::{Outcome, PLAN, Plan, RESULT};
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
    /// Options of SU2 in the first solves alone, which win over `set`: a scheme that is steadier on a coarse mesh, from the free stream.
    #[serde(default)]
    pub first: BTreeMap<String, String>,
    /// How many solves these are.
    #[serde(default = "one")]
    pub first_solves: u32,
    /// Iterations of first order before a solve that has diverged is run again, slower.
    #[serde(default = "first_order")]
    pub first_order: u32,
    /// A solve ends when the logarithm (base 10) of the density's residual is below this; of a `config` as that says without.
    pub residual: Option<f64>,
    /// Or when the functionals change by less than this from an iteration to the next, relatively, in the mean of the last hundred.
    pub change: Option<f64>,
    /// Whether solutions are handed over in SU2's binary files, or else as text.
    #[serde(default = "yes")]
    pub binary: bool,
    /// Functionals are the means of the last so many iterations of a solve, for a flow that does not come to rest; 1 is the last one alone.
    #[serde(default = "one")]
    pub mean: u32,
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

fn yes() -> bool {
    true
}

fn first_order() -> u32 {
    200
}

fn coefficients() -> Vec<String> {
    vec!["CL".into(), "CD".into()]
}

/// Functionals that SU2 calls one way in the history and another way in its options.
const CALLED: [(&str, &str); 10] = [
    ("CL", "LIFT"),
    ("CD", "DRAG"),
    ("CSF", "SIDEFORCE"),
    ("CMx", "MOMENT_X"),
    ("CMy", "MOMENT_Y"),
    ("CMz", "MOMENT_Z"),
    ("CFx", "FORCE_X"),
    ("CFy", "FORCE_Y"),
    ("CFz", "FORCE_Z"),
    ("CEff", "EFFICIENCY"),
];

/// Over how many iterations functionals are to stand still.
const STILL: &str = "100";

/// Names of our files in the folder of a step. SU2 adds the endings of its solutions and of the history.
const MESH: &str = "mesh.su2";
const BEFORE: &str = "before";
const RESTART: &str = "restart";
const HISTORY: &str = "history";
const CONFIG: &str = "su2.cfg";

/// What a solve tells besides.
const ITERATIONS: &str = "iterations";

impl Config {
    /// The configuration of the solve of a cycle, from 1.
    fn cfg(&self, base: &Path, cycle: u32, restarts: bool) -> Result<Cfg, String> {
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
            ("READ_BINARY_RESTART", if self.binary { "YES" } else { "NO" }),
            ("RESTART_FILENAME", RESTART),
            ("OUTPUT_FILES", if self.binary { "(RESTART)" } else { "(RESTART_ASCII)" }),
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
        self.until(&mut cfg);
        let first = (cycle <= self.first_solves).then_some(&self.first);
        self.set.iter().chain(first.into_iter().flatten()).for_each(|(key, value)| cfg.set(key, value));
        Ok(cfg)
    }
}

impl Config {
    /// When a solve ends, where that is said.
    fn until(&self, cfg: &mut Cfg) {
        let mut fields = Vec::new();
        if let Some(residual) = self.residual {
            cfg.set("CONV_RESIDUAL_MINVAL", &residual.to_string());
            fields.push("RMS_DENSITY");
        }
        if let Some(change) = self.change {
            cfg.set("CONV_CAUCHY_EPS", &change.to_string());
            cfg.set("CONV_CAUCHY_ELEMS", STILL);
            let called = |name: &str| CALLED.iter().find(|(column, _)| *column == name).map(|(_, called)| *called);
            fields.extend(self.functionals.iter().map(|name| called(name).unwrap_or(name)));
        }
        if !fields.is_empty() {
            cfg.set("CONV_FIELD", &format!("( {} )", fields.join(", ")));
        }
    }

    /// The file of a solution.
    fn solution(&self, folder: &Path, name: &str) -> PathBuf {
        folder.join(name).with_extension(if self.binary { "dat" } else { "csv" })
    }

    /// What is started, before the name of a configuration.
    fn words(&self, base: &Path) -> Vec<String> {
        let program = find_program(&self.program, base).unwrap_or_else(|| self.program.clone().into());
        let mut words = launch::words(self.processes);
        words.push(text(&program));
        words
    }
}

impl Solver for Config {
    fn check(&self, base: &Path) -> Result<(), String> {
        self.cfg(base, 1, false)?;
        self.flow.as_ref().map_or(Ok(()), Conditions::check)?;
        if self.change.is_some_and(|change| !(change.is_finite() && change > 0.0)) {
            return Err("[solver.su2] change: give a positive number, such as 1e-6".into());
        }
        if self.mean == 0 {
            return Err("[solver.su2] mean: give 1 for the last iteration alone, or more".into());
        }
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
        Some(self.functionals.iter().cloned().chain([ITERATIONS.to_owned()]).collect())
    }

    fn result(&self, data: &Dataset, folder: &Path) -> Result<Vec<PathBuf>, String> {
        let (mesh, fields) = (folder.join(MESH), self.solution(folder, RESTART));
        handover::write_mesh(&mesh, data)?;
        handover::write_fields(&fields, data)?;
        Ok(vec![mesh, fields])
    }

    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String> {
        let data = job.dataset()?;
        handover::write_mesh(&job.folder.join(MESH), &data)?;
        if job.before.is_some() {
            handover::write_fields(&self.solution(job.folder, BEFORE), &data)?;
        }
        self.cfg(job.base, job.cycle, job.before.is_some())?.write(&job.folder.join(CONFIG))?;
        let environment = launch::environment(self.processes);
        let plan = Plan { words: self.words(job.base), environment, first_order: self.first_order };
        let path = job.folder.join(PLAN);
        let plan = serde_json::to_string_pretty(&plan).map_err(|error| error.to_string())?;
        std::fs::write(&path, plan).map_err(|error| format!("{}: {error}", path.display()))?;
        let own = launch::own().map_err(|error| error.to_string())?;
        let words = vec![own, "su2".into(), text(job.folder)];
        Ok(vec![Call { words, env: Vec::new(), folder: job.folder.to_path_buf() }])
    }

    fn collect(&self, job: &Job<'_>) -> Result<Solved, String> {
        let fields = handover::read_fields(&self.solution(job.folder, RESTART), job, &[])?;
        let mut functionals =
            history::means(&job.folder.join(HISTORY).with_extension("csv"), &self.functionals, self.mean as usize)?;
        let path = job.folder.join(RESULT);
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let outcome = std::fs::read(&path).map_err(|error| named(&error))?;
        let outcome: Outcome = serde_json::from_slice(&outcome).map_err(|error| named(&error))?;
        functionals.insert(ITERATIONS.into(), outcome.iterations as f64);
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
        let written = config.cfg(folder.path(), 1, false).unwrap().text();
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
        assert!(config.cfg(folder.path(), 2, true).unwrap().text().contains("RESTART_SOL= YES"));
    }

    #[test]
    fn the_first_solves_have_options_of_their_own() {
        let flow = "flow = { mach = 0.5, walls = ['w'], farfield = ['f'] }";
        let config =
            config(&format!("{flow}\nset = {{ CFL_NUMBER = '50' }}\nfirst = {{ CFL_NUMBER = '2' }}\nfirst_solves = 2"));
        let courant = |cycle: u32| config.cfg(Path::new("/"), cycle, cycle > 1).unwrap().get("CFL_NUMBER").unwrap();
        assert_eq!([1, 2, 3].map(courant), ["2", "2", "50"]);
    }

    #[test]
    fn one_of_file_and_flow() {
        let none = config("iterations = 3").check(Path::new("/")).unwrap_err();
        assert!(none.contains("give one of config"), "{none}");
        let program = config("program = 'no-such-su2'\nflow = { mach = 0.5, walls = ['w'], farfield = ['f'] }");
        assert!(program.check(Path::new("/")).unwrap_err().contains("no-such-su2 is not there"));
    }
}
