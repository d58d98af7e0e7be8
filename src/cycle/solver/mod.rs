//! Who solves: one small trait, and those that are known.
pub mod analytic;
pub mod command;
mod handover;
pub mod openfoam;
pub mod su2;

use crate::formats::{Dataset, NamedField};
use crate::geometry::names;
use crate::mesh::TetMesh;
use crate::mesh::io::{FieldKind, read_mesh, read_solution};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The solver of a configuration: `[solver.analytic]`, `[solver.command]` and so on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Choice {
    /// An analytic function, to try the loop with nothing to install.
    Analytic(analytic::Config),
    /// Any program.
    Command(command::Config),
    /// SU2.
    Su2(su2::Config),
    /// OpenFOAM's rhoCentralFoam or rhoSimpleFoam.
    Openfoam(openfoam::Config),
}

impl Choice {
    /// The solver.
    pub fn solver(&self) -> &dyn Solver {
        match self {
            Self::Analytic(solver) => solver,
            Self::Command(solver) => solver,
            Self::Su2(solver) => solver,
            Self::Openfoam(solver) => solver,
        }
    }
}

/// A solver, as the loop sees it. Errors are messages that name file, place and remedy.
pub trait Solver {
    /// Refuses before the loop what would fail in it: a program or file that is not there. `base` is the folder of the configuration.
    ///
    /// # Errors
    /// What is missing, and how to get it.
    fn check(&self, base: &Path) -> Result<(), String>;

    /// Writes what the programs need into the folder of the job; which programs to start, in their order.
    ///
    /// # Errors
    /// When something cannot be written, or an input cannot be used.
    fn prepare(&self, job: &Job<'_>) -> Result<Vec<Call>, String>;

    /// Reads what they wrote.
    ///
    /// # Errors
    /// When that is not there or not what it should be.
    fn collect(&self, job: &Job<'_>) -> Result<Solved, String>;
}

/// One solve. All paths are absolute.
pub struct Job<'a> {
    /// The folder of the step; everything of the solver goes in here.
    pub folder: &'a Path,
    /// The folder of the configuration.
    pub base: &'a Path,
    /// The cycle, from 1.
    pub cycle: u32,
    /// The mesh, .meshb; the names of its references may lie beside it (.names.json).
    pub mesh: &'a Path,
    /// The last solution on this mesh; none in the first cycle.
    pub before: Option<Before<'a>>,
    /// Threads to use.
    pub threads: usize,
    /// The options of our own subcommands that say the threads, if the configuration does.
    pub thread_words: &'a [String],
}

/// The solution of the cycle before, on this mesh.
pub struct Before<'a> {
    /// .solb.
    pub path: &'a Path,
    /// Its fields, in their order.
    pub fields: &'a [FieldName],
}

/// What a field is called and what it holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldName {
    /// The name.
    pub name: String,
    /// Values at a vertex: 1 a scalar, 3 a vector, 6 a symmetric tensor, 9 a tensor.
    pub values: usize,
}

/// A program to start in a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Call {
    /// The program and its arguments.
    pub words: Vec<String>,
    /// Variables of its environment, besides ours.
    pub env: Vec<(String, String)>,
    /// Where it is started.
    pub folder: PathBuf,
}

/// What a solve gave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Fields at the mesh's vertices, in its order.
    pub fields: Vec<NamedField>,
    /// Functionals by name, such as lift and drag.
    pub functionals: BTreeMap<String, f64>,
}

impl Job<'_> {
    /// The mesh alone.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn mesh(&self) -> Result<TetMesh, String> {
        read_mesh(self.mesh).map(|read| read.content).map_err(|error| error.to_string())
    }

    /// The mesh, the names of its references, and the fields of the solution before.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let mesh = self.mesh()?;
        let names = names::read(self.mesh).map_err(|error| error.to_string())?;
        let mut fields = Vec::new();
        if let Some(Before { path, fields: named }) = &self.before {
            let read = read_solution(path).map_err(|error| error.to_string())?.content;
            fields = read
                .fields
                .into_iter()
                .zip(named.iter())
                .map(|(field, named)| NamedField { name: named.name.clone(), kind: field.kind, values: field.values })
                .collect();
        }
        Ok(Dataset { mesh, names, fields })
    }
}

impl FieldName {
    /// Of a field.
    pub fn of(field: &NamedField) -> Self {
        Self { name: field.name.clone(), values: field.kind.values() }
    }
}

impl Call {
    /// As a line for a shell, which does the same in any folder.
    pub fn line(&self) -> String {
        let env = self.env.iter().map(|(name, value)| format!("{name}={}", quoted(value)));
        let words = self.words.iter().map(|word| quoted(word));
        let all: Vec<String> = env.chain(words).collect();
        format!("cd {} && {}", quoted(&self.folder.to_string_lossy()), all.join(" "))
    }
}

/// A word for a shell.
pub fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// The path of a program: a path with a folder in it, from `base`, else what the PATH has.
pub fn find_program(name: &str, base: &Path) -> Option<PathBuf> {
    let found = |path: PathBuf| path.is_file().then_some(path);
    if name.contains('/') {
        return found(base.join(name));
    }
    std::env::split_paths(&std::env::var_os("PATH")?).find_map(|folder| found(folder.join(name)))
}

impl Solved {
    /// Refuses fields that are none of a mesh of so many vertices.
    ///
    /// # Errors
    /// Which field, and what is wrong with it.
    pub fn check(&self, vertices: usize) -> Result<(), String> {
        if self.fields.is_empty() {
            return Err("the solver gave no field: a metric needs one at least".into());
        }
        for NamedField { name, kind, values } in &self.fields {
            if values.len() != vertices * kind.values() {
                let (found, wanted) = (values.len(), vertices * kind.values());
                return Err(format!("the field {name} has {found} values, but {vertices} vertices ask for {wanted}"));
            }
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                let (vertex, value) = (at / kind.values() + 1, values[at]);
                return Err(format!(
                    "the field {name} is {value} at vertex {vertex}: did the solver diverge? Its log tells"
                ));
            }
        }
        Ok(())
    }
}

/// The values of one vertex that a field of so many holds.
pub fn kind_of(values: usize) -> Option<FieldKind> {
    use FieldKind::{Scalar, SymmetricTensor, Tensor, Vector};
    [Scalar, Vector, SymmetricTensor, Tensor].into_iter().find(|kind| kind.values() == values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_as_a_line() {
        let call = Call {
            words: vec!["solve".into(), "a b".into(), "it's".into(), "x=1".into()],
            env: vec![("N".into(), "2 3".into())],
            folder: "/tmp/here".into(),
        };
        assert_eq!(call.line(), r"cd /tmp/here && N='2 3' solve 'a b' 'it'\''s' x=1");
    }

    #[test]
    fn fields_that_are_none_are_refused() {
        let field = |values: Vec<f64>| NamedField { name: "p".into(), kind: FieldKind::Scalar, values };
        let solved = |values| Solved { fields: vec![field(values)], ..Solved::default() };
        assert!(solved(vec![1.0, 2.0]).check(2).is_ok());
        assert!(solved(vec![1.0]).check(2).unwrap_err().contains("p has 1 values"));
        assert!(solved(vec![1.0, f64::NAN]).check(2).unwrap_err().contains("vertex 2"));
        assert!(Solved::default().check(2).is_err());
    }
}
