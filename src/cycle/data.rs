//! The data of the loop: what solvers, steps and history hand to each other.
use crate::formats::NamedField;
use crate::mesh::io::FieldKind;
use crate::metric::goal::terms::Flow;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What a field is called and what it holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldName {
    /// The name.
    pub name: String,
    /// Values at a vertex: 1 a scalar, 3 a vector, 6 a symmetric tensor, 9 a tensor.
    pub values: usize,
}

impl FieldName {
    /// Of a field.
    pub fn of(field: &NamedField) -> Self {
        Self { name: field.name.clone(), values: field.kind.values() }
    }
}

/// The values of one vertex that a field of so many holds.
pub fn kind_of(values: usize) -> Option<FieldKind> {
    use FieldKind::{Scalar, SymmetricTensor, Tensor, Vector};
    [Scalar, Vector, SymmetricTensor, Tensor].into_iter().find(|kind| kind.values() == values)
}

/// A flow whose state and adjoint are fields of the solver, by their names, as `[flow]` of `metric goal --terms` has them.
pub type GoalFlow = Flow<Vec<String>>;

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

/// A path as a word of a command.
pub fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// What a solve gave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solved {
    /// Fields at the mesh's vertices, in its order.
    pub fields: Vec<NamedField>,
    /// Functionals by name, such as lift and drag.
    pub functionals: BTreeMap<String, f64>,
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

/// The first step's result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Begun {
    /// The model that boundaries lie on, if any.
    pub cad: Option<PathBuf>,
    /// The surface that they lie on instead.
    #[serde(default)]
    pub surface: Option<PathBuf>,
}

/// A solve's result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SolveResult {
    /// Vertices of its mesh.
    pub vertices: usize,
    /// Tetrahedra.
    pub tets: usize,
    /// The fields of solution.solb, in their order.
    pub fields: Vec<FieldName>,
    /// Functionals by name.
    pub functionals: BTreeMap<String, f64>,
}

/// An adaptation's result.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Adapted {
    /// The complexity that was asked for.
    pub complexity: f64,
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
