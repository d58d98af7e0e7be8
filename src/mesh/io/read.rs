//! From a file's sections to a mesh or a solution; the same for texts and binary files.
use super::ascii::AsciiCursor;
use super::binary::BinaryCursor;
use super::cursor::{Cursor, Fault, columns, room, rows};
use super::keyword::Keyword;
use super::source::{Contents, Encoding, Section, Source};
use super::{Error, Read, Solution, SolutionField};
use crate::mesh::{Elements, OnEdge, OnFace, OnVertex, TetMesh};
use crate::tasks::{GRAIN, Team};
use std::path::Path;

/// A mesh from the bytes of a file.
pub(super) fn mesh_from(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<TetMesh>, Error> {
    let contents = Contents::of(path, bytes)?;
    let Some(vertices) = contents.section(Keyword::Vertices).filter(|s| s.count > 0) else {
        let message = "no Vertices: a mesh is expected (a solution file is none)";
        return Err(Error::content(path, "whole file", message));
    };
    if room(vertices) > u32::MAX as usize {
        let message = format!("{} vertices; at most {} are supported", vertices.count, u32::MAX);
        return Err(Error::content(path, "Vertices", message));
    }
    let content = match contents.source.encoding {
        Encoding::Ascii => mesh::<AsciiCursor>(team, &contents)?,
        Encoding::Binary(_) => mesh::<BinaryCursor>(team, &contents)?,
    };
    let mut notices = contents.notices;
    notices.extend(
        contents
            .sections
            .iter()
            .filter(|s| s.keyword == Keyword::SolAtVertices)
            .map(|section| contents.source.notice(section.body.start, "SolAtVertices in a mesh file")),
    );
    Ok(Read { content, notices })
}

/// A solution from the bytes of a file.
pub(super) fn solution_from(team: Team<'_>, path: &Path, bytes: &[u8]) -> Result<Read<Solution>, Error> {
    let contents = Contents::of(path, bytes)?;
    let Some(section) = contents.section(Keyword::SolAtVertices) else {
        let message = "no SolAtVertices: a solution with values at vertices is expected (a mesh file is none)";
        return Err(Error::content(path, "whole file", message));
    };
    let content = match contents.source.encoding {
        Encoding::Ascii => solution::<AsciiCursor>(&contents.source, section)?,
        Encoding::Binary(_) => binary_solution(team, &contents.source, section)?,
    };
    let mut notices = contents.notices;
    notices.extend(contents.sections.iter().filter(|s| s.keyword != Keyword::SolAtVertices).map(|section| {
        contents.source.notice(section.body.start, &format!("{} in a solution file", section.keyword.name()))
    }));
    Ok(Read { content, notices })
}

fn mesh<'a, C: Cursor<'a>>(team: Team<'_>, contents: &Contents<'a>) -> Result<TetMesh, Error> {
    let source = &contents.source;
    let mut mesh = TetMesh::default();
    for section in &contents.sections {
        match section.keyword {
            Keyword::Vertices => {
                let row = |row: &mut C| Ok((row.reals()?, row.reference()?));
                (mesh.vertices, mesh.vertex_refs) = columns(team, source, section, ([0.0; 3], 0), row)?;
            }
            Keyword::Edges => mesh.edges = elements::<C, 2>(team, contents, section)?,
            Keyword::Triangles => mesh.triangles = elements::<C, 3>(team, contents, section)?,
            Keyword::Tetrahedra => mesh.tets = elements::<C, 4>(team, contents, section)?,
            Keyword::Corners => mesh.corners = indices::<C>(contents, section, Keyword::Vertices)?,
            Keyword::Ridges => mesh.ridges = indices::<C>(contents, section, Keyword::Edges)?,
            Keyword::RequiredVertices => mesh.required_vertices = indices::<C>(contents, section, Keyword::Vertices)?,
            Keyword::RequiredEdges => mesh.required_edges = indices::<C>(contents, section, Keyword::Edges)?,
            Keyword::RequiredTriangles => {
                mesh.required_triangles = indices::<C>(contents, section, Keyword::Triangles)?;
            }
            Keyword::OnVertices | Keyword::OnEdges | Keyword::OnFaces => {
                association::<C>(contents, section, &mut mesh)?;
            }
            Keyword::SolAtVertices => {}
        }
    }
    Ok(mesh)
}

fn elements<'a, C: Cursor<'a>, const N: usize>(
    team: Team<'_>,
    contents: &Contents<'a>,
    section: &Section,
) -> Result<Elements<N>, Error> {
    let vertices = contents.count(Keyword::Vertices);
    let row = |row: &mut C| {
        let mut nodes = [0; N];
        for node in &mut nodes {
            *node = row.index(vertices, Keyword::Vertices)?;
        }
        Ok((nodes, row.reference()?))
    };
    let (nodes, refs) = columns(team, &contents.source, section, ([0; N], 0), row)?;
    Ok(Elements { nodes, refs })
}

fn indices<'a, C: Cursor<'a>>(contents: &Contents<'a>, section: &Section, of: Keyword) -> Result<Vec<u32>, Error> {
    let limit = contents.count(of);
    let mut indices = Vec::with_capacity(room(section));
    rows::<C>(&contents.source, section, |row| {
        indices.push(row.index(limit, of)?);
        Ok(())
    })?;
    Ok(indices)
}

fn association<'a, C: Cursor<'a>>(contents: &Contents<'a>, section: &Section, mesh: &mut TetMesh) -> Result<(), Error> {
    let vertices = contents.count(Keyword::Vertices);
    let to = &mut mesh.association;
    rows::<C>(&contents.source, section, |row| {
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
