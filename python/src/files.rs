//! Meshes and fields in files of any format, as the program reads and writes them.
use crate::arrays::{self, Arrays};
use crate::errors;
use geo_adapt::formats::{self, Dataset, Format, NamedField};
use geo_adapt::geometry::{Names, names};
use geo_adapt::io::{FieldKind, Read, Solution, SolutionField};
use geo_adapt::mesh::io::{self, Batch};
use geo_adapt::tasks::Team;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::{Path, PathBuf};

/// Values of a field with the number of them a vertex, shape (n, k).
type Values<'py> = PyReadonlyArray2<'py, f64>;

/// Reads a mesh: its arrays, its names as JSON, its fields as (name, (n, k)), and notices.
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn read_mesh<'py>(
    py: Python<'py>,
    path: PathBuf,
    threads: usize,
) -> PyResult<(Bound<'py, PyDict>, String, Vec<(String, Bound<'py, PyArray2<f64>>)>, Vec<String>)> {
    let pool = arrays::pool(threads)?;
    let Read { content, notices } = py.detach(|| read(arrays::team(&pool), &path)).map_err(errors::of_file)?;
    let count = content.mesh.vertices.len();
    let mut fields = Vec::with_capacity(content.fields.len());
    for NamedField { name, kind, values } in content.fields {
        fields.push((name, PyArray1::from_vec(py, values).reshape([count, kind.values()])?));
    }
    let called = serde_json::to_string(&content.names).map_err(errors::of_file)?;
    Ok((arrays::give_mesh(py, content.mesh)?, called, fields, notices))
}

fn read(team: Team<'_>, path: &Path) -> Result<Read<Dataset>, io::Error> {
    let read = if Format::of_file(path)? == Format::Libmeshb {
        let Read { content: (mesh, stack), notices } = io::read_mesh_and_stack(team, path)?;
        Read { content: Dataset { mesh, stack, names: names::read(path)?, ..Dataset::default() }, notices }
    } else {
        formats::read(path)?
    };
    if !read.content.stack.is_empty() {
        let message = format!("there are {}: split them by `geo-adapt convert --split`", read.content.stack.told());
        return Err(io::Error::Content { path: path.to_owned(), place: "cells".into(), message });
    }
    Ok(read)
}

/// Writes a mesh with its names and fields: what the format cannot carry.
#[pyfunction]
pub fn write_mesh(
    py: Python<'_>,
    path: PathBuf,
    mesh: Arrays<'_>,
    called: String,
    fields: Vec<(String, Values<'_>)>,
    threads: usize,
) -> PyResult<Vec<String>> {
    let pool = arrays::pool(threads)?;
    let names: Names = serde_json::from_str(&called).map_err(|error| errors::input(error.to_string()))?;
    let mut all = Vec::with_capacity(fields.len());
    for (name, values) in fields {
        let kind = kind_of(&name, &values)?;
        all.push(NamedField { name, kind, values: slice(&values)?.to_vec() });
    }
    let view = mesh.view()?;
    py.detach(|| {
        let mesh = view.to_mesh().map_err(errors::of_adapter)?;
        let data = Dataset { mesh, names, fields: all, ..Dataset::default() };
        write(arrays::team(&pool), &path, &data).map_err(errors::of_file)
    })
}

fn write(team: Team<'_>, path: &Path, data: &Dataset) -> Result<Vec<String>, io::Error> {
    if Format::of(path)? != Format::Libmeshb || !data.fields.is_empty() {
        return formats::write_on(team, path, data, formats::Options::default());
    }
    let mut batch = Batch::new();
    io::add_mesh(&mut batch, team, path, &data.mesh)?;
    names::add(&mut batch, path, &data.names, &[])?;
    batch.commit()?;
    Ok(Vec::new())
}

/// The fields of a .sol or .solb file, each (n, k) with k values a vertex, and notices.
#[pyfunction]
pub fn read_sol<'py>(py: Python<'py>, path: PathBuf, threads: usize) -> PyResult<(Bound<'py, PyList>, Vec<String>)> {
    let pool = arrays::pool(threads)?;
    let read = py.detach(|| io::read_solution_on(arrays::team(&pool), &path));
    let Read { content: Solution { vertices, fields }, notices } = read.map_err(errors::of_file)?;
    let list = PyList::empty(py);
    for SolutionField { kind, values } in fields {
        list.append(PyArray1::from_vec(py, values).reshape([vertices, kind.values()])?)?;
    }
    Ok((list, notices))
}

/// Writes fields, each (n, k), as .sol or .solb.
#[pyfunction]
pub fn write_sol(py: Python<'_>, path: PathBuf, fields: Vec<Values<'_>>, threads: usize) -> PyResult<()> {
    let pool = arrays::pool(threads)?;
    let mut solution = Solution::default();
    for (number, field) in fields.iter().enumerate() {
        let kind = kind_of(&format!("field {number}"), field)?;
        let count = field.as_array().nrows();
        if number > 0 && count != solution.vertices {
            return Err(errors::input(format!("field {number} has {count} rows, those before {}", solution.vertices)));
        }
        solution.vertices = count;
        solution.fields.push(SolutionField { kind, values: slice(field)?.to_vec() });
    }
    py.detach(|| io::write_solution_on(arrays::team(&pool), &path, &solution)).map_err(errors::of_file)
}

fn slice<'a>(values: &'a Values<'_>) -> PyResult<&'a [f64]> {
    values.as_slice().map_err(|_| errors::input("fields: give C-contiguous arrays"))
}

/// The kind of a field by its number of values a vertex.
fn kind_of(name: &str, values: &Values<'_>) -> PyResult<FieldKind> {
    match values.as_array().ncols() {
        1 => Ok(FieldKind::Scalar),
        3 => Ok(FieldKind::Vector),
        6 => Ok(FieldKind::SymmetricTensor),
        9 => Ok(FieldKind::Tensor),
        other => Err(errors::input(format!("{name}: {other} values a point; files hold 1, 3, 6 or 9"))),
    }
}
