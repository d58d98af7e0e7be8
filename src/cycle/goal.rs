//! The goal of a loop: what the solver tells of its functional, and the terms of the metric.
use super::config::Goal;
use super::data::{FieldName, GoalFlow, Solved};
use super::field_value::Value;
use crate::metric::goal::terms::{Component, Term, Terms, Values};
use std::path::Path;

/// What is added to the name of a functional for its true error,
const ERROR: &str = "error";
/// and for how much of it the estimate is.
const EFFECTIVITY: &str = "effectivity";

impl Goal {
    /// Adds true error and effectivity to what the solver tells, where the true value is known.
    ///
    /// # Errors
    /// When the solver does not tell the functional, or the estimate.
    pub fn add(&self, solved: &mut Solved) -> Result<(), String> {
        let told = |name: &str, key: &str| {
            let known: Vec<&str> = solved.functionals.keys().map(String::as_str).collect();
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            let missing = || format!("[goal] {key}: the solver tells no '{name}'; it tells {known}");
            solved.functionals.get(name).copied().ok_or_else(missing)
        };
        let value = told(&self.functional, "functional")?;
        let estimate = self.estimate.as_deref().map(|name| told(name, "estimate")).transpose()?;
        let Some(reference) = self.reference else { return Ok(()) };
        let error = reference - value;
        let mut add = |what: &str, value: f64| solved.functionals.insert(format!("{} {what}", self.functional), value);
        add(ERROR, error.abs());
        if let Some(estimate) = estimate.filter(|_| error != 0.0) {
            add(EFFECTIVITY, estimate / error);
        }
        Ok(())
    }

    /// The estimate of the error, without its sign, of a solution that has one.
    pub fn estimated(&self, functionals: &std::collections::BTreeMap<String, f64>) -> Option<f64> {
        Some(functionals.get(self.estimate.as_ref()?)?.abs())
    }

    /// The terms, of the fields of a solution.
    ///
    /// # Errors
    /// When there is no such field.
    pub fn terms(&self, solution: &Path, fields: &[FieldName]) -> Result<Terms, String> {
        let terms = self.terms.iter().enumerate().map(|(number, term)| {
            let values = |word: &String| {
                let named = |error: String| format!("[goal] terms, {}: {error}", number + 1);
                match Value::find(word, fields).map_err(named)? {
                    Value::One(component) => Ok(Values::Component(Component { file: solution.into(), component })),
                    Value::Norm(..) => Err(named(format!("'{word}': give one component of it"))),
                }
            };
            Ok(Term {
                field: values(&term.field)?,
                weight: term.weight.as_ref().map(values).transpose()?,
                adjoint: term.adjoint.as_ref().map(values).transpose()?,
                derivatives: term.derivatives.clone(),
            })
        });
        Ok(Terms { boundary: self.boundary, terms: terms.collect::<Result<_, String>>()?, flow: None })
    }

    /// The flow whose fluxes are terms: that of the configuration, or without terms that of the solver, where it gives its adjoint.
    ///
    /// # Errors
    /// When there is nothing of which a metric could be made.
    pub fn flow<'f>(&'f self, of_solver: Option<&'f GoalFlow>) -> Result<Option<&'f GoalFlow>, String> {
        match &self.flow {
            Some(flow) => Ok(Some(flow)),
            None if !self.terms.is_empty() => Ok(None),
            None => of_solver.map(Some).ok_or_else(|| {
                "[goal] has neither terms nor flow: give one pair of a field and its weight at least, or let the solver give its adjoint \
                 (adjoint = \"CD\" in [solver.openfoam])"
                    .into()
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn goal() -> Goal {
        toml::from_str(
            "functional = 'J'\nestimate = 'e'\nreference = 2.0\nterms = [{ field = 'u', adjoint = 'l', derivatives = { x = 1.0 } }]",
        )
        .unwrap()
    }

    #[test]
    fn the_error_and_its_effectivity_are_functionals() {
        let told = |functionals: &[(&str, f64)]| Solved {
            functionals: functionals.iter().map(|&(name, value)| (name.to_owned(), value)).collect(),
            ..Solved::default()
        };
        let mut solved = told(&[("J", 1.5), ("e", 0.4)]);
        goal().add(&mut solved).unwrap();
        let all: Vec<(&str, f64)> = solved.functionals.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        assert_eq!(all, [("J", 1.5), ("J effectivity", 0.8), ("J error", 0.5), ("e", 0.4)]);
        assert_eq!(goal().estimated(&BTreeMap::from([("e".into(), -0.25)])), Some(0.25));
        let refused = goal().add(&mut told(&[("J", 1.5)])).unwrap_err();
        assert!(refused.contains("estimate: the solver tells no 'e'; it tells J"), "{refused}");
    }

    #[test]
    fn terms_are_components_of_the_solution() {
        let field = |name: &str, values| FieldName { name: name.into(), values };
        let fields = [field("U", 3), field("u", 1), field("l", 1)];
        let terms = goal().terms("/s.solb".as_ref(), &fields).unwrap();
        let component = |component| Values::Component(Component { file: "/s.solb".into(), component });
        assert_eq!((&terms.terms[0].field, &terms.terms[0].adjoint), (&component(4), &Some(component(5))));
        let refused = goal().terms("/s.solb".as_ref(), &fields[..2]).unwrap_err();
        assert!(refused.contains("[goal] terms, 1") && refused.contains("'l'"), "{refused}");
    }
}
