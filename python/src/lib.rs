//! `geo_adapt._kernel`: the library for Python's arrays. What users see is in geo_adapt/, with its documentation; here arguments are checked,
//! turned into the kernel's slices and handed over, while other threads of Python go on.
mod adapter;
mod arrays;
mod errors;
mod files;
mod goal;
mod metric;
mod model;
mod transfer;

use pyo3::prelude::*;
use pyo3::wrap_pyfunction as function;

/// As the program: large arrays lie on huge pages.
#[global_allocator]
static MEMORY: geo_adapt::memory::HugePages = geo_adapt::memory::HugePages;

#[pymodule]
fn _kernel(module: &Bound<'_, PyModule>) -> PyResult<()> {
    errors::add(module)?;
    module.add_class::<adapter::Adapter>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<arrays::Associated>()?;
    module.add_class::<arrays::Place>()?;
    for function in [
        function!(files::read_mesh, module)?,
        function!(files::write_mesh, module)?,
        function!(files::read_sol, module)?,
        function!(files::write_sol, module)?,
        function!(metric::grade, module)?,
        function!(metric::scale, module)?,
        function!(metric::complexity, module)?,
        function!(metric::limit, module)?,
        function!(metric::intersect, module)?,
        function!(metric::isotropic, module)?,
        function!(metric::implied, module)?,
        function!(metric::from_points, module)?,
        function!(metric::multiscale, module)?,
        function!(goal::goal, module)?,
        function!(goal::hessian, module)?,
        function!(metric::geometry, module)?,
        function!(metric::wall, module)?,
        function!(metric::distance, module)?,
        function!(transfer::transfer, module)?,
        function!(transfer::inspect, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
