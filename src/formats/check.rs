//! What every reader's and every writer's data must fulfil.
use super::{Dataset, NamedField, error};
use crate::mesh::Elements;
use crate::mesh::io::Error;
use crate::tasks::{GRAIN, Team};
use std::path::Path;

/// Items that a task checks.
const ITEMS: usize = 4 * GRAIN;

/// Checks that every index is in range, every number finite, every field as long as the mesh. Nothing else is checked.
///
/// # Errors
/// [`Error::Content`], with the element, vertex or field and the remedy.
pub(super) fn check(team: Team<'_>, path: &Path, data: &Dataset) -> Result<(), Error> {
    let mesh = &data.mesh;
    let vertices = mesh.vertices.len();
    if vertices == 0 {
        return Err(error::at(path, "whole file", "there are no vertices; give a mesh"));
    }
    if vertices > u32::MAX as usize {
        return Err(error::at(path, "vertices", format!("there are {vertices}; at most {} are supported", u32::MAX)));
    }
    if let Some(v) = team.first(ITEMS, vertices, |v| !mesh.vertices[v].iter().all(|x| x.is_finite())) {
        return Err(error::at(path, format!("vertex {}", v + 1), "a coordinate is not a finite number; correct it"));
    }
    elements(team, path, "tetrahedron", &mesh.tets, vertices)?;
    elements(team, path, "triangle", &mesh.triangles, vertices)?;
    elements(team, path, "edge", &mesh.edges, vertices)?;
    if let Some(v) = data.stack.nodes().find(|&v| v as usize >= vertices) {
        return Err(error::at(path, "stack", format!("it has vertex {}, and there are {vertices}", v + 1)));
    }
    for field in &data.fields {
        let (place, width) = (format!("field {}", error::short(&field.name)), field.kind.values());
        if field.values.len() != width * vertices {
            let (found, wanted) = (field.values.len(), width * vertices);
            let message = format!("{found} values; {wanted} are expected, {width} at each of {vertices} vertices");
            return Err(error::at(path, place, message));
        }
        if let Some(at) = team.first(ITEMS, field.values.len(), |k| !field.values[k].is_finite()) {
            let message = format!(
                "vertex {}: {} is not a finite number; correct it, or leave the field out",
                at / width + 1,
                field.values[at]
            );
            return Err(error::at(path, place, message));
        }
    }
    Ok(())
}

/// Removes fields with a value that is not finite, with a notice each: a solver has failed, or the field has no meaning somewhere.
pub(super) fn drop_endless(path: &Path, fields: &mut Vec<NamedField>, notices: &mut Vec<String>) {
    fields.retain(|field| {
        let at = field.values.iter().position(|x| !x.is_finite());
        if let Some(at) = at {
            let (vertex, value, path) = (at / field.kind.values() + 1, field.values[at], path.display());
            notices.push(format!(
                "{path}: field {} is {value} at vertex {vertex}: it is left out",
                error::short(&field.name)
            ));
        }
        at.is_none()
    });
}

fn elements<const N: usize>(
    team: Team<'_>,
    path: &Path,
    name: &str,
    elements: &Elements<N>,
    vertices: usize,
) -> Result<(), Error> {
    let is_wrong = |k: usize| elements.nodes[k].iter().any(|&v| v as usize >= vertices);
    let Some(k) = team.first(ITEMS, elements.len(), is_wrong) else {
        return Ok(());
    };
    let message = format!("it has a vertex that is not there: there are {vertices}");
    Err(error::at(path, format!("{name} {} of {}", k + 1, elements.len()), message))
}
