//! From a mesh or a solution to a file.
use super::keyword::Keyword;
use super::layout::{Layout, version};
use super::rows::{Content, mesh_sections, solution_sections};
use super::{Batch, Error, Solution, SolutionField};
use crate::mesh::{Elements, OnFace, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

/// Writes a mesh by the path's extension.
pub(super) fn mesh_to(batch: &mut Batch, team: Team<'_>, path: &Path, mesh: &TetMesh) -> Result<(), Error> {
    let binary = is_binary(path, "mesh")?;
    check_mesh(team, mesh).map_err(|(place, message)| Error::content(path, place, message))?;
    let sections = mesh_sections(mesh);
    let layout = Layout::of(binary, version(&sections), &sections, Content::Mesh(mesh));
    batch.add_laid_out(path, true, |to| layout.write(team, to))
}

/// Writes a solution by the path's extension.
pub(super) fn solution_to(batch: &mut Batch, team: Team<'_>, path: &Path, solution: &Solution) -> Result<(), Error> {
    let binary = is_binary(path, "sol")?;
    check_solution(team, solution).map_err(|(place, message)| Error::content(path, place, message))?;
    let sections = solution_sections(solution);
    let layout = Layout::of(binary, version(&sections), &sections, Content::Solution(solution));
    batch.add_laid_out(path, false, |to| layout.write(team, to))
}

/// Whether a path's extension is `name` with a b behind it, not `name` alone.
fn is_binary(path: &Path, name: &str) -> Result<bool, Error> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    match extension.strip_prefix(name) {
        Some("") => Ok(false),
        Some("b") => Ok(true),
        _ => {
            let message =
                format!("the format is not known; give a name that ends in .{name} (text) or .{name}b (binary)");
            Err(Error::content(path, "extension", message))
        }
    }
}

/// A place and what is wrong there.
type Fault = (String, String);

/// Rows that a task checks.
const CHECKED: usize = 4 * GRAIN;

/// What is written must be readable again.
fn check_mesh(team: Team<'_>, mesh: &TetMesh) -> Result<(), Fault> {
    let vertices = mesh.vertices.len();
    if vertices == 0 {
        return Err((Keyword::Vertices.name().into(), "the mesh has no vertices; nothing is written".into()));
    }
    check_length(Keyword::Vertices, mesh.vertex_refs.len(), vertices)?;
    check_finite(team, Keyword::Vertices, vertices, |v| mesh.vertices[v])?;
    check_elements(team, Keyword::Edges, &mesh.edges, vertices)?;
    check_elements(team, Keyword::Triangles, &mesh.triangles, vertices)?;
    check_elements(team, Keyword::Tetrahedra, &mesh.tets, vertices)?;
    let check = |keyword, indices: &[u32], limit| check_indices(team, keyword, indices.len(), |k| indices[k], limit);
    check(Keyword::Corners, &mesh.corners, vertices)?;
    check(Keyword::Ridges, &mesh.ridges, mesh.edges.len())?;
    check(Keyword::RequiredVertices, &mesh.required_vertices, vertices)?;
    check(Keyword::RequiredEdges, &mesh.required_edges, mesh.edges.len())?;
    check(Keyword::RequiredTriangles, &mesh.required_triangles, mesh.triangles.len())?;
    let on = &mesh.association;
    check_indices(team, Keyword::OnVertices, on.vertices.len(), |k| on.vertices[k].vertex, vertices)?;
    check_indices(team, Keyword::OnEdges, on.edges.len(), |k| on.edges[k].vertex, vertices)?;
    check_indices(team, Keyword::OnFaces, on.faces.len(), |k| on.faces[k].vertex, vertices)?;
    check_finite(team, Keyword::OnEdges, on.edges.len(), |k| [on.edges[k].t, on.edges[k].r])?;
    check_finite(team, Keyword::OnFaces, on.faces.len(), |k| {
        let OnFace { uv: [u, v], r, .. } = on.faces[k];
        [u, v, r]
    })
}

fn check_solution(team: Team<'_>, solution: &Solution) -> Result<(), Fault> {
    let name = Keyword::SolAtVertices.name();
    if solution.fields.is_empty() {
        return Err((name.into(), "the solution has no field; nothing is written".into()));
    }
    for (number, SolutionField { kind, values }) in (1..).zip(&solution.fields) {
        let width = kind.values();
        if values.len() != solution.vertices * width {
            let (length, vertices) = (values.len(), solution.vertices);
            let message = format!("{length} values; {width} at each of {vertices} vertices are expected");
            return Err((format!("{name}, field {number}"), message));
        }
        check_finite(team, Keyword::SolAtVertices, solution.vertices, |v| &values[v * width..][..width])?;
    }
    Ok(())
}

fn check_length(keyword: Keyword, refs: usize, entities: usize) -> Result<(), Fault> {
    if refs == entities {
        return Ok(());
    }
    Err((keyword.name().into(), format!("{refs} references for {entities} entities; give each one reference")))
}

fn check_elements<const N: usize>(
    team: Team<'_>,
    keyword: Keyword,
    elements: &Elements<N>,
    vertices: usize,
) -> Result<(), Fault> {
    check_length(keyword, elements.refs.len(), elements.nodes.len())?;
    match team.first(CHECKED, elements.len(), |k| elements.nodes[k].iter().any(|&v| v as usize >= vertices)) {
        None => Ok(()),
        Some(k) => Err(out_of_range(keyword, k, vertices)),
    }
}

fn check_indices(
    team: Team<'_>,
    keyword: Keyword,
    count: usize,
    index: impl Fn(usize) -> u32 + Sync,
    limit: usize,
) -> Result<(), Fault> {
    match team.first(CHECKED, count, |k| index(k) as usize >= limit) {
        None => Ok(()),
        Some(k) => Err(out_of_range(keyword, k, limit)),
    }
}

fn out_of_range(keyword: Keyword, position: usize, limit: usize) -> Fault {
    let message = format!("an index is out of range: {limit} are there, counted from 0; nothing is written");
    (format!("{} {}", keyword.name(), position + 1), message)
}

fn check_finite<R: AsRef<[f64]>>(
    team: Team<'_>,
    keyword: Keyword,
    count: usize,
    row: impl Fn(usize) -> R + Sync,
) -> Result<(), Fault> {
    match team.first(CHECKED, count, |k| !row(k).as_ref().iter().all(|x| x.is_finite())) {
        None => Ok(()),
        Some(k) => {
            let message = "a value is not a finite number; nothing is written".into();
            Err((format!("{} {}", keyword.name(), k + 1), message))
        }
    }
}
