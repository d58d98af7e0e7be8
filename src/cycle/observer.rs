//! The observer of a loop, and the options of a run.
use super::history::Cycle;
use std::path::Path;

/// Who is told what happens.
pub trait Observer {
    /// A step begins; its log is written as it goes.
    fn begin(&self, step: &str, log: &Path);
    /// A step is done, after so many seconds.
    fn end(&self, step: &str, seconds: f64);
    /// Something that the user should know.
    fn note(&self, text: &str);
    /// A solve is done, by this run or one before.
    fn cycle(&self, cycle: &Cycle);
}

/// How a run goes.
#[derive(Clone, Debug)]
pub struct Options {
    /// Threads that solvers are told.
    pub threads: usize,
    /// Whether to throw away what is there.
    pub restart: bool,
}
