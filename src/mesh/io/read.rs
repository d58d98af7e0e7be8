//! From a file's sections to a mesh or a solution; the same for texts and binary files.
use super::ascii::AsciiCursor;
use super::binary::BinaryCursor;
use super::cursor::{Cursor, Fault, columns, room, rows};
use super::keyword::Keyword;
use super::source::{Contents, Encoding, Section, Source};
use super::{Error, Read, Solution, SolutionField};
use crate::mesh::stack::{Cell, Kind, Stack};
use crate::mesh::vector::Vec3;
use crate::mesh::{Association, Elements, OnEdge, OnFace, OnVertex, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

/// A mesh from the bytes of a file, with its stack joined to it.
pub(super) fn mesh_from(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<(TetMesh, Stack)>, Error> {
    let contents = Contents::of(path, bytes)?;
    check_mesh(&contents)?;
    let (mut mesh, mut stack) = match contents.source.encoding {
        Encoding::Ascii => mesh::<AsciiCursor>(team, &contents)?,
        Encoding::Binary(_) => mesh::<BinaryCursor>(team, &contents)?,
    };
    let mut notices = mesh_notices(contents);
    join_stack(path, &mut mesh, &mut stack, &mut notices)?;
    Ok(Read { content: (mesh, stack), notices })
}

/// Joins a stack to the mesh that was read with it. A notice may be added.
///
/// # Errors
/// [`Error::Content`] where they do not fit together.
pub fn join_stack(path: &Path, mesh: &mut TetMesh, stack: &mut Stack, notices: &mut Vec<String>) -> Result<(), Error> {
    let told = stack.join(mesh).map_err(|error| Error::content(path, error.place(), error.to_string()))?;
    notices.extend(told.map(|told| format!("{}: {told}", path.display())));
    Ok(())
}

/// A mesh has vertices, and no more than indices can count.
pub(super) fn check_mesh(contents: &Contents<'_>) -> Result<(), Error> {
    let path = contents.source.path;
    let Some(vertices) = contents.section(Keyword::Vertices).filter(|s| s.count > 0) else {
        let message = "no Vertices: a mesh is expected (a solution file is none)";
        return Err(Error::content(path, "whole file", message));
    };
    if room(vertices) > u32::MAX as usize {
        let message = format!("{} vertices; at most {} are supported", vertices.count, u32::MAX);
        return Err(Error::content(path, "Vertices", message));
    }
    Ok(())
}

/// What is passed over in a mesh file.
pub(super) fn mesh_notices(contents: Contents<'_>) -> Vec<String> {
    let Contents { source, sections, mut notices } = contents;
    let solutions = sections.iter().filter(|s| s.keyword == Keyword::SolAtVertices);
    notices.extend(solutions.map(|section| source.notice(section.body.start, "SolAtVertices in a mesh file")));
    notices
}

/// A solution from the bytes of a file.
pub(super) fn solution_from(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<Solution>, Error> {
    let contents = Contents::of(path, bytes)?;
    let section = solution_section(&contents)?;
    let content = match contents.source.encoding {
        Encoding::Ascii => solution::<AsciiCursor>(&contents.source, section)?,
        Encoding::Binary(_) => binary_solution(team, &contents.source, section)?,
    };
    Ok(Read { content, notices: solution_notices(contents) })
}

/// The section of a solution file.
pub(super) fn solution_section<'c>(contents: &'c Contents<'_>) -> Result<&'c Section, Error> {
    contents.section(Keyword::SolAtVertices).ok_or_else(|| {
        let message = "no SolAtVertices: a solution with values at vertices is expected (a mesh file is none)";
        Error::content(contents.source.path, "whole file", message)
    })
}

/// What is passed over in a solution file.
pub(super) fn solution_notices(contents: Contents<'_>) -> Vec<String> {
    let Contents { source, sections, mut notices } = contents;
    notices.extend(
        sections.iter().filter(|s| s.keyword != Keyword::SolAtVertices).map(|section| {
            source.notice(section.body.start, &format!("{} in a solution file", section.keyword.name()))
        }),
    );
    notices
}

fn mesh<'a, C: Cursor<'a>>(team: Team<'_>, contents: &Contents<'a>) -> Result<(TetMesh, Stack), Error> {
    let source = &contents.source;
    let vertices = contents.count(Keyword::Vertices);
    let (mut mesh, mut stack) = (TetMesh::default(), Stack::default());
    for section in &contents.sections {
        let list = || indices::<C>(source, section, contents.count(section.keyword.target()));
        match section.keyword {
            Keyword::Vertices => {
                (mesh.vertices, mesh.vertex_refs) = columns(team, source, section, ([0.0; 3], 0), vertex::<C>)?;
            }
            Keyword::Edges => mesh.edges = elements::<C, 2>(team, source, section, vertices)?,
            Keyword::Triangles => mesh.triangles = elements::<C, 3>(team, source, section, vertices)?,
            Keyword::Tetrahedra => mesh.tets = elements::<C, 4>(team, source, section, vertices)?,
            Keyword::Quadrilaterals => stack.quads = elements::<C, 4>(team, source, section, vertices)?,
            Keyword::Pyramids => {
                push(&mut stack, Kind::Pyramid, elements::<C, 5>(team, source, section, vertices)?);
            }
            Keyword::Prisms => push(&mut stack, Kind::Prism, elements::<C, 6>(team, source, section, vertices)?),
            Keyword::Hexahedra => {
                push(&mut stack, Kind::Hexahedron, elements::<C, 8>(team, source, section, vertices)?);
            }
            Keyword::Corners => mesh.corners = list()?,
            Keyword::Ridges => mesh.ridges = list()?,
            Keyword::RequiredVertices => mesh.required_vertices = list()?,
            Keyword::RequiredEdges => mesh.required_edges = list()?,
            Keyword::RequiredTriangles => mesh.required_triangles = list()?,
            Keyword::OnVertices | Keyword::OnEdges | Keyword::OnFaces => {
                association::<C>(source, section, vertices, &mut mesh.association)?;
            }
            Keyword::SolAtVertices => {}
        }
    }
    Ok((mesh, stack))
}

/// Adds cells to a stack.
fn push<const N: usize>(stack: &mut Stack, kind: Kind, cells: Elements<N>) {
    stack.cells.extend(cells.iter().map(|(nodes, reference)| Cell::new(kind, &nodes, reference)));
}

/// A row of Vertices.
#[inline(always)]
pub(super) fn vertex<'a, C: Cursor<'a>>(row: &mut C) -> Result<(Vec3, i32), String> {
    Ok((row.reals()?, row.reference()?))
}

/// A row of elements of a mesh of so many vertices.
#[inline(always)]
pub(super) fn element<'a, C: Cursor<'a>, const N: usize>(
    row: &mut C,
    vertices: usize,
) -> Result<([u32; N], i32), String> {
    let mut nodes = [0; N];
    for node in &mut nodes {
        *node = row.index(vertices, Keyword::Vertices)?;
    }
    Ok((nodes, row.reference()?))
}

fn elements<'a, C: Cursor<'a>, const N: usize>(
    team: Team<'_>,
    source: &Source<'a>,
    section: &Section,
    vertices: usize,
) -> Result<Elements<N>, Error> {
    let (nodes, refs) = columns(team, source, section, ([0; N], 0), |row: &mut C| element(row, vertices))?;
    Ok(Elements { nodes, refs })
}

/// A list of indices into so many entities.
pub(super) fn indices<'a, C: Cursor<'a>>(
    source: &Source<'a>,
    section: &Section,
    limit: usize,
) -> Result<Vec<u32>, Error> {
    let mut indices = Vec::with_capacity(room(section));
    rows::<C>(source, section, |row| {
        indices.push(row.index(limit, section.keyword.target())?);
        Ok(())
    })?;
    Ok(indices)
}

/// One of the three lists of an association.
pub(super) fn association<'a, C: Cursor<'a>>(
    source: &Source<'a>,
    section: &Section,
    vertices: usize,
    to: &mut Association,
) -> Result<(), Error> {
    rows::<C>(source, section, |row| {
        let vertex = row.index(vertices, Keyword::Vertices)?;
        let id = row.reference()?;
        match section.keyword {
            Keyword::OnVertices => to.vertices.push(OnVertex { vertex, id }),
            Keyword::OnEdges => {
                let [t, r] = row.reals()?;
                to.edges.push(OnEdge { vertex, id, t, r });
            }
            _ => {
                let [u, v, r] = row.reals()?;
                to.faces.push(OnFace { vertex, id, uv: [u, v], r });
            }
        }
        Ok(())
    })
}

fn solution<'a, C: Cursor<'a>>(source: &Source<'a>, section: &Section) -> Result<Solution, Error> {
    let mut fields: Vec<_> = section
        .kinds
        .iter()
        .map(|&kind| SolutionField { kind, values: Vec::with_capacity(kind.values() * room(section)) })
        .collect();
    rows::<C>(source, section, |row| {
        for field in &mut fields {
            for _ in 0..field.kind.values() {
                field.values.push(row.real()?);
            }
        }
        Ok(())
    })?;
    Ok(Solution { vertices: section.count, fields })
}

/// As [`solution`], field by field on all threads.
fn binary_solution(team: Team<'_>, source: &Source<'_>, section: &Section) -> Result<Solution, Error> {
    let width: usize = section.kinds.iter().map(|kind| kind.values()).sum();
    let (mut fields, mut before, fault) = (Vec::with_capacity(section.kinds.len()), 0, Fault::default());
    for &kind in &section.kinds {
        let own = kind.values();
        let mut values = vec![0.0; own * section.count];
        team.fill(GRAIN * own, &mut values, |start, values| {
            let range = start / own..(start + values.len()) / own;
            fault.in_rows::<BinaryCursor>(source, section, range, |row, place| {
                row.skip_reals(before);
                for value in &mut values[own * place..own * (place + 1)] {
                    *value = row.real()?;
                }
                row.skip_reals(width - before - own);
                Ok(())
            });
        });
        fields.push(SolutionField { kind, values });
        before += own;
    }
    fault.result(source, section).map(|()| Solution { vertices: section.count, fields })
}
