//! Metrics made, combined and measured, as `geo-adapt metric` does: from arrays of shape (n, 6), 11 12 22 13 23 33, to such arrays.
use crate::arrays::{self, Arrays, exp, flat, logs, rows, team};
use crate::errors;
use crate::model::Model;
use geo_adapt::geometry::classify::{self, Classification};
use geo_adapt::geometry::discrete::{Discrete, complete_boundary};
use geo_adapt::io::{FieldKind, Solution, SolutionField};
use geo_adapt::metric::from_points::{FromPoints, TooFew};
use geo_adapt::metric::implied::implied as implied_of;
use geo_adapt::metric::multiscale::{self as of_field, Bounds, Measure, Norm};
use geo_adapt::metric::recovery::Recovery;
use geo_adapt::metric::{self, Field, Limits, Sym3, field};
use geo_adapt::sizing;
use geo_adapt::sizing::layer::{self, Asked, Outside, Wall, Walls, wall_metric};
use geo_adapt::tasks::{GRAIN, Team};
use geo_adapt::{DiscreteOptions, Geometry, TetMesh};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

/// Metrics, shape (n, 6).
type Given<'py> = PyReadonlyArray2<'py, f64>;
type Made<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

/// Works on ln M of a metric of a mesh.
fn on_logs<'py>(
    py: Python<'py>,
    mesh: &Arrays<'_>,
    metric: &Given<'_>,
    threads: usize,
    work: impl FnOnce(Team<'_>, &TetMesh, &mut Vec<Sym3>) -> PyResult<()> + Send,
) -> Made<'py> {
    let (view, metric, pool) = (mesh.view()?, rows::<_, 6>("metric", metric)?, arrays::pool(threads)?);
    let made = py.detach(|| {
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        let team = team(&pool);
        let mut logs = logs(team, metric, mesh.vertices.len())?;
        work(team, &mesh, &mut logs)?;
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// The metric graded by a ratio.
#[pyfunction]
pub fn grade<'py>(py: Python<'py>, mesh: Arrays<'_>, metric: Given<'_>, ratio: f64, threads: usize) -> Made<'py> {
    if !(ratio > 1.0 && ratio.is_finite()) {
        return Err(errors::input(format!("ratio {ratio}: give a number above 1, such as 1.5")));
    }
    on_logs(py, &mesh, &metric, threads, |team, mesh, logs| {
        metric::grade(team, mesh, logs, ratio);
        Ok(())
    })
}

/// The metric scaled to a complexity.
#[pyfunction]
pub fn scale<'py>(py: Python<'py>, mesh: Arrays<'_>, metric: Given<'_>, wanted: f64, threads: usize) -> Made<'py> {
    positive("complexity", wanted)?;
    on_logs(py, &mesh, &metric, threads, |team, mesh, logs| {
        let own = checked(field::complexity_of_logs(team, mesh, logs))?;
        let shift = field::complexity_factor(own, wanted).ln();
        team.fill(GRAIN, logs, |_, logs| logs.iter_mut().for_each(|log| *log = log.plus_identity(shift)));
        Ok(())
    })
}

/// The complexity of a metric: Σ √det M V at the vertices, or ∫ √det M of the interpolant.
#[pyfunction]
pub fn complexity(py: Python<'_>, mesh: Arrays<'_>, metric: Given<'_>, between: bool, threads: usize) -> PyResult<f64> {
    let (view, metric, pool) = (mesh.view()?, rows::<_, 6>("metric", &metric)?, arrays::pool(threads)?);
    py.detach(|| {
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        let team = team(&pool);
        let logs = logs(team, metric, mesh.vertices.len())?;
        let of = if between { field::complexity_between } else { field::complexity_of_logs };
        Ok(of(team, &mesh, &logs))
    })
}

/// The metric within bounds of its sizes.
#[pyfunction]
#[pyo3(signature = (metric, hmin, hmax, aspect_ratio, threads))]
pub fn limit<'py>(
    py: Python<'py>,
    metric: Given<'_>,
    hmin: Option<f64>,
    hmax: Option<f64>,
    aspect_ratio: Option<f64>,
    threads: usize,
) -> Made<'py> {
    let limits = limits(hmin, hmax, aspect_ratio)?;
    let (metric, pool) = (rows::<_, 6>("metric", &metric)?, arrays::pool(threads)?);
    let made = py.detach(|| {
        let team = team(&pool);
        let mut logs = logs(team, metric, metric.len())?;
        limits.apply(team, &mut logs);
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// What each of several metrics asks for.
#[pyfunction]
pub fn intersect<'py>(py: Python<'py>, metrics: Vec<Given<'_>>, threads: usize) -> Made<'py> {
    let slices = metrics.iter().map(|metric| rows::<_, 6>("metric", metric)).collect::<PyResult<Vec<_>>>()?;
    let [first, others @ ..] = &slices[..] else { return Err(errors::input("give one metric at least")) };
    let pool = arrays::pool(threads)?;
    let made = py.detach(|| {
        let team = team(&pool);
        let mut all = logs(team, first, first.len())?;
        for other in others {
            metric::intersect_all(team, &mut all, &logs(team, other, first.len())?);
        }
        exp(team, &all)
    })?;
    arrays::give_rows(py, made)
}

/// Sizes, the same in all directions.
#[pyfunction]
pub fn isotropic<'py>(py: Python<'py>, sizes: PyReadonlyArray1<'_, f64>) -> Made<'py> {
    let solution = Solution {
        vertices: sizes.len()?,
        fields: vec![SolutionField { kind: FieldKind::Scalar, values: flat("sizes", &sizes)?.to_vec() }],
    };
    // As sizes in a file are read, and then made isotropic: to the last bit.
    let read = Field::logs_of_solution(Team::alone(), Path::new("sizes"), &solution, None).map_err(errors::metric)?;
    let logs: Vec<Sym3> = read.content.iter().map(|log| Sym3::ZERO.plus_identity(log.eigen().values[2])).collect();
    arrays::give_rows(py, exp(Team::alone(), &logs)?)
}

/// The metric of a mesh itself.
#[pyfunction]
pub fn implied<'py>(py: Python<'py>, mesh: Arrays<'_>, threads: usize) -> Made<'py> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    let made = py.detach(|| {
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        let found = implied_of(team(&pool), &mesh);
        let found = found.ok_or_else(|| errors::metric("all tetrahedra are flat or inverted"))?;
        exp(team(&pool), &found.logs)
    })?;
    arrays::give_rows(py, made)
}

/// The metric of a cloud of points.
#[pyfunction]
pub fn from_points<'py>(
    py: Python<'py>,
    at: Given<'_>,
    points: Given<'_>,
    neighbours: usize,
    threads: usize,
) -> Made<'py> {
    let (at, cloud) = (rows::<_, 3>("at", &at)?, rows::<_, 3>("points", &points)?);
    if !at.iter().chain(cloud).flatten().all(|x| x.is_finite()) {
        return Err(errors::input("points: give finite coordinates"));
    }
    if !(4..=100_000).contains(&neighbours) {
        return Err(errors::input(format!("neighbours {neighbours}: give 4 to 100000")));
    }
    let pool = arrays::pool(threads)?;
    let made = py.detach(|| {
        let found = metric::from_points::from_points(team(&pool), at, cloud, neighbours);
        let FromPoints { logs, .. } = found.map_err(|TooFew { distinct }| {
            errors::metric(format!(
                "{distinct} different points, fewer than the {neighbours} neighbours; give more points or fewer neighbours"
            ))
        })?;
        exp(team(&pool), &logs)
    })?;
    arrays::give_rows(py, made)
}

/// How the multiscale metric is made.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Multiscale {
    complexity: f64,
    norm: f64,
    hessian: String,
    gradation: Option<f64>,
    hmin: Option<f64>,
    hmax: Option<f64>,
    aspect_ratio: Option<f64>,
    between: bool,
}

/// The multiscale metric of sensors, each with the values (n,) of its steps in time; `fixed` is intersected at any scale.
#[pyfunction]
#[pyo3(signature = (mesh, sensors, how, fixed, threads))]
pub fn multiscale<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    sensors: Vec<Vec<PyReadonlyArray1<'_, f64>>>,
    how: Multiscale,
    fixed: Option<Given<'_>>,
    threads: usize,
) -> Made<'py> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    positive("complexity", how.complexity)?;
    let norm = Norm::of(how.norm).ok_or_else(|| errors::input(format!("norm {}: give 1 or more", how.norm)))?;
    let recovery = Recovery::ALL.into_iter().find(|way| way.name() == how.hessian);
    let recovery = recovery.ok_or_else(|| errors::input(format!("hessian {:?}: fit, l2 or jumps", how.hessian)))?;
    let limits = limits(how.hmin, how.hmax, how.aspect_ratio)?;
    let mut values = Vec::with_capacity(sensors.len());
    for steps in &sensors {
        let steps = steps.iter().map(|step| flat("field", step)).collect::<PyResult<Vec<_>>>()?;
        if let Some(step) = steps.iter().find(|step| step.len() != view.vertices.len()) {
            let (found, points) = (step.len(), view.vertices.len());
            return Err(errors::input(format!("field: {found} values for {points} points: give one each")));
        }
        values.push(steps);
    }
    let fixed = fixed.as_ref().map(|fixed| rows::<_, 6>("fixed", fixed)).transpose()?;
    let made = py.detach(|| {
        let team = team(&pool);
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        let fixed = fixed.map(|fixed| logs(team, fixed, mesh.vertices.len())).transpose()?;
        let measure = if how.between { Measure::Between } else { Measure::AtVertices };
        let (complexity, gradation) = (how.complexity, how.gradation);
        let bounds = Bounds { complexity, measure, gradation, limits, fixed: fixed.as_deref(), by_others: None };
        let options = of_field::Options { recovery, norm, bounds };
        let (logs, _) = of_field::multiscale(team, &mesh, &values, &options).map_err(errors::metric)?;
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// Where a mesh lies on its model, or on its own surface, which is that model then.
fn lies(
    team: Team<'_>,
    mesh: &TetMesh,
    model: Option<&geo_adapt::Model>,
    tolerance: Option<f64>,
) -> PyResult<(Option<geo_adapt::Model>, Classification)> {
    if let Some(model) = model {
        let options = classify::Options { tolerance, ..classify::Options::default() };
        let (place, _) = classify::classify(team, mesh, model, &options)
            .map_err(|error| errors::of_adapter(geo_adapt::Error::Model(error.into())))?;
        return Ok((None, place));
    }
    let (own, place) =
        Discrete::new(team, mesh, &DiscreteOptions::default()).map_err(|error| errors::of_adapter(error.into()))?;
    Ok((Some(geo_adapt::Model::Discrete(own)), place))
}

/// The faces of a model under the triangles of some references, ascending.
fn faces(mesh: &TetMesh, place: &Classification, references: &[i32]) -> Vec<u32> {
    let all = place.faces.iter().zip(&mesh.triangles.refs);
    let found: BTreeSet<u32> =
        all.filter(|(_, reference)| references.contains(reference)).map(|(&face, _)| face).collect();
    found.into_iter().collect()
}

/// How layers along walls are made.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct OfWalls {
    complexity: Option<f64>,
    hmax: Option<f64>,
    segments: f64,
    norm: f64,
    exact: bool,
    tolerance: Option<f64>,
}

/// The layers along walls, each by its name, the references of its triangles and its words.
#[pyfunction]
#[pyo3(signature = (mesh, model, walls, how, threads))]
pub fn wall<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    model: Option<Py<Model>>,
    walls: Vec<(String, Vec<i32>, String)>,
    how: OfWalls,
    threads: usize,
) -> Made<'py> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    positive("segments", how.segments)?;
    for (name, value) in [("hmax", how.hmax), ("complexity", how.complexity)] {
        value.map(|value| positive(name, value)).transpose()?;
    }
    let norm = Norm::of(how.norm).ok_or_else(|| errors::input(format!("norm {}: give 1 or more", how.norm)))?;
    let model = model.as_ref().map(|model| &*model.get().0);
    let made = py.detach(|| {
        let team = team(&pool);
        let mut mesh = view.to_mesh().map_err(errors::of_adapter)?;
        complete_boundary(team, &mut mesh);
        let (own, place) = lies(team, &mesh, model, how.tolerance)?;
        let model = own.as_ref().or(model).ok_or_else(|| errors::input("no model"))?;
        let mut asked = Vec::with_capacity(walls.len());
        for (name, references, words) in &walls {
            // A name may have signs in it that words have not.
            let read: Walls = format!("wall:{words}").parse().map_err(errors::input)?;
            let faces = faces(&mesh, &place, references);
            if faces.is_empty() {
                return Err(errors::input(format!(
                    "walls: {name}: the mesh has no triangle with reference {references:?}"
                )));
            }
            let named = |wall: Wall| Asked { wall: Wall { place: name.clone(), ..wall }, faces: faces.clone() };
            asked.extend(read.0.into_iter().map(named));
        }
        let greatest = how.hmax.unwrap_or(sizing::Options::of(model.topology()).greatest);
        let outside = Outside { greatest, segments: how.segments };
        let options = layer::Options { outside, complexity: how.complexity, norm, exact: how.exact };
        let (logs, _) = wall_metric(team, (&mesh, &place, model), &asked, &options).map_err(errors::metric)?;
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// The distance of the points from the faces of a model under the triangles of some references, or from these.
#[pyfunction]
#[pyo3(signature = (mesh, model, references, tolerance, threads))]
pub fn distance<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    model: Option<Py<Model>>,
    references: Vec<i32>,
    tolerance: Option<f64>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    let model = model.as_ref().map(|model| &*model.get().0);
    let found = py.detach(|| {
        let team = team(&pool);
        let mut mesh = view.to_mesh().map_err(errors::of_adapter)?;
        complete_boundary(team, &mut mesh);
        if !mesh.triangles.refs.iter().any(|reference| references.contains(reference)) {
            return Err(errors::input(format!("faces: the mesh has no triangle with reference {references:?}")));
        }
        let Some(model) = model else { return Ok(layer::from_triangles(team, &mesh, &references)) };
        let (_, place) = lies(team, &mesh, Some(model), tolerance)?;
        let faces = faces(&mesh, &place, &references);
        Ok(layer::distances(team, &mesh, &place, model, &faces))
    })?;
    Ok(PyArray1::from_vec(py, found))
}

/// What the geometry's metric is made by.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct OfGeometry {
    segments: f64,
    cells: Option<f64>,
    gradation: Option<f64>,
    hmin: Option<f64>,
    hmax: Option<f64>,
    aspect_ratio: Option<f64>,
    tolerance: Option<f64>,
}

/// The sizes that the geometry asks for. The mesh's missing triangles are added for it.
#[pyfunction]
#[pyo3(signature = (mesh, model, how, threads))]
pub fn geometry<'py>(
    py: Python<'py>,
    mesh: Arrays<'_>,
    model: Option<Py<Model>>,
    how: OfGeometry,
    threads: usize,
) -> Made<'py> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    let limits = limits(how.hmin, how.hmax, how.aspect_ratio)?;
    positive("segments", how.segments)?;
    let model = model.as_ref().map(|model| &*model.get().0);
    let made = py.detach(|| {
        let team = team(&pool);
        let mut mesh = view.to_mesh().map_err(errors::of_adapter)?;
        complete_boundary(team, &mut mesh);
        let (own, place) = lies(team, &mesh, model, how.tolerance)?;
        let model = own.as_ref().or(model).ok_or_else(|| errors::input("no model"))?;
        let usual = sizing::Options::of(model.topology());
        let greatest = limits.hmax.unwrap_or(usual.greatest.max(limits.hmin.unwrap_or(0.0)));
        let options = sizing::Options {
            segments: how.segments,
            least: limits.hmin.unwrap_or(usual.least.min(greatest)),
            greatest,
            aspect_ratio: limits.aspect_ratio,
            cells: how.cells,
            gradation: how.gradation,
        };
        let (logs, _) = sizing::geometry_metric(team, &mesh, &place, model, &options);
        exp(team, &logs)
    })?;
    arrays::give_rows(py, made)
}

/// Bounds of sizes.
pub fn limits(hmin: Option<f64>, hmax: Option<f64>, aspect_ratio: Option<f64>) -> PyResult<Limits> {
    for (name, value) in [("hmin", hmin), ("hmax", hmax), ("aspect_ratio", aspect_ratio)] {
        value.map(|value| positive(name, value)).transpose()?;
    }
    if hmin.zip(hmax).is_some_and(|(hmin, hmax)| hmin > hmax) {
        return Err(errors::input("hmin is above hmax: give a least size below the greatest"));
    }
    if aspect_ratio.is_some_and(|ratio| ratio < 1.0) {
        return Err(errors::input("aspect_ratio: give 1 or more"));
    }
    Ok(Limits { hmin, hmax, aspect_ratio })
}

/// Refuses what is not above zero.
pub fn positive(name: &str, value: f64) -> PyResult<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(errors::input(format!("{name} {value}: give a positive number")))
}

fn checked(complexity: f64) -> PyResult<f64> {
    if complexity > 0.0 && complexity.is_finite() {
        return Ok(complexity);
    }
    Err(errors::metric(format!("the complexity there is {complexity}; are all tetrahedra positive?")))
}
