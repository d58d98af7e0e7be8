//! An analytic function in place of a solver: nothing to install, and the error is known.
use super::{Job, Solver};
use crate::cycle::data::{Call, FieldName, Solved, text};
use crate::formats::NamedField;
use crate::mesh::io::{FieldKind, read_solution};
use crate::metric::Scalar;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// `[solver.analytic]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The function: sinfun3, tanh3 or sinatan3, on the unit cube. The field is called `u`, its functional `error`, the L2 norm of the
    /// interpolation error.
    pub function: Scalar,
}

/// What `geo-adapt field evaluate --report` writes.
#[derive(Deserialize)]
struct Report {
    error: f64,
}

impl Solver for Config {
    fn check(&self, _: &Path) -> Result<(), String> {
        Ok(())
    }

    fn fields(&self) -> Option<Vec<FieldName>> {
        Some(vec![FieldName { name: "u".into(), values: 1 }])
    }

    fn functionals(&self) -> Option<Vec<String>> {
        Some(vec!["error".into()])
    }

    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String> {
        let program = std::env::current_exe().map_err(|error| format!("this program's own file: {error}"))?;
        let function = self.function.name().into();
        let mut words =
            vec![text(&program), "field".into(), "evaluate".into(), text(job.mesh), "--function".into(), function];
        words.extend(["-o".into(), "u.solb".into(), "--report".into(), "u.json".into()]);
        words.extend(job.thread_words.iter().cloned());
        Ok(vec![Call { words, env: Vec::new(), folder: job.folder.to_path_buf() }])
    }

    fn collect(&self, job: &Job<'_>) -> Result<Solved, String> {
        let path = job.folder.join("u.json");
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let bytes = std::fs::read(&path).map_err(|error| named(&error))?;
        let Report { error } = serde_json::from_slice(&bytes).map_err(|error| named(&error))?;
        let solution = read_solution(&job.folder.join("u.solb")).map_err(|error| error.to_string())?.content;
        let values = solution.fields.into_iter().flat_map(|field| field.values).collect();
        let field = NamedField { name: "u".into(), kind: FieldKind::Scalar, values };
        Ok(Solved { fields: vec![field], functionals: BTreeMap::from([("error".into(), error)]) })
    }
}
