//! Meshes and fields in the format that a solver wants, by the ending of the file.
use super::Job;
use crate::formats::{self, Dataset, Format, NamedField};
use crate::mesh::{Association, TetMesh};
use std::path::Path;

/// Refuses an ending that no mesh is written with.
pub fn check_mesh_format(path: &Path) -> Result<(), String> {
    match Format::of(path) {
        Ok(format) if !format.is_fields() => Ok(()),
        Ok(_) => Err(format!("{}: this is a format of fields alone; give one of meshes, such as .vtu", path.display())),
        Err(error) => Err(error.to_string()),
    }
}

/// Refuses an ending that no fields are written with.
pub fn check_field_format(path: &Path) -> Result<(), String> {
    match Format::of(path) {
        Ok(format) if format.is_fields() => Ok(()),
        Ok(_) => Err(format!("{}: give a format of fields alone: .sol, .solb, .csv or .dat", path.display())),
        Err(error) => Err(error.to_string()),
    }
}

/// Refuses an ending that no fields are read from: those of fields alone, and meshes that carry fields.
pub fn check_solution_format(path: &Path) -> Result<(), String> {
    Format::of(path).map(drop).map_err(|error| error.to_string())
}

/// Writes the mesh for the solver, with the fields of the last solution where one file carries both. Its association with a model is left
/// out, since other readers (meshio among them) fail on it.
pub fn write_mesh(path: &Path, data: &Dataset) -> Result<(), String> {
    let carries = matches!(Format::of(path), Ok(Format::Vtu));
    let mesh = TetMesh { association: Association::default(), ..data.mesh.clone() };
    let fields = if carries { data.fields.clone() } else { Vec::new() };
    let data = Dataset { mesh, stack: data.stack.clone(), names: data.names.clone(), fields };
    formats::write(path, &data).map(drop).map_err(|error| error.to_string())
}

/// Writes the fields of the last solution.
pub fn write_fields(path: &Path, data: &Dataset) -> Result<(), String> {
    formats::write(path, data).map(drop).map_err(|error| error.to_string())
}

/// Reads what the solver wrote on the mesh of the job; `names` are those of the fields where the format has none.
pub fn read_fields(path: &Path, job: &Job<'_>, names: &[String]) -> Result<Vec<NamedField>, String> {
    let mut data = Dataset { mesh: job.mesh()?, ..Dataset::default() };
    let format = Format::of(path).map_err(|error| error.to_string())?;
    if format.is_fields() {
        formats::read_fields(path, &mut data).map_err(|error| error.to_string())?;
    } else {
        let read = formats::read(path).map_err(|error| error.to_string())?.content;
        if read.mesh.vertices.len() != data.mesh.vertices.len() {
            let (found, wanted) = (read.mesh.vertices.len(), data.mesh.vertices.len());
            return Err(format!("{}: {found} vertices, but the mesh that was solved on has {wanted}", path.display()));
        }
        data.fields = read.fields;
    }
    let unnamed = matches!(format, Format::Solution | Format::Libmeshb);
    if unnamed && !names.is_empty() {
        if names.len() != data.fields.len() {
            let (found, given) = (data.fields.len(), names.len());
            return Err(format!(
                "{}: {found} fields, but [solver] fields names {given}: name each, in their order",
                path.display()
            ));
        }
        data.fields.iter_mut().zip(names).for_each(|(field, name)| field.name.clone_from(name));
    }
    Ok(data.fields)
}
