//! The exceptions of the package, with the program's messages.
use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use std::fmt::Display;

create_exception!(geo_adapt, Error, PyException, "What this package raises: all its exceptions are of this class.");
create_exception!(
    geo_adapt,
    InputError,
    Error,
    "Arrays or options that do not fit; the message says which, and the remedy."
);
create_exception!(geo_adapt, MeshError, Error, "The mesh is no valid tetrahedral mesh, or does not lie on its model.");
create_exception!(geo_adapt, MetricError, Error, "A metric or a field of which none can be made.");
create_exception!(geo_adapt, ModelError, Error, "A CAD model that cannot be read or used.");
create_exception!(geo_adapt, FileError, Error, "A file that cannot be read or written.");

/// An error of the adapter, as the exception of its kind.
pub fn of_adapter(error: geo_adapt::Error) -> PyErr {
    use geo_adapt::Error as Of;
    let text = error.to_string();
    match error {
        Of::Metric { .. } | Of::Complexity { .. } => MetricError::new_err(text),
        Of::Model(_) | Of::Mesh(_) | Of::Place { .. } => MeshError::new_err(text),
        _ => InputError::new_err(text),
    }
}

/// What is wrong with a file.
pub fn of_file(error: impl Display) -> PyErr {
    FileError::new_err(error.to_string())
}

/// What is wrong with an argument.
pub fn input(text: impl Into<String>) -> PyErr {
    InputError::new_err(text.into())
}

/// What is wrong with a metric.
pub fn metric(error: impl Display) -> PyErr {
    MetricError::new_err(error.to_string())
}

/// What is wrong with a model.
pub fn model(error: impl Display) -> PyErr {
    ModelError::new_err(error.to_string())
}

/// Threads that the system refuses.
pub fn threads(error: geo_adapt::tasks::Error) -> PyErr {
    Error::new_err(error.to_string())
}

/// Adds the exceptions to the module.
pub fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("Error", py.get_type::<Error>())?;
    module.add("InputError", py.get_type::<InputError>())?;
    module.add("MeshError", py.get_type::<MeshError>())?;
    module.add("MetricError", py.get_type::<MetricError>())?;
    module.add("ModelError", py.get_type::<ModelError>())?;
    module.add("FileError", py.get_type::<FileError>())
}
