//! How many rows each section of a mesh has.
use super::keyword::Keyword;
use super::rows::Slice;
use crate::mesh::TetMesh;

/// Numbers of the entities of a mesh without a stack and of its lists, as a file has them. Sections without rows are left out of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct MeshCounts {
    /// Vertices, at most `u32::MAX`.
    pub vertices: usize,
    /// Tagged edges.
    pub edges: usize,
    /// Triangles.
    pub triangles: usize,
    /// Tetrahedra; may be more than 32 bits count.
    pub tets: usize,
    /// Corners.
    pub corners: usize,
    /// Ridges.
    pub ridges: usize,
    /// Vertices that must stay.
    pub required_vertices: usize,
    /// Edges that must stay.
    pub required_edges: usize,
    /// Triangles that must stay.
    pub required_triangles: usize,
    /// Vertices on vertices of the model.
    pub on_vertices: usize,
    /// Vertices on edges of the model.
    pub on_edges: usize,
    /// Vertices on faces of the model.
    pub on_faces: usize,
}

impl MeshCounts {
    /// Those of a mesh in memory.
    pub fn of(mesh: &TetMesh) -> Self {
        Self::from_each(|keyword| Slice::of(mesh, keyword).map_or(0, |slice| slice.len()))
    }

    /// What `count` says of each keyword.
    pub(super) fn from_each(count: impl Fn(Keyword) -> usize) -> Self {
        Self {
            vertices: count(Keyword::Vertices),
            edges: count(Keyword::Edges),
            triangles: count(Keyword::Triangles),
            tets: count(Keyword::Tetrahedra),
            corners: count(Keyword::Corners),
            ridges: count(Keyword::Ridges),
            required_vertices: count(Keyword::RequiredVertices),
            required_edges: count(Keyword::RequiredEdges),
            required_triangles: count(Keyword::RequiredTriangles),
            on_vertices: count(Keyword::OnVertices),
            on_edges: count(Keyword::OnEdges),
            on_faces: count(Keyword::OnFaces),
        }
    }

    /// Rows of a keyword.
    pub(super) fn rows(&self, keyword: Keyword) -> usize {
        match keyword {
            Keyword::Vertices => self.vertices,
            Keyword::Edges => self.edges,
            Keyword::Triangles => self.triangles,
            Keyword::Tetrahedra => self.tets,
            Keyword::Corners => self.corners,
            Keyword::Ridges => self.ridges,
            Keyword::RequiredVertices => self.required_vertices,
            Keyword::RequiredEdges => self.required_edges,
            Keyword::RequiredTriangles => self.required_triangles,
            Keyword::OnVertices => self.on_vertices,
            Keyword::OnEdges => self.on_edges,
            Keyword::OnFaces => self.on_faces,
            Keyword::Quadrilaterals
            | Keyword::Pyramids
            | Keyword::Prisms
            | Keyword::Hexahedra
            | Keyword::SolAtVertices => 0,
        }
    }
}
