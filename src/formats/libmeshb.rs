//! libMeshb's meshes and solutions, with the names beside: the formats of [`crate::mesh::io`].
use super::{Dataset, NamedField, error};
use crate::geometry::names;
use crate::mesh::io::{self, Batch, Error, FieldKind, Read, Solution};
use crate::tasks::Team;
use std::path::{Path, PathBuf};

/// Reads a mesh.
pub(super) fn read(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<Dataset>, Error> {
    let Read { content: (mesh, stack), notices } = io::mesh_of_bytes(team, path, bytes)?;
    Ok(Read { content: Dataset { mesh, stack, ..Dataset::default() }, notices })
}

/// Reads the names and the fields that lie beside a mesh.
pub(super) fn read_beside(team: Team<'_>, path: &Path, read: &mut Read<Dataset>) -> Result<(), Error> {
    read.content.names = names::read(path)?;
    let Read { content, notices } = fields_beside(team, path, read.content.mesh.vertices.len())?;
    read.content.fields = content;
    read.notices.extend(notices);
    Ok(())
}

/// Reads the fields that lie beside a mesh of so many vertices; a solution of another number of vertices is not its own.
pub(super) fn fields_beside(team: Team<'_>, path: &Path, vertices: usize) -> Result<Read<Vec<NamedField>>, Error> {
    let Some(beside) = ["solb", "sol"].map(|end| path.with_extension(end)).into_iter().find(|path| path.exists())
    else {
        return Ok(Read { content: Vec::new(), notices: Vec::new() });
    };
    let bytes = error::read_on(team, &beside)?;
    let solution = io::solution_of_bytes(team, &beside, &bytes)?;
    let found = solution.content.vertices;
    if found != vertices {
        let (beside, mesh) = (beside.display(), path.display());
        let notice = format!("{beside}: values at {found} vertices, and {mesh} has {vertices}: it is left out");
        return Ok(Read { content: Vec::new(), notices: vec![notice] });
    }
    Ok(Read { content: named(&beside, solution.content)?, notices: solution.notices })
}

/// Reads a solution for so many vertices, with the names that lie beside.
pub(super) fn read_solution(
    team: Team<'_>,
    path: &Path,
    bytes: &[u8],
    vertices: usize,
) -> Result<Read<Vec<NamedField>>, Error> {
    let Read { content, notices } = io::solution_of_bytes(team, path, bytes)?;
    if content.vertices != vertices {
        let message =
            format!("values at {} vertices, and the mesh has {vertices}; give the file of this mesh", content.vertices);
        return Err(error::at(path, "SolAtVertices", message));
    }
    Ok(Read { content: named(path, content)?, notices })
}

/// The fields with the names that lie beside, else with such as tell what they are.
fn named(path: &Path, solution: Solution) -> Result<Vec<NamedField>, Error> {
    let given = names::read_fields(path)?;
    let (count, is_metric) = (solution.fields.len(), solution.as_metric().is_some());
    let name = |index: usize| match given.get(index).filter(|_| given.len() == count) {
        Some(name) => name.clone(),
        None if is_metric => "metric".into(),
        None => format!("field {}", index + 1),
    };
    let fields = solution.fields.into_iter().enumerate();
    Ok(fields.map(|(index, field)| NamedField { name: name(index), kind: field.kind, values: field.values }).collect())
}

/// Writes a mesh; its fields and names beside it.
pub(super) fn write(batch: &mut Batch, team: Team<'_>, path: &Path, data: &Dataset) -> Result<Vec<String>, Error> {
    io::add_mesh_and_stack(batch, team, path, (&data.mesh, &data.stack))?;
    let mut notices = Vec::new();
    let beside = solution_path(path);
    if !data.fields.is_empty() {
        io::add_solution(batch, team, &beside, &data.solution())?;
        notices.push(format!("the fields are in {}", beside.display()));
    } else if beside.exists() {
        notices.push(format!("{} was there before and is not of this mesh; remove it", beside.display()));
    }
    names::add(batch, path, &data.names, &field_names(data))?;
    if !(data.names.is_empty() && data.fields.is_empty()) {
        notices.push(format!("the names are in {}", names::beside(path).display()));
    }
    Ok(notices)
}

/// Writes the fields alone, and their names beside them; names of references that are there already stay.
pub(super) fn write_solution(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    data: &Dataset,
) -> Result<Vec<String>, Error> {
    io::add_solution(batch, team, path, &data.solution())?;
    let there = names::read(path)?;
    names::add(batch, path, if there.is_empty() { &data.names } else { &there }, &field_names(data))?;
    Ok(vec![format!("the names are in {}", names::beside(path).display())])
}

/// Where the fields of a mesh go.
pub(super) fn solution_path(path: &Path) -> PathBuf {
    path.with_extension("solb")
}

/// Names of the fields; none where they say no more than the file itself.
fn field_names(data: &Dataset) -> Vec<String> {
    match &data.fields[..] {
        [NamedField { name, kind: FieldKind::SymmetricTensor, .. }] if name == "metric" => Vec::new(),
        fields => fields.iter().map(|field| field.name.clone()).collect(),
    }
}
