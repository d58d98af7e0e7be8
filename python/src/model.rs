//! CAD models that were read before by the program, in a process of its own: entities, closest points, curvatures.
use crate::arrays::{self, rows};
use crate::errors;
use geo_adapt::geometry::{Evaluate, Evaluator, Geometry, Names};
use geo_adapt::mesh::vector::{Vec3, distance};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A model of OpenCASCADE, shared by all that use it.
#[pyclass(frozen, module = "geo_adapt._kernel")]
pub struct Model(pub Arc<geo_adapt::Model>);

/// The nearest place of a point on the model.
#[derive(Clone, Copy)]
struct Found {
    point: Vec3,
    distance: f64,
    face: u32,
    uv: [f64; 2],
}

/// Points, distances, faces (from 1), unit normals and principal curvatures.
type Closest<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i32>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

#[pymethods]
impl Model {
    /// Of a file that the program saved, and names as JSON.
    #[new]
    fn new(py: Python<'_>, saved: PathBuf, called: &str) -> PyResult<Self> {
        let names: Names = serde_json::from_str(called).map_err(|error| errors::input(error.to_string()))?;
        let mut model = py.detach(|| geo_adapt::Model::read_saved(&saved)).map_err(errors::model)?;
        let mut all = model.names().clone();
        all.update(names);
        model.rename(all);
        Ok(Self(Arc::new(model)))
    }

    /// Writes the model as OpenCASCADE's BREP text.
    fn brep(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.0.write_brep(&path)).map_err(errors::model)
    }

    /// The closest point of the model to each point, (n, 3), on its faces or on one of them (from 1).
    #[pyo3(signature = (points, face, threads))]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        face: Option<u32>,
        threads: usize,
    ) -> PyResult<Closest<'py>> {
        let count = self.0.topology().faces.len() as u32;
        if face.is_some_and(|face| face == 0 || face > count) {
            return Err(errors::input(format!("face {}: the model has the faces 1 to {count}", face.unwrap_or(0))));
        }
        let points = rows::<_, 3>("points", &points)?;
        if let Some(at) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(errors::input(format!("point {at} is not finite")));
        }
        let pool = arrays::pool(threads)?;
        let found = py.detach(|| {
            let evaluator = || self.0.evaluator();
            arrays::team(&pool).map_with(GRAIN, points.len(), evaluator, |evaluator, at| {
                let found = closest(evaluator, points[at], face, count);
                let frame = evaluator.face_frame(found.face, found.uv);
                (found, frame.normal, frame.curvatures)
            })
        });
        Ok((
            arrays::give_rows(py, found.iter().map(|(found, ..)| found.point).collect())?,
            PyArray1::from_vec(py, found.iter().map(|(found, ..)| found.distance).collect()),
            PyArray1::from_vec(py, found.iter().map(|(found, ..)| found.face as i32 + 1).collect()),
            arrays::give_rows(py, found.iter().map(|&(_, normal, _)| normal).collect())?,
            arrays::give_rows(py, found.iter().map(|&(_, _, curvatures)| curvatures).collect())?,
        ))
    }
}

/// Points a task.
const GRAIN: usize = 64;

fn closest(evaluator: &mut Evaluator<'_>, point: Vec3, face: Option<u32>, count: u32) -> Found {
    let of = |evaluator: &mut Evaluator<'_>, face: u32| {
        let on = evaluator.closest_on_face(face, point, None);
        Found { point: on.point, distance: distance(on.point, point), face, uv: on.uv }
    };
    if let Some(face) = face {
        return of(evaluator, face - 1);
    }
    let mut best = of(evaluator, 0);
    for face in 1..count {
        if let Some(on) = evaluator.closest_on_face_within(face, point, best.distance) {
            best = Found { point: on.point, distance: on.distance, face, uv: on.uv };
        }
    }
    best
}
