//! The sections of a mesh or a solution, and their rows value by value.
use super::keyword::Keyword;
use super::sink::Sink;
use super::source::Section;
use super::{Solution, SolutionField};
use crate::mesh::{Elements, TetMesh};
use std::ops::Range;

/// What is written.
pub(super) enum Content<'a> {
    Mesh(&'a TetMesh),
    Solution(&'a Solution),
}

impl Content<'_> {
    /// Gives the sink some rows of a keyword.
    pub(super) fn rows(&self, keyword: Keyword, rows: Range<usize>, sink: &mut impl Sink) {
        match self {
            Content::Mesh(mesh) => mesh_rows(mesh, keyword, rows, sink),
            Content::Solution(solution) => solution_rows(solution, rows, sink),
        }
    }
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

fn mesh_rows(mesh: &TetMesh, keyword: Keyword, rows: Range<usize>, sink: &mut impl Sink) {
    let on = &mesh.association;
    match keyword {
        Keyword::Vertices => {
            for (x, &reference) in mesh.vertices[rows.clone()].iter().zip(&mesh.vertex_refs[rows]) {
                x.iter().for_each(|&x| sink.real(x));
                sink.int(reference.into());
                sink.end_row();
            }
        }
        Keyword::Edges => element_rows(&mesh.edges, rows, sink),
        Keyword::Triangles => element_rows(&mesh.triangles, rows, sink),
        Keyword::Tetrahedra => element_rows(&mesh.tets, rows, sink),
        Keyword::Corners => index_rows(&mesh.corners[rows], sink),
        Keyword::Ridges => index_rows(&mesh.ridges[rows], sink),
        Keyword::RequiredVertices => index_rows(&mesh.required_vertices[rows], sink),
        Keyword::RequiredEdges => index_rows(&mesh.required_edges[rows], sink),
        Keyword::RequiredTriangles => index_rows(&mesh.required_triangles[rows], sink),
        Keyword::OnVertices => on.vertices[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [], sink)),
        Keyword::OnEdges => on.edges[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [v.t, v.r], sink)),
        Keyword::OnFaces => {
            on.faces[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [v.uv[0], v.uv[1], v.r], sink));
        }
        Keyword::SolAtVertices => {}
    }
}

fn element_rows<const N: usize>(elements: &Elements<N>, rows: Range<usize>, sink: &mut impl Sink) {
    for (nodes, &reference) in elements.nodes[rows.clone()].iter().zip(&elements.refs[rows]) {
        nodes.iter().for_each(|&node| sink.int(i64::from(node) + 1));
        sink.int(reference.into());
        sink.end_row();
    }
}

fn index_rows(indices: &[u32], sink: &mut impl Sink) {
    for &index in indices {
        sink.int(i64::from(index) + 1);
        sink.end_row();
    }
}

fn associated_row<const N: usize>(vertex: u32, id: i32, reals: [f64; N], sink: &mut impl Sink) {
    sink.int(i64::from(vertex) + 1);
    sink.int(id.into());
    reals.into_iter().for_each(|x| sink.real(x));
    sink.end_row();
}

fn solution_rows(solution: &Solution, rows: Range<usize>, sink: &mut impl Sink) {
    for vertex in rows {
        for SolutionField { kind, values } in &solution.fields {
            values[vertex * kind.values()..][..kind.values()].iter().for_each(|&x| sink.real(x));
        }
        sink.end_row();
    }
}
