//! The sections of a mesh or a solution, and their rows value by value.
use super::Solution;
use super::keyword::Keyword;
use super::sink::Sink;
use super::source::Section;
use crate::mesh::stack::{Cell, Kind, Stack};
use crate::mesh::vector::Vec3;
use crate::mesh::{OnEdge, OnFace, OnVertex, TetMesh};
use std::ops::Range;

/// Some rows of one section, to be written. Indices count from 0 in the whole mesh, not in the slice.
#[derive(Clone, Copy, Debug)]
pub enum Slice<'a> {
    /// Coordinates, shape (n, 3), and references, shape (n,), of vertices.
    Vertices(&'a [Vec3], &'a [i32]),
    /// Nodes, shape (n, 2), and references, shape (n,), of tagged edges.
    Edges(&'a [[u32; 2]], &'a [i32]),
    /// Nodes, shape (n, 3), and references, shape (n,), of triangles.
    Triangles(&'a [[u32; 3]], &'a [i32]),
    /// Nodes, shape (n, 4), and references, shape (n,), of tetrahedra.
    Tets(&'a [[u32; 4]], &'a [i32]),
    /// Nodes, shape (n, 4), and references, shape (n,), of quadrilaterals.
    Quads(&'a [[u32; 4]], &'a [i32]),
    /// The cells of a kind: the cells of a stack, and the numbers of these among them, shape (n,).
    Cells(Kind, &'a [Cell], &'a [u32]),
    /// Vertices that are corners, shape (n,).
    Corners(&'a [u32]),
    /// Edges that are ridges, shape (n,).
    Ridges(&'a [u32]),
    /// Vertices that must stay, shape (n,).
    RequiredVertices(&'a [u32]),
    /// Edges that must stay, shape (n,).
    RequiredEdges(&'a [u32]),
    /// Triangles that must stay, shape (n,).
    RequiredTriangles(&'a [u32]),
    /// Vertices on vertices of the model, shape (n,).
    OnVertices(&'a [OnVertex]),
    /// Vertices on edges of the model, shape (n,).
    OnEdges(&'a [OnEdge]),
    /// Vertices on faces of the model, shape (n,).
    OnFaces(&'a [OnFace]),
    /// Symmetric tensors at vertices, shape (n, 6), each 11 12 22 13 23 33.
    Tensors(&'a [[f64; 6]]),
    /// All fields at vertices: so many values a vertex, and rows of these, shape (n, width).
    Fields(usize, &'a [f64]),
}

impl<'a> Slice<'a> {
    /// All rows of a keyword; none of one that a mesh has not.
    pub(super) fn of(mesh: &'a TetMesh, keyword: Keyword) -> Option<Self> {
        let on = &mesh.association;
        Some(match keyword {
            Keyword::Vertices => Self::Vertices(&mesh.vertices, &mesh.vertex_refs),
            Keyword::Edges => Self::Edges(&mesh.edges.nodes, &mesh.edges.refs),
            Keyword::Triangles => Self::Triangles(&mesh.triangles.nodes, &mesh.triangles.refs),
            Keyword::Tetrahedra => Self::Tets(&mesh.tets.nodes, &mesh.tets.refs),
            Keyword::Corners => Self::Corners(&mesh.corners),
            Keyword::Ridges => Self::Ridges(&mesh.ridges),
            Keyword::RequiredVertices => Self::RequiredVertices(&mesh.required_vertices),
            Keyword::RequiredEdges => Self::RequiredEdges(&mesh.required_edges),
            Keyword::RequiredTriangles => Self::RequiredTriangles(&mesh.required_triangles),
            Keyword::OnVertices => Self::OnVertices(&on.vertices),
            Keyword::OnEdges => Self::OnEdges(&on.edges),
            Keyword::OnFaces => Self::OnFaces(&on.faces),
            Keyword::Quadrilaterals
            | Keyword::Pyramids
            | Keyword::Prisms
            | Keyword::Hexahedra
            | Keyword::SolAtVertices => return None,
        })
    }

    /// Its keyword.
    pub(super) fn keyword(&self) -> Keyword {
        match self {
            Self::Vertices(..) => Keyword::Vertices,
            Self::Edges(..) => Keyword::Edges,
            Self::Triangles(..) => Keyword::Triangles,
            Self::Tets(..) => Keyword::Tetrahedra,
            Self::Quads(..) => Keyword::Quadrilaterals,
            Self::Cells(Kind::Pyramid, ..) => Keyword::Pyramids,
            Self::Cells(Kind::Prism, ..) => Keyword::Prisms,
            Self::Cells(Kind::Hexahedron, ..) => Keyword::Hexahedra,
            Self::Corners(_) => Keyword::Corners,
            Self::Ridges(_) => Keyword::Ridges,
            Self::RequiredVertices(_) => Keyword::RequiredVertices,
            Self::RequiredEdges(_) => Keyword::RequiredEdges,
            Self::RequiredTriangles(_) => Keyword::RequiredTriangles,
            Self::OnVertices(_) => Keyword::OnVertices,
            Self::OnEdges(_) => Keyword::OnEdges,
            Self::OnFaces(_) => Keyword::OnFaces,
            Self::Tensors(_) | Self::Fields(..) => Keyword::SolAtVertices,
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Vertices(points, _) => points.len(),
            Self::Edges(nodes, _) => nodes.len(),
            Self::Triangles(nodes, _) => nodes.len(),
            Self::Tets(nodes, _) | Self::Quads(nodes, _) => nodes.len(),
            Self::Cells(_, _, numbers) => numbers.len(),
            Self::Corners(indices)
            | Self::Ridges(indices)
            | Self::RequiredVertices(indices)
            | Self::RequiredEdges(indices)
            | Self::RequiredTriangles(indices) => indices.len(),
            Self::OnVertices(on) => on.len(),
            Self::OnEdges(on) => on.len(),
            Self::OnFaces(on) => on.len(),
            Self::Tensors(tensors) => tensors.len(),
            Self::Fields(width, values) => values.len().checked_div(*width).unwrap_or(0),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Gives the sink some of the rows.
    pub(super) fn write(&self, rows: Range<usize>, sink: &mut impl Sink) {
        match *self {
            Self::Vertices(points, refs) => {
                for (x, &reference) in points[rows.clone()].iter().zip(&refs[rows]) {
                    x.iter().for_each(|&x| sink.real(x));
                    sink.int(reference.into());
                    sink.end_row();
                }
            }
            Self::Edges(nodes, refs) => element_rows(&nodes[rows.clone()], &refs[rows], sink),
            Self::Triangles(nodes, refs) => element_rows(&nodes[rows.clone()], &refs[rows], sink),
            Self::Tets(nodes, refs) | Self::Quads(nodes, refs) => {
                element_rows(&nodes[rows.clone()], &refs[rows], sink);
            }
            Self::Cells(_, cells, numbers) => {
                let cells = numbers[rows].iter().map(|&number| &cells[number as usize]);
                cells.for_each(|cell| element_row(cell.nodes(), cell.reference, sink));
            }
            Self::Corners(indices)
            | Self::Ridges(indices)
            | Self::RequiredVertices(indices)
            | Self::RequiredEdges(indices)
            | Self::RequiredTriangles(indices) => index_rows(&indices[rows], sink),
            Self::OnVertices(on) => on[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [], sink)),
            Self::OnEdges(on) => on[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [v.t, v.r], sink)),
            Self::OnFaces(on) => {
                on[rows].iter().for_each(|v| associated_row(v.vertex, v.id, [v.uv[0], v.uv[1], v.r], sink));
            }
            Self::Tensors(tensors) => field_rows(&[(6, tensors.as_flattened())], rows, sink),
            Self::Fields(width, values) => field_rows(&[(width, values)], rows, sink),
        }
    }
}

/// A mesh without what was cut out of its stack, and the stack: what a file holds.
pub(super) struct Whole<'a> {
    mesh: &'a TetMesh,
    stack: &'a Stack,
    /// The numbers of the cells of each kind, in the order of [`Kind::ALL`].
    numbers: [Vec<u32>; 3],
}

impl<'a> Whole<'a> {
    pub(super) fn of(mesh: &'a TetMesh, stack: &'a Stack) -> Self {
        let of_kind =
            |kind| (0..).zip(&stack.cells).filter(move |(_, cell)| cell.kind == kind).map(|(number, _)| number);
        Self { mesh, stack, numbers: Kind::ALL.map(|kind| of_kind(kind).collect()) }
    }

    /// All rows of a keyword; none of one that a mesh has not.
    pub(super) fn slice(&self, keyword: Keyword) -> Option<Slice<'_>> {
        let Stack { cells, quads, .. } = self.stack;
        match (keyword, keyword.kind()) {
            (Keyword::Quadrilaterals, _) => Some(Slice::Quads(&quads.nodes, &quads.refs)),
            (_, None) => Slice::of(self.mesh, keyword),
            (_, Some(kind)) => {
                let at = Kind::ALL.iter().position(|other| *other == kind)?;
                Some(Slice::Cells(kind, cells, &self.numbers[at]))
            }
        }
    }

    /// Its sections, empty ones left out.
    pub(super) fn sections(&self) -> Vec<Section> {
        sections(|keyword| self.slice(keyword).map_or(0, |slice| slice.len()))
    }
}

/// What is written.
pub(super) enum Content<'a> {
    Mesh(Whole<'a>),
    Solution(&'a Solution),
}

impl Content<'_> {
    /// Gives the sink some rows of a keyword.
    pub(super) fn rows(&self, keyword: Keyword, rows: Range<usize>, sink: &mut impl Sink) {
        match self {
            Content::Mesh(whole) => {
                if let Some(slice) = whole.slice(keyword) {
                    slice.write(rows, sink);
                }
            }
            Content::Solution(solution) => {
                let fields: Vec<_> = solution.fields.iter().map(|f| (f.kind.values(), &f.values[..])).collect();
                field_rows(&fields, rows, sink);
            }
        }
    }
}

/// Sections with so many rows, empty ones left out.
pub(super) fn sections(count: impl Fn(Keyword) -> usize) -> Vec<Section> {
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

fn element_rows<const N: usize>(nodes: &[[u32; N]], refs: &[i32], sink: &mut impl Sink) {
    nodes.iter().zip(refs).for_each(|(nodes, &reference)| element_row(nodes, reference, sink));
}

#[inline(always)]
fn element_row(nodes: &[u32], reference: i32, sink: &mut impl Sink) {
    nodes.iter().for_each(|&node| sink.int(i64::from(node) + 1));
    sink.int(reference.into());
    sink.end_row();
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

/// Rows of fields, each with its number of values at a vertex.
fn field_rows(fields: &[(usize, &[f64])], rows: Range<usize>, sink: &mut impl Sink) {
    for vertex in rows {
        for &(width, values) in fields {
            values[vertex * width..][..width].iter().for_each(|&x| sink.real(x));
        }
        sink.end_row();
    }
}
