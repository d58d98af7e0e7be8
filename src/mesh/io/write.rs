//! From a mesh or a solution to a file.
use super::keyword::Keyword;
use super::sink::{AsciiSink, BinarySink, Sink, version};
use super::source::Section;
use super::{Batch, Error, Solution, SolutionField};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::io::{self, Write};
use std::path::Path;

/// Rows of a solution that are encoded before they are written: some megabytes, and enough tasks for all threads.
const ROWS: usize = 64 * GRAIN;

/// Writes a mesh by the path's extension.
pub(super) fn mesh_to(batch: &mut Batch, path: &Path, mesh: &TetMesh) -> Result<(), Error> {
    let binary = is_binary(path, "mesh")?;
    check_mesh(mesh).map_err(|(place, message)| Error::content(path, place, message))?;
    let sections = mesh_sections(mesh);
    batch.add_main(path, |to| write_sections(to, binary, version(&sections), &sections, &Content::Mesh(mesh)))
}

/// Writes a solution by the path's extension.
pub(super) fn solution_to(batch: &mut Batch, team: Team<'_>, path: &Path, solution: &Solution) -> Result<(), Error> {
    let binary = is_binary(path, "sol")?;
    check_solution(team, solution).map_err(|(place, message)| Error::content(path, place, message))?;
    let sections = solution_sections(solution);
    batch.add(path, |to| write_sections(to, binary, version(&sections), &sections, &Content::Solution(team, solution)))
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

/// What is written.
pub(super) enum Content<'a> {
    Mesh(&'a TetMesh),
    Solution(Team<'a>, &'a Solution),
}

/// The sections of a mesh, empty ones left out.
pub(super) fn mesh_sections(mesh: &TetMesh) -> Vec<Section> {
    let count = |keyword| match keyword {
        Keyword::Vertices => mesh.vertices.len(),
        Keyword::Edges => mesh.edges.len(),
        Keyword::Triangles => mesh.triangles.len(),
        Keyword::Tetrahedra => mesh.tets.len(),
        Keyword::Corners => mesh.corners.len(),
        Keyword::Ridges => mesh.ridges.len(),
        Keyword::RequiredVertices => mesh.required_vertices.len(),
        Keyword::RequiredEdges => mesh.required_edges.len(),
        Keyword::RequiredTriangles => mesh.required_triangles.len(),
        Keyword::OnVertices => mesh.association.vertices.len(),
        Keyword::OnEdges => mesh.association.edges.len(),
        Keyword::OnFaces => mesh.association.faces.len(),
        Keyword::SolAtVertices => 0,
    };
    let sections = Keyword::ALL.into_iter().map(|keyword| Section {
        keyword,
        count: count(keyword),
        body: 0..0,
        kinds: Vec::new(),
    });
    sections.filter(|s| s.count > 0).collect()
}

/// The section of a solution.
pub(super) fn solution_sections(solution: &Solution) -> Vec<Section> {
    let kinds = solution.fields.iter().map(|f| f.kind).collect();
    vec![Section { keyword: Keyword::SolAtVertices, count: solution.vertices, body: 0..0, kinds }]
}

/// Writes a whole file.
pub(super) fn write_sections(
    to: &mut dyn Write,
    binary: bool,
    version: i64,
    sections: &[Section],
    content: &Content,
) -> io::Result<()> {
    if binary {
        emit(BinarySink::new(to, version), sections, content)
    } else {
        emit(AsciiSink::new(to, version), sections, content)
    }
}

fn emit<S: Sink>(mut sink: S, sections: &[Section], content: &Content) -> io::Result<()> {
    for section in sections {
        sink.section(section);
        match content {
            Content::Mesh(mesh) => emit_mesh(&mut sink, section.keyword, mesh)?,
            Content::Solution(team, solution) => emit_solution(*team, &mut sink, solution)?,
        }
    }
    sink.end()
}

fn emit_mesh<S: Sink>(sink: &mut S, keyword: Keyword, mesh: &TetMesh) -> io::Result<()> {
    match keyword {
        Keyword::Vertices => {
            for (x, &reference) in mesh.vertices.iter().zip(&mesh.vertex_refs) {
                x.iter().for_each(|&x| sink.real(x));
                sink.int(reference.into());
                sink.end_row()?;
            }
            Ok(())
        }
        Keyword::Edges => emit_elements(sink, &mesh.edges),
        Keyword::Triangles => emit_elements(sink, &mesh.triangles),
        Keyword::Tetrahedra => emit_elements(sink, &mesh.tets),
        Keyword::Corners => emit_indices(sink, &mesh.corners),
        Keyword::Ridges => emit_indices(sink, &mesh.ridges),
        Keyword::RequiredVertices => emit_indices(sink, &mesh.required_vertices),
        Keyword::RequiredEdges => emit_indices(sink, &mesh.required_edges),
        Keyword::RequiredTriangles => emit_indices(sink, &mesh.required_triangles),
        Keyword::OnVertices | Keyword::OnEdges | Keyword::OnFaces => emit_association(sink, keyword, mesh),
        Keyword::SolAtVertices => Ok(()),
    }
}

fn emit_elements<S: Sink, const N: usize>(sink: &mut S, elements: &Elements<N>) -> io::Result<()> {
    for (nodes, reference) in elements.iter() {
        nodes.iter().for_each(|&node| sink.int(i64::from(node) + 1));
        sink.int(reference.into());
        sink.end_row()?;
    }
    Ok(())
}

fn emit_indices<S: Sink>(sink: &mut S, indices: &[u32]) -> io::Result<()> {
    for &index in indices {
        sink.int(i64::from(index) + 1);
        sink.end_row()?;
    }
    Ok(())
}

fn emit_association<S: Sink>(sink: &mut S, keyword: Keyword, mesh: &TetMesh) -> io::Result<()> {
    let mut row = |vertex: u32, id: i32, reals: &[f64]| {
        sink.int(i64::from(vertex) + 1);
        sink.int(id.into());
        reals.iter().for_each(|&x| sink.real(x));
        sink.end_row()
    };
    let from = &mesh.association;
    match keyword {
        Keyword::OnVertices => from.vertices.iter().try_for_each(|v| row(v.vertex, v.id, &[])),
        Keyword::OnEdges => from.edges.iter().try_for_each(|v| row(v.vertex, v.id, &[v.t, v.r])),
        _ => from.faces.iter().try_for_each(|v| row(v.vertex, v.id, &[v.uv[0], v.uv[1], v.r])),
    }
}

fn emit_solution<S: Sink>(team: Team<'_>, sink: &mut S, solution: &Solution) -> io::Result<()> {
    let row = |vertex: usize| {
        solution.fields.iter().flat_map(move |SolutionField { kind, values }| {
            values[vertex * kind.values()..][..kind.values()].iter().copied()
        })
    };
    for start in (0..solution.vertices).step_by(ROWS) {
        let count = ROWS.min(solution.vertices - start);
        let encoded = team.chunks(GRAIN, count, |range| {
            let mut bytes = Vec::new();
            range.for_each(|vertex| S::encode(row(start + vertex), &mut bytes));
            bytes
        });
        encoded.iter().try_for_each(|bytes| sink.rows(bytes))?;
    }
    Ok(())
}

/// A place and what is wrong there.
type Fault = (String, String);

/// What is written must be readable again.
fn check_mesh(mesh: &TetMesh) -> Result<(), Fault> {
    let vertices = mesh.vertices.len();
    if vertices == 0 {
        return Err((Keyword::Vertices.name().into(), "the mesh has no vertices; nothing is written".into()));
    }
    check_length(Keyword::Vertices, mesh.vertex_refs.len(), vertices)?;
    check_finite(Keyword::Vertices, mesh.vertices.iter().map(|x| &x[..]))?;
    check_elements(Keyword::Edges, &mesh.edges, vertices)?;
    check_elements(Keyword::Triangles, &mesh.triangles, vertices)?;
    check_elements(Keyword::Tetrahedra, &mesh.tets, vertices)?;
    check_indices(Keyword::Corners, &mesh.corners, vertices)?;
    check_indices(Keyword::Ridges, &mesh.ridges, mesh.edges.len())?;
    check_indices(Keyword::RequiredVertices, &mesh.required_vertices, vertices)?;
    check_indices(Keyword::RequiredEdges, &mesh.required_edges, mesh.edges.len())?;
    check_indices(Keyword::RequiredTriangles, &mesh.required_triangles, mesh.triangles.len())?;
    let on = &mesh.association;
    check_indices(Keyword::OnVertices, on.vertices.iter().map(|v| &v.vertex), vertices)?;
    check_indices(Keyword::OnEdges, on.edges.iter().map(|v| &v.vertex), vertices)?;
    check_indices(Keyword::OnFaces, on.faces.iter().map(|v| &v.vertex), vertices)?;
    check_finite(Keyword::OnEdges, on.edges.iter().map(|v| [v.t, v.r]))?;
    check_finite(Keyword::OnFaces, on.faces.iter().map(|v| [v.uv[0], v.uv[1], v.r]))
}

fn check_solution(team: Team<'_>, solution: &Solution) -> Result<(), Fault> {
    let name = Keyword::SolAtVertices.name();
    if solution.fields.is_empty() {
        return Err((name.into(), "the solution has no field; nothing is written".into()));
    }
    for (number, SolutionField { kind, values }) in (1..).zip(&solution.fields) {
        if values.len() != solution.vertices * kind.values() {
            let (length, vertices) = (values.len(), solution.vertices);
            let message = format!("{length} values; {} at each of {vertices} vertices are expected", kind.values());
            return Err((format!("{name}, field {number}"), message));
        }
        let parts =
            team.chunks(GRAIN * kind.values(), values.len(), |range| values[range].iter().all(|x| x.is_finite()));
        if parts.contains(&false) {
            check_finite(Keyword::SolAtVertices, values.chunks(kind.values()))?;
        }
    }
    Ok(())
}

fn check_length(keyword: Keyword, refs: usize, entities: usize) -> Result<(), Fault> {
    if refs == entities {
        return Ok(());
    }
    Err((keyword.name().into(), format!("{refs} references for {entities} entities; give each one reference")))
}

fn check_elements<const N: usize>(keyword: Keyword, elements: &Elements<N>, vertices: usize) -> Result<(), Fault> {
    check_length(keyword, elements.refs.len(), elements.nodes.len())?;
    match elements.nodes.iter().position(|nodes| nodes.iter().any(|&v| v as usize >= vertices)) {
        None => Ok(()),
        Some(k) => Err(out_of_range(keyword, k, vertices)),
    }
}

fn check_indices<'a>(keyword: Keyword, indices: impl IntoIterator<Item = &'a u32>, limit: usize) -> Result<(), Fault> {
    match indices.into_iter().position(|&index| index as usize >= limit) {
        None => Ok(()),
        Some(k) => Err(out_of_range(keyword, k, limit)),
    }
}

fn out_of_range(keyword: Keyword, position: usize, limit: usize) -> Fault {
    let message = format!("an index is out of range: {limit} are there, counted from 0; nothing is written");
    (format!("{} {}", keyword.name(), position + 1), message)
}

fn check_finite(keyword: Keyword, rows: impl IntoIterator<Item = impl AsRef<[f64]>>) -> Result<(), Fault> {
    match rows.into_iter().position(|row| !row.as_ref().iter().all(|x| x.is_finite())) {
        None => Ok(()),
        Some(k) => {
            let message = "a value is not a finite number; nothing is written".into();
            Err((format!("{} {}", keyword.name(), k + 1), message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::read::{mesh_from, solution_from};
    use super::*;
    use crate::mesh::OnFace;

    /// Versions 3 and 4 are chosen for files that are too big for a test; what they look like is tested here.
    #[test]
    fn every_version_that_is_written_reads_back() {
        let mut mesh =
            TetMesh { vertices: vec![[0.1, -2.5e-300, 7.0]; 4], vertex_refs: vec![-1; 4], ..Default::default() };
        mesh.tets.push([3, 1, 0, 2], i32::MIN);
        mesh.association.faces.push(OnFace { vertex: 3, id: 2, uv: [0.5, 0.25], r: 1.0 });
        let solution = Solution::metric(&[[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]; 3]);
        for (version, position, int) in [(2, 4, 4), (3, 8, 4), (4, 8, 8)] {
            let mut bytes = Vec::new();
            write_sections(&mut bytes, true, version, &mesh_sections(&mesh), &Content::Mesh(&mesh)).unwrap();
            let rows = 4 * (24 + int) + 5 * int + 2 * int + 24;
            assert_eq!(bytes.len(), 8 + 5 * (4 + position) + 4 + 3 * int + rows, "version {version}");
            assert_eq!(mesh_from(Team::alone(), Path::new("m"), &bytes).unwrap().content, mesh);
            let (sections, content) = (solution_sections(&solution), Content::Solution(Team::alone(), &solution));
            let mut bytes = Vec::new();
            write_sections(&mut bytes, true, version, &sections, &content).unwrap();
            assert_eq!(solution_from(Team::alone(), Path::new("s"), &bytes).unwrap().content, solution);
        }
    }
}
