//! numpy's arrays as the kernel's slices and back. Nothing is copied here: arrays come in contiguous and of the kernel's types (geo_adapt/mesh.py
//! sees to it), and what goes out is handed over with its memory.
use crate::errors;
use geo_adapt::api::MeshView;
use geo_adapt::geometry::classify::Classification;
use geo_adapt::metric::{Field, Sym3};
use geo_adapt::tasks::{Plan, Pool, Team};
use geo_adapt::{Association, Elements, TetMesh};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;

/// Which vertices lie on which entities of the model, as files carry it. Python hands it on.
#[pyclass(frozen, module = "geo_adapt._kernel")]
pub struct Associated(pub Association);

/// Where a mesh that came out of an adapter lies on its model. Python hands it on.
#[pyclass(frozen, module = "geo_adapt._kernel")]
pub struct Place(pub Classification);

/// The arrays of a `geo_adapt.Mesh`.
#[derive(FromPyObject)]
pub struct Arrays<'py> {
    points: PyReadonlyArray2<'py, f64>,
    tets: PyReadonlyArray2<'py, u32>,
    triangles: PyReadonlyArray2<'py, u32>,
    edges: PyReadonlyArray2<'py, u32>,
    point_references: PyReadonlyArray1<'py, i32>,
    tet_references: PyReadonlyArray1<'py, i32>,
    triangle_references: PyReadonlyArray1<'py, i32>,
    edge_references: PyReadonlyArray1<'py, i32>,
    corners: PyReadonlyArray1<'py, u32>,
    required_points: PyReadonlyArray1<'py, u32>,
    required_edges: PyReadonlyArray1<'py, u32>,
    required_triangles: PyReadonlyArray1<'py, u32>,
    #[pyo3(attribute("_association"))]
    association: Option<Py<Associated>>,
}

impl Arrays<'_> {
    /// The slices.
    pub fn view(&self) -> PyResult<MeshView<'_>> {
        Ok(MeshView {
            vertices: rows("points", &self.points)?,
            tets: rows("tets", &self.tets)?,
            triangles: rows("triangles", &self.triangles)?,
            edges: rows("edges", &self.edges)?,
            vertex_refs: flat("point_references", &self.point_references)?,
            tet_refs: flat("tet_references", &self.tet_references)?,
            triangle_refs: flat("triangle_references", &self.triangle_references)?,
            edge_refs: flat("edge_references", &self.edge_references)?,
            corners: flat("corners", &self.corners)?,
            required_vertices: flat("required_points", &self.required_points)?,
            required_edges: flat("required_edges", &self.required_edges)?,
            required_triangles: flat("required_triangles", &self.required_triangles)?,
            association: self.association.as_ref().map(|held| &held.get().0),
            place: None,
        })
    }
}

/// A contiguous array of rows as a slice of them.
pub fn rows<'a, T: Element, const N: usize>(name: &str, array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [[T; N]]> {
    let wrong = || errors::input(format!("{name}: give a C-contiguous array of shape (n, {N})"));
    let (found, []) = array.as_slice().map_err(|_| wrong())?.as_chunks() else { return Err(wrong()) };
    // Rows of another length can fill up an array, too.
    if found.len() == array.as_array().nrows() { Ok(found) } else { Err(wrong()) }
}

/// A contiguous array as a slice.
pub fn flat<'a, T: Element>(name: &str, array: &'a PyReadonlyArray1<'_, T>) -> PyResult<&'a [T]> {
    array.as_slice().map_err(|_| errors::input(format!("{name}: give a contiguous array of shape (n,)")))
}

/// Rows that are handed over with their memory, shape (n, N).
pub fn give_rows<T: Element, const N: usize>(py: Python<'_>, rows: Vec<[T; N]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, N])
}

/// The arrays of a mesh by the names of the arguments of `geo_adapt.Mesh`, with their memory.
pub fn give_mesh<'py>(py: Python<'py>, mesh: TetMesh) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("points", give_rows(py, mesh.vertices)?)?;
    all.set_item("point_references", PyArray1::from_vec(py, mesh.vertex_refs))?;
    give_elements(&all, "tet", mesh.tets)?;
    give_elements(&all, "triangle", mesh.triangles)?;
    give_elements(&all, "edge", mesh.edges)?;
    all.set_item("corners", PyArray1::from_vec(py, mesh.corners))?;
    all.set_item("required_points", PyArray1::from_vec(py, mesh.required_vertices))?;
    all.set_item("required_edges", PyArray1::from_vec(py, mesh.required_edges))?;
    all.set_item("required_triangles", PyArray1::from_vec(py, mesh.required_triangles))?;
    if !mesh.association.is_empty() {
        all.set_item("association", Py::new(py, Associated(mesh.association))?)?;
    }
    Ok(all)
}

fn give_elements<const N: usize>(all: &Bound<'_, PyDict>, name: &str, elements: Elements<N>) -> PyResult<()> {
    let py = all.py();
    all.set_item(format!("{name}s"), give_rows(py, elements.nodes)?)?;
    all.set_item(format!("{name}_references"), PyArray1::from_vec(py, elements.refs))
}

/// A pool of threads; 0 stands for all cores.
pub fn pool(threads: usize) -> PyResult<Pool> {
    let cores = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    Pool::new(if threads == 0 { cores() } else { threads }).map_err(errors::threads)
}

/// The threads of a pool.
pub fn team(pool: &Pool) -> Team<'_> {
    Team::new(pool, Plan::default())
}

/// ln M of metrics, shape (n, 6), that fit so many vertices and are positive definite.
pub fn logs(team: Team<'_>, metric: &[[f64; 6]], vertices: usize) -> PyResult<Vec<Sym3>> {
    if metric.len() != vertices {
        let found = metric.len();
        return Err(errors::input(format!("{found} metrics are given for {vertices} points: give one each")));
    }
    let tensors: Vec<Sym3> = metric.iter().map(|&terms| Sym3(terms)).collect();
    if let Some(vertex) = tensors.iter().position(|tensor| !tensor.is_spd()) {
        return Err(errors::metric(format!("the metric of point {vertex} is not positive definite and finite")));
    }
    Ok(Field::logs_of(team, &tensors))
}

/// M = exp of logarithms, as the program writes it.
pub fn exp(team: Team<'_>, logs: &[Sym3]) -> PyResult<Vec<[f64; 6]>> {
    let solution = Field::solution_of_logs(team, Path::new("metric"), logs).map_err(errors::metric)?;
    let values = solution.fields.into_iter().next().map(|field| field.values).unwrap_or_default();
    Ok(values.as_chunks().0.to_vec())
}
