//! The keywords of libMeshb files: name in ASCII, code in binary, values a row.
//! Source: the enumeration and the format table of libMeshb 7 (Maréchal, INRIA).
use crate::mesh::stack::Kind;

/// A keyword whose entities are read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Vertices,
    Edges,
    Triangles,
    Quadrilaterals,
    Tetrahedra,
    Pyramids,
    Prisms,
    Hexahedra,
    Corners,
    Ridges,
    RequiredVertices,
    RequiredEdges,
    RequiredTriangles,
    OnVertices,
    OnEdges,
    OnFaces,
    SolAtVertices,
}

/// Code of `Dimension`.
pub(super) const DIMENSION: i32 = 3;
/// Code of `End`.
pub(super) const END: i32 = 54;
/// Code of `FloatingPointPrecision`: 32 or 64, whatever the version says.
pub(super) const PRECISION: i32 = 155;

impl Keyword {
    /// All of them, in the order in which they are written.
    pub(super) const ALL: [Self; 17] = [
        Self::Vertices,
        Self::Edges,
        Self::Triangles,
        Self::Quadrilaterals,
        Self::Tetrahedra,
        Self::Pyramids,
        Self::Prisms,
        Self::Hexahedra,
        Self::Corners,
        Self::Ridges,
        Self::RequiredVertices,
        Self::RequiredEdges,
        Self::RequiredTriangles,
        Self::OnVertices,
        Self::OnEdges,
        Self::OnFaces,
        Self::SolAtVertices,
    ];

    /// Code in binary files and name in ASCII files.
    fn identity(self) -> (i32, &'static str) {
        match self {
            Self::Vertices => (4, "Vertices"),
            Self::Edges => (5, "Edges"),
            Self::Triangles => (6, "Triangles"),
            Self::Quadrilaterals => (7, "Quadrilaterals"),
            Self::Tetrahedra => (8, "Tetrahedra"),
            Self::Pyramids => (49, "Pyramids"),
            Self::Prisms => (9, "Prisms"),
            Self::Hexahedra => (10, "Hexahedra"),
            Self::Corners => (13, "Corners"),
            Self::Ridges => (14, "Ridges"),
            Self::RequiredVertices => (15, "RequiredVertices"),
            Self::RequiredEdges => (16, "RequiredEdges"),
            Self::RequiredTriangles => (17, "RequiredTriangles"),
            Self::OnVertices => (40, "VerticesOnGeometricVertices"),
            Self::OnEdges => (41, "VerticesOnGeometricEdges"),
            Self::OnFaces => (42, "VerticesOnGeometricTriangles"),
            Self::SolAtVertices => (62, "SolAtVertices"),
        }
    }

    /// Code in binary files.
    pub(super) fn code(self) -> i32 {
        self.identity().0
    }

    /// Name in ASCII files.
    pub(super) fn name(self) -> &'static str {
        self.identity().1
    }

    /// The keyword of a code, if it is one of ours.
    pub(super) fn from_code(code: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.code() == code)
    }

    /// The keyword of a name, if it is one of ours.
    pub(super) fn from_name(name: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.name().as_bytes() == name)
    }

    /// What the indices of its rows count; of vertices and solutions, which have none, vertices.
    pub(super) fn target(self) -> Self {
        match self {
            Self::Ridges | Self::RequiredEdges => Self::Edges,
            Self::RequiredTriangles => Self::Triangles,
            _ => Self::Vertices,
        }
    }

    /// The cells of its rows, where they are no tetrahedra.
    pub(super) fn kind(self) -> Option<Kind> {
        match self {
            Self::Pyramids => Some(Kind::Pyramid),
            Self::Prisms => Some(Kind::Prism),
            Self::Hexahedra => Some(Kind::Hexahedron),
            _ => None,
        }
    }

    /// Numbers of integers and reals in a row; a solution's reals follow from its header.
    pub(super) fn row(self) -> (usize, usize) {
        match self {
            Self::Vertices => (1, 3),
            Self::Edges => (3, 0),
            Self::Triangles => (4, 0),
            Self::Quadrilaterals | Self::Tetrahedra => (5, 0),
            Self::Pyramids => (6, 0),
            Self::Prisms => (7, 0),
            Self::Hexahedra => (9, 0),
            Self::Corners | Self::Ridges | Self::RequiredVertices | Self::RequiredEdges | Self::RequiredTriangles => {
                (1, 0)
            }
            Self::OnVertices => (2, 0),
            Self::OnEdges => (2, 2),
            Self::OnFaces => (2, 3),
            Self::SolAtVertices => (0, 0),
        }
    }
}

/// Names of keywords that are passed over, for the notice about a binary file, which has only codes.
const PASSED_OVER: [(i32, &str); 25] = [
    (18, "RequiredQuadrilaterals"),
    (19, "TangentAtEdgeVertices"),
    (20, "NormalAtVertices"),
    (21, "NormalAtTriangleVertices"),
    (23, "AngleOfCornerBound"),
    (24, "TrianglesP2"),
    (25, "EdgesP2"),
    (29, "SubDomainFromGeom"),
    (30, "TetrahedraP2"),
    (43, "VerticesOnGeometricQuadrilaterals"),
    (44, "EdgesOnGeometricEdges"),
    (50, "BoundingBox"),
    (52, "PrivateTable"),
    (55, "TrianglesOnGeometricTriangles"),
    (59, "Tangents"),
    (60, "Normals"),
    (61, "TangentAtVertices"),
    (63, "SolAtEdges"),
    (64, "SolAtTriangles"),
    (66, "SolAtTetrahedra"),
    (77, "Iterations"),
    (78, "Time"),
    (81, "Comments"),
    (126, "ByteFlow"),
    (155, "FloatingPointPrecision"),
];

/// What a notice calls the keyword of a code.
pub(super) fn describe(code: i32) -> String {
    let names = Keyword::ALL.into_iter().map(Keyword::identity).chain(PASSED_OVER);
    match names.into_iter().find(|&(c, _)| c == code) {
        Some((_, name)) => format!("{name} (keyword {code})"),
        None => format!("keyword {code}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_names_lead_back_to_their_keyword() {
        for keyword in Keyword::ALL {
            assert_eq!(Keyword::from_code(keyword.code()), Some(keyword));
            assert_eq!(Keyword::from_name(keyword.name().as_bytes()), Some(keyword));
            assert!(PASSED_OVER.iter().all(|&(code, name)| code != keyword.code() && name != keyword.name()));
        }
    }

    #[test]
    fn a_notice_names_what_it_can() {
        assert_eq!(describe(10), "Hexahedra (keyword 10)");
        assert_eq!(describe(4), "Vertices (keyword 4)");
        assert_eq!(describe(9999), "keyword 9999");
    }
}
