//! Fields from mesh to mesh, and what a mesh is like.
use crate::arrays::{self, Arrays, rows, team};
use crate::errors;
use crate::model::Model;
use geo_adapt::TetMesh;
use geo_adapt::geometry::{classify, fidelity};
use geo_adapt::mesh::adjacency::MatchedFaces;
use geo_adapt::mesh::locate::Locator;
use geo_adapt::mesh::validity;
use geo_adapt::metric::{Statistics, Sym3, transfer as of_metric};
use geo_adapt::tasks::{GRAIN, Team};
use geo_adapt::transfer::{Keep, Places, conservative, interpolate};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::sync::Arc;

/// The old mesh to look in. There are tetrahedra.
fn locator(team: Team<'_>, mesh: TetMesh) -> PyResult<Locator> {
    if mesh.tets.is_empty() {
        return Err(errors::input("no tetrahedra: a volume mesh is needed"));
    }
    let faces = MatchedFaces::of(team, &mesh.tets.nodes);
    Ok(Locator::on(team, Arc::new(mesh), faces))
}

/// Values (n, k) at the vertices of the old mesh, brought to those of the new: linear, or "mean" or "mass" kept, or of a "metric".
#[pyfunction]
pub fn transfer<'py>(
    py: Python<'py>,
    old: Arrays<'_>,
    values: PyReadonlyArray2<'_, f64>,
    new: Arrays<'_>,
    method: &str,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (from, to, pool) = (old.view()?, new.view()?, arrays::pool(threads)?);
    let (width, count) = (values.as_array().ncols(), values.as_array().nrows());
    if count != from.vertices.len() || width == 0 {
        let points = from.vertices.len();
        return Err(errors::input(format!("values: shape ({count}, {width}), but the old mesh has {points} points")));
    }
    let metric = if method == "metric" { Some(rows::<_, 6>("values", &values)?) } else { None };
    let slice = values.as_slice().map_err(|_| errors::input("values: give a C-contiguous array"))?;
    let found = py.detach(|| {
        let team = team(&pool);
        let [old, new] = [&from, &to].map(|view| view.to_mesh().map_err(errors::of_adapter));
        let (locator, new) = (locator(team, old?)?, new?);
        let places = Places::of(team, &locator, &new.vertices);
        let keep = match method {
            "linear" => return Ok(interpolate(team, &locator, &places, width, slice)),
            "mean" => Keep::Mean,
            "mass" => Keep::Mass,
            _ => {
                let tensors = metric.ok_or_else(|| errors::input("method: linear, mean, mass or metric"))?;
                let logs = arrays::logs(team, tensors, count)?;
                let logs = of_metric::at(team, locator.tets(), &places, &logs);
                return Ok(team.map(GRAIN, logs.len(), |v| logs[v].exp().0).into_flattened());
            }
        };
        let found = conservative(team, &locator, &new, &places, width, slice, keep);
        found.map(|found| found.values).map_err(|error| errors::metric(error.to_string()))
    })?;
    let rows = found.len() / width;
    PyArray1::from_vec(py, found).reshape([rows, width])
}

/// What a mesh is like, as `inspect --json` tells it.
#[pyfunction]
#[pyo3(signature = (mesh, metric, model, threads))]
pub fn inspect(
    py: Python<'_>,
    mesh: Arrays<'_>,
    metric: Option<PyReadonlyArray2<'_, f64>>,
    model: Option<Py<Model>>,
    threads: usize,
) -> PyResult<String> {
    let (view, pool) = (mesh.view()?, arrays::pool(threads)?);
    let metric = metric.as_ref().map(|metric| rows::<_, 6>("metric", metric)).transpose()?;
    let model = model.as_ref().map(|model| &*model.get().0);
    py.detach(|| {
        let team = team(&pool);
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        if mesh.tets.is_empty() {
            return Err(errors::input("no tetrahedra: a volume mesh is needed"));
        }
        let statistics = match metric {
            Some(metric) => {
                // Checks them.
                arrays::logs(team, metric, mesh.vertices.len())?;
                let tensors: Vec<Sym3> = metric.iter().map(|&terms| Sym3(terms)).collect();
                Statistics::in_metric(team, &mesh, &tensors)
            }
            None => Statistics::in_space(team, &mesh),
        };
        let validity = validity::check_on(team, &mesh);
        let cad = model.map(|model| match classify::classify(team, &mesh, model, &classify::Options::default()) {
            Ok((place, _)) => json!(fidelity::measure(team, &mesh, model, &place)),
            Err(error) => json!({ "error": error.to_string() }),
        });
        let off = cad.as_ref().is_some_and(|cad| cad.get("error").is_some());
        let mut all = json!({ "valid": validity.is_valid() && !off, "worst_tet": worst(&mesh, &statistics) });
        for part in [json!(validity), json!(statistics)] {
            if let (Value::Object(all), Value::Object(part)) = (&mut all, part) {
                all.extend(part);
            }
        }
        if let Some(cad) = cad {
            all["cad"] = cad;
        }
        Ok(all.to_string())
    })
}

/// The tetrahedron of the least mean ratio.
fn worst(mesh: &TetMesh, statistics: &Statistics) -> Value {
    let index = statistics.mean_ratios.argmin;
    let Some(nodes) = mesh.tets.nodes.get(index) else { return Value::Null };
    let at: [f64; 3] = std::array::from_fn(|i| {
        let sum: f64 = nodes.iter().map(|&v| mesh.vertices[v as usize][i]).sum();
        sum * 0.25
    });
    json!({ "index": index + 1, "mean_ratio": statistics.mean_ratios.min, "at": at })
}
