//! From a mesh or a solution to a file.
use super::keyword::Keyword;
use super::layout::{Layout, version};
use super::rows::{Content, Slice, Whole, solution_sections};
use super::{Batch, Error, MeshCounts, Solution, SolutionField};
use crate::mesh::stack::Stack;
use crate::mesh::{OnFace, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

/// Writes a mesh without what was cut out of its stack, and the stack, by the path's extension.
pub(super) fn mesh_to(
    batch: &mut Batch,
    team: Team<'_>,
    path: &Path,
    (mesh, stack): (&TetMesh, &Stack),
) -> Result<(), Error> {
    let binary = is_binary(path, "mesh")?;
    let whole = Whole::of(mesh, stack);
    check_mesh(team, mesh, &whole).map_err(|(place, message)| Error::content(path, place, message))?;
    let sections = whole.sections();
    let layout = Layout::of(binary, version(&sections), &sections, Content::Mesh(whole));
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
pub(super) type Fault = (String, String);

/// Rows that a task checks.
const CHECKED: usize = 4 * GRAIN;

/// What is written must be readable again.
fn check_mesh(team: Team<'_>, mesh: &TetMesh, whole: &Whole<'_>) -> Result<(), Fault> {
    let counts = MeshCounts::of(mesh);
    check_counts(&counts)?;
    let mut slices = Keyword::ALL.into_iter().filter_map(|keyword| whole.slice(keyword));
    slices.try_for_each(|slice| check_slice(team, &slice, 0, &counts))
}

/// A mesh has vertices.
pub(super) fn check_counts(counts: &MeshCounts) -> Result<(), Fault> {
    if counts.vertices == 0 {
        return Err((Keyword::Vertices.name().into(), "the mesh has no vertices; nothing is written".into()));
    }
    Ok(())
}

/// Whether some rows of a mesh or a metric, from row `start` on, can be read again.
pub(super) fn check_slice(team: Team<'_>, slice: &Slice<'_>, start: usize, counts: &MeshCounts) -> Result<(), Fault> {
    let rows = Checked { team, keyword: slice.keyword(), start, count: slice.len() };
    let limit = counts.rows(rows.keyword.target());
    match *slice {
        Slice::Vertices(points, refs) => {
            rows.have_references(refs)?;
            rows.are_finite(|v| points[v])
        }
        Slice::Edges(nodes, refs) => rows.are_elements(nodes, refs, limit),
        Slice::Triangles(nodes, refs) => rows.are_elements(nodes, refs, limit),
        Slice::Tets(nodes, refs) | Slice::Quads(nodes, refs) => rows.are_elements(nodes, refs, limit),
        Slice::Cells(_, cells, numbers) => rows.are_below(limit, |k| cells[numbers[k] as usize].nodes()),
        Slice::Corners(indices)
        | Slice::Ridges(indices)
        | Slice::RequiredVertices(indices)
        | Slice::RequiredEdges(indices)
        | Slice::RequiredTriangles(indices) => rows.are_below(limit, |k| [indices[k]]),
        Slice::OnVertices(on) => rows.are_below(limit, |k| [on[k].vertex]),
        Slice::OnEdges(on) => {
            rows.are_below(limit, |k| [on[k].vertex])?;
            rows.are_finite(|k| [on[k].t, on[k].r])
        }
        Slice::OnFaces(on) => {
            rows.are_below(limit, |k| [on[k].vertex])?;
            rows.are_finite(|k| {
                let OnFace { uv: [u, v], r, .. } = on[k];
                [u, v, r]
            })
        }
        Slice::Tensors(tensors) => rows.are_finite(|v| tensors[v]),
        Slice::Fields(width, values) => rows.are_finite(|v| &values[v * width..][..width]),
    }
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
        let rows = Checked { team, keyword: Keyword::SolAtVertices, start: 0, count: solution.vertices };
        rows.are_finite(|v| &values[v * width..][..width])?;
    }
    Ok(())
}

/// Rows that are checked.
struct Checked<'p> {
    team: Team<'p>,
    keyword: Keyword,
    /// The first row's number in the section, from 0.
    start: usize,
    count: usize,
}

impl Checked<'_> {
    fn have_references(&self, refs: &[i32]) -> Result<(), Fault> {
        if refs.len() == self.count {
            return Ok(());
        }
        let (refs, entities) = (refs.len(), self.count);
        let message = format!("{refs} references for {entities} entities; give each one reference");
        Err((self.keyword.name().into(), message))
    }

    fn are_elements<const N: usize>(&self, nodes: &[[u32; N]], refs: &[i32], limit: usize) -> Result<(), Fault> {
        self.have_references(refs)?;
        self.are_below(limit, |k| nodes[k])
    }

    fn are_below<R: AsRef<[u32]>>(&self, limit: usize, row: impl Fn(usize) -> R + Sync) -> Result<(), Fault> {
        self.none_is(
            |k| row(k).as_ref().iter().any(|&index| index as usize >= limit),
            || format!("an index is out of range: {limit} are there, counted from 0; nothing is written"),
        )
    }

    fn are_finite<R: AsRef<[f64]>>(&self, row: impl Fn(usize) -> R + Sync) -> Result<(), Fault> {
        self.none_is(
            |k| !row(k).as_ref().iter().all(|x| x.is_finite()),
            || "a value is not a finite number; nothing is written".into(),
        )
    }

    fn none_is(&self, is_wrong: impl Fn(usize) -> bool + Sync, message: impl Fn() -> String) -> Result<(), Fault> {
        match self.team.first(CHECKED, self.count, is_wrong) {
            None => Ok(()),
            Some(k) => Err((format!("{} {}", self.keyword.name(), self.start + k + 1), message())),
        }
    }
}
