//! `[goal]`: the functional that the mesh is made for.
use crate::cycle::data::GoalFlow;
use crate::metric::goal::Boundary;
use crate::metric::goal::terms::{Term, Values};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// `[goal]`. The solver gives its adjoint as a field beside its own, and the value of the functional and its estimate among its functionals. Without terms
/// and `flow` the flow is the solver's, where it knows its adjoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Goal {
    /// The functional, as the solver calls it.
    pub functional: String,
    /// The solver's estimate of its error, the true value minus its own, as the solver calls it.
    pub estimate: Option<String>,
    /// The true value, where it is known: error and effectivity are told then.
    pub reference: Option<f64>,
    /// What vertices on the boundary get.
    pub boundary: Option<Boundary>,
    /// Pairs of a weight and a field.
    #[serde(default)]
    pub terms: Vec<GoalTerm>,
    /// A flow, by the names of the solver's fields.
    pub flow: Option<GoalFlow>,
}

/// A pair of a weight and a field, by the names of the solver's fields; of a vector `U` one component `U:x`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalTerm {
    /// The field.
    pub field: String,
    /// The weight, from 0 on. Or give
    pub weight: Option<String>,
    /// an adjoint, whose derivatives count with these coefficients, as `metric goal --terms` has them.
    pub adjoint: Option<String>,
    /// Coefficients by derivative: { x = 1, yy = 0.01 }.
    #[serde(default)]
    pub derivatives: BTreeMap<String, f64>,
}

impl Goal {
    /// Refuses what cannot be.
    ///
    /// # Errors
    /// The key, and what is wrong with it.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.reference.is_some_and(|value| !value.is_finite()) {
            return Err("[goal] reference: give a finite number".into());
        }
        if let Some(flow) = &self.flow {
            flow.medium().map_err(|error| format!("[goal.flow] {error}"))?;
        }
        for (number, term) in self.terms.iter().enumerate() {
            let values = |name: &String| Values::Only(Path::new(name).into());
            let (weight, adjoint) = (term.weight.as_ref().map(values), term.adjoint.as_ref().map(values));
            let term = Term { field: values(&term.field), weight, adjoint, derivatives: term.derivatives.clone() };
            term.coefficients().map_err(|error| format!("[goal] terms, {}: {error}", number + 1))?;
        }
        Ok(())
    }
}

/// `until`: the estimate of the goal's error is below a bound.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Until {
    /// The goal's functional.
    pub functional: String,
    /// The bound of the absolute value, in the functional's unit.
    pub below: f64,
}

impl FromStr for Until {
    type Err = String;

    /// Of `error(drag) < 1e-4`.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.trim().strip_prefix("error(").and_then(|rest| rest.split_once(')'));
        let below = parts.and_then(|(_, rest)| rest.trim_start().strip_prefix('<')?.trim().parse::<f64>().ok());
        match (parts, below.filter(|below| *below > 0.0 && below.is_finite())) {
            (Some((functional, _)), Some(below)) if !functional.trim().is_empty() => {
                Ok(Self { functional: functional.trim().into(), below })
            }
            _ => Err(format!("'{text}': give \"error(NAME) < NUMBER\", such as \"error(drag) < 1e-4\"")),
        }
    }
}

impl TryFrom<String> for Until {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Until> for String {
    fn from(until: Until) -> Self {
        until.to_string()
    }
}

impl fmt::Display for Until {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error({}) < {}", self.functional, self.below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_as_text() {
        let until: Until = "error(C L) <1e-3".parse().unwrap();
        assert_eq!((until.functional.as_str(), until.below), ("C L", 1e-3));
        assert_eq!(until.to_string().parse::<Until>().unwrap(), until);
        for wrong in ["error(J)", "error() < 1", "J < 1", "error(J) < 0", "error(J) > 1", "error(J) < NaN", ""] {
            assert!(wrong.parse::<Until>().unwrap_err().contains("error(NAME) < NUMBER"), "{wrong}");
        }
    }
}
