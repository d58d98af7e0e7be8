//! The metric of a goal, as `geo-adapt metric goal` makes it, and the second derivatives that it is made of.
use crate::arrays::{self, Arrays, exp, flat, logs, rows, team};
use crate::errors;
use crate::metric::{limits, positive};
use geo_adapt::TetMesh;
use geo_adapt::metric::goal::{Boundary, Derivative, Goal, Weight};
use geo_adapt::metric::multiscale::{Bounds, Measure, Norm, Options};
use geo_adapt::metric::recovery::{Recovery, Rings};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// A pair of a weight, or an adjoint with its derivatives, and a field.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Term<'py> {
    weight: PyReadonlyArray1<'py, f64>,
    derivatives: BTreeMap<String, f64>,
    field: PyReadonlyArray1<'py, f64>,
}

/// How the metric is made.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct How {
    complexity: f64,
    norm: f64,
    hessian: String,
    boundary: String,
    gradation: Option<f64>,
    hmin: Option<f64>,
    hmax: Option<f64>,
    aspect_ratio: Option<f64>,
    between: bool,
}

fn recovery(name: &str) -> PyResult<Recovery> {
    let found = Recovery::ALL.into_iter().find(|way| way.name() == name);
    found.ok_or_else(|| errors::input(format!("hessian {name:?}: fit, l2 or jumps")))
}

/// Values of a field, one a point.
fn values<'a>(name: &str, array: &'a PyReadonlyArray1<'_, f64>, points: usize) -> PyResult<&'a [f64]> {
    let found = flat(name, array)?;
    if found.len() == points {
        return Ok(found);
    }
    Err(errors::input(format!("{name}: {} values for {points} points: give one each", found.len())))
}

/// The metric of a goal; `fixed` is intersected at any scale.
#[pyfunction]
#[pyo3(signature = (mesh, terms, how, fixed, threads))]
pub fn goal<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    terms: Vec<Term<'_>>,
    how: How,
    fixed: Option<PyReadonlyArray2<'_, f64>>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    positive("complexity", how.complexity)?;
    let norm = Norm::of(how.norm).ok_or_else(|| errors::input(format!("norm {}: give 1 or more", how.norm)))?;
    let recovery = recovery(&how.hessian)?;
    let boundary = Boundary::ALL.into_iter().find(|way| way.name() == how.boundary);
    let boundary = boundary.ok_or_else(|| errors::input(format!("boundary {:?}: inside or own", how.boundary)))?;
    let limits = limits(how.hmin, how.hmax, how.aspect_ratio)?;
    let mut given = Vec::with_capacity(terms.len());
    for Term { weight, derivatives, field } in &terms {
        let parsed = derivatives.iter().map(|(name, &c)| Ok((name.parse::<Derivative>().map_err(errors::input)?, c)));
        let points = view.vertices.len();
        let parsed = parsed.collect::<PyResult<Vec<_>>>()?;
        given.push((values("weight", weight, points)?, parsed, values("field", field, points)?));
    }
    let fixed = fixed.as_ref().map(|fixed| rows::<_, 6>("fixed", fixed)).transpose()?;
    let made = py.detach(|| {
        let team = team(&pool);
        let mesh: TetMesh = view.to_mesh().map_err(errors::of_adapter)?;
        let fixed = fixed.map(|fixed| logs(team, fixed, mesh.vertices.len())).transpose()?;
        let measure = if how.between { Measure::Between } else { Measure::AtVertices };
        let (complexity, gradation) = (how.complexity, how.gradation);
        let bounds = Bounds { complexity, measure, gradation, limits, fixed: fixed.as_deref(), by_others: None };
        let mut goal = Goal::new(team, &mesh, recovery, boundary);
        for (number, (weight, derivatives, field)) in given.iter().enumerate() {
            let weight =
                if derivatives.is_empty() { Weight::Given(weight) } else { Weight::Adjoint(weight, derivatives) };
            goal.add(weight, field).map_err(|error| errors::metric(format!("term {number}: {error}")))?;
        }
        let (logs, _) = goal.metric(&Options { recovery, norm, bounds }).map_err(errors::metric)?;
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// The second derivatives of a field, shape (n, 6).
#[pyfunction]
pub fn hessian<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    field: PyReadonlyArray1<'_, f64>,
    way: &str,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (view, pool, recovery) = (mesh.view()?, arrays::pool(threads)?, recovery(way)?);
    let field = values("field", &field, view.vertices.len())?;
    if let Some(point) = field.iter().position(|value| !value.is_finite()) {
        return Err(errors::metric(format!("the value of point {point} is not a finite number")));
    }
    let made = py.detach(|| {
        let (team, mesh) = (team(&pool), view.to_mesh().map_err(errors::of_adapter)?);
        let (found, _) = recovery.hessians(team, &mesh, &Rings::of(team, &mesh), field);
        Ok::<_, PyErr>(found.into_iter().map(|hessian| hessian.0).collect())
    })?;
    arrays::give_rows(py, made)
}
