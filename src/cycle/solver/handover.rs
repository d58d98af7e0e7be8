//! Meshes and fields in the format that a solver wants, by the ending of the file.
use super::Job;
use crate::formats::{Dataset, NamedField};
use crate::mesh::{Association, TetMesh, io};
use std::path::Path;

fn ending(path: &Path) -> &str {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

/// Refuses an ending that no mesh is written with.
pub fn check_mesh_format(path: &Path) -> Result<(), String> {
    match ending(path) {
        "mesh" | "meshb" => Ok(()),
        _ => Err(format!("{}: meshes are written as .mesh or .meshb", path.display())),
    }
}

/// Refuses an ending that no fields are read and written with.
pub fn check_field_format(path: &Path) -> Result<(), String> {
    match ending(path) {
        "sol" | "solb" => Ok(()),
        _ => Err(format!("{}: fields go as .sol or .solb", path.display())),
    }
}

/// Writes the mesh for the solver, without its association with a model: other readers stumble over that, meshio among them.
pub fn write_mesh(path: &Path, data: &Dataset) -> Result<(), String> {
    let mesh = TetMesh { association: Association::default(), ..data.mesh.clone() };
    io::write_mesh(path, &mesh).map_err(|error| error.to_string())
}

/// Writes the fields of the last solution.
pub fn write_fields(path: &Path, data: &Dataset) -> Result<(), String> {
    io::write_solution(path, &data.solution()).map_err(|error| error.to_string())
}

/// Reads what the solver wrote on the mesh of the job; `names` are those of the fields where the format has none.
pub fn read_fields(path: &Path, job: &Job<'_>, names: &[String]) -> Result<Vec<NamedField>, String> {
    let solution = io::read_solution(path).map_err(|error| error.to_string())?.content;
    let vertices = io::read_mesh(job.mesh).map_err(|error| error.to_string())?.content.vertices.len();
    if solution.vertices != vertices {
        let found = solution.vertices;
        return Err(format!("{}: values at {found} vertices, but the mesh has {vertices}", path.display()));
    }
    named(path, names, solution.fields.into_iter().map(|field| (field.kind, field.values)).collect())
}

/// Fields with the names that the configuration gives them, else u1, u2, …
fn named(path: &Path, names: &[String], fields: Vec<(io::FieldKind, Vec<f64>)>) -> Result<Vec<NamedField>, String> {
    if !names.is_empty() && names.len() != fields.len() {
        let (found, given) = (fields.len(), names.len());
        return Err(format!(
            "{}: {found} fields, but [solver] fields names {given}: name each, in their order",
            path.display()
        ));
    }
    let name = |at: usize| names.get(at).cloned().unwrap_or_else(|| format!("u{}", at + 1));
    Ok(fields.into_iter().enumerate().map(|(at, (kind, values))| NamedField { name: name(at), kind, values }).collect())
}
