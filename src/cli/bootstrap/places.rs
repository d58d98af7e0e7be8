//! Where meshers are looked for.
use super::{gmsh, netgen, rung};
use std::path::{Path, PathBuf};

/// The Python of the virtual environment that scripts/setup.sh makes for netgen, from the root of the project.
const ENVIRONMENT: &str = ".venv/mesher/bin/python3";

/// Where gmsh is: what its variable names, else in the search path.
pub fn gmsh_places() -> Vec<PathBuf> {
    vec![named(gmsh::VARIABLE).unwrap_or_else(|| rung::GMSH.into())]
}

/// Where a Python with netgen may be: what its variable names; else the project's virtual environment (looked for from the program's own
/// place and from the working folder upwards), then the system's Python.
pub fn netgen_places() -> Vec<PathBuf> {
    if let Some(python) = named(netgen::VARIABLE) {
        return vec![python];
    }
    let own = std::env::current_exe().ok();
    let here = std::env::current_dir().ok();
    let roots = own.iter().chain(&here).flat_map(|path| path.ancestors().map(Path::to_owned).collect::<Vec<_>>());
    let local = roots.map(|root| root.join(ENVIRONMENT)).find(|path| path.is_file());
    local.into_iter().chain([PathBuf::from("python3")]).collect()
}

fn named(variable: &str) -> Option<PathBuf> {
    std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from)
}
