//! A solver that an operator has set up, by its name ([`crate::cycle::Solvers`]). Where a loop may use it, its command stands in its place before
//! the loop begins.
use super::{Job, Solver};
use crate::cycle::data::{Call, Solved};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// `[solver.named]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// What the operator calls it.
    pub name: String,
}

impl Config {
    fn missing<T>(&self) -> Result<T, String> {
        Err(format!(
            "[solver.named] {:?} is a solver of a service: send the loop there (--server URL), or give the file of its operator (--confined FILE)",
            self.name
        ))
    }
}

impl Solver for Config {
    fn check(&self, _: &Path) -> Result<(), String> {
        self.missing()
    }

    fn prepare(&self, _: &Job<'_>) -> Result<Vec<Call>, String> {
        self.missing()
    }

    fn collect(&self, _: &Job<'_>) -> Result<Solved, String> {
        self.missing()
    }
}
