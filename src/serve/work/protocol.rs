//! What the service and a warm process say to each other: one JSON object a line. The process reads requests from its standard input and answers on its
//! standard output; when its input ends it ends, with all that it has started.
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A command to be run in a process of its own.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// A number for it.
    pub number: u64,
    /// The words behind the name of the program.
    pub words: Vec<String>,
    /// The folder of the run: it works in `files` there, and leaves `log` and `events` beside.
    pub folder: PathBuf,
    /// The model that it reads, which the process has in memory: how it is called in the folder.
    pub model: Option<String>,
    /// Bytes of address space that it may have.
    pub memory: u64,
    /// Seconds of processor time.
    pub seconds: u64,
    /// Bytes of a file.
    pub file: u64,
    /// What it reads besides its folder and the system's programs.
    pub reads: Vec<PathBuf>,
}

/// The names of what is in the folder of a run.
pub const FILES: &str = "files";
/// What the command prints to standard error.
pub const LOG: &str = "log";
/// What it prints to standard output.
pub const PRINTED: &str = "printed";
/// Its progress, one JSON object a line.
pub const EVENTS: &str = "events";
/// The solvers that a loop may use.
pub const SOLVERS: &str = "solvers.toml";
/// Where it may put files of its own.
pub const TEMPORARY: &str = "tmp";

/// What a warm process answers.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Answer {
    /// Its model is in memory, or it needs none.
    Ready {
        /// Bytes that it takes.
        bytes: u64,
    },
    /// The model could not be read.
    Unfit(String),
    /// A run has begun, as the first process of a group.
    Started {
        /// Which.
        number: u64,
        /// The process.
        process: i32,
    },
    /// A run has ended.
    Ended {
        /// Which.
        number: u64,
        /// Its exit code,
        code: Option<i32>,
        /// or the signal that ended it.
        signal: Option<i32>,
        /// Seconds of processor time that it took.
        seconds: f64,
        /// Most bytes of memory that it had.
        bytes: u64,
    },
    /// A run could not be started.
    Refused {
        /// Which.
        number: u64,
        /// What the system says.
        why: String,
    },
}
