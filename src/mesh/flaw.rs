//! What can be wrong with a mesh, and how it is told.
use super::numbers::from_one;
use super::vector::Vec3;
use serde::Serialize;

/// What can be wrong with a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FlawKind {
    /// A tetrahedron or triangle names a node twice.
    RepeatedNodes,
    /// A tetrahedron's volume is negative, by an exact test.
    InvertedTet,
    /// A tetrahedron's volume is zero, by an exact test.
    FlatTet,
    /// Two tetrahedra have the same nodes.
    DuplicateTet,
    /// A face belongs to more than two tetrahedra.
    NonManifoldFace,
    /// Two tetrahedra lie on the same side of their common face.
    FoldedFace,
    /// A face with one tetrahedron has no triangle: a hole in the boundary, or a neighbour that is subdivided otherwise.
    OpenBoundary,
    /// A triangle is no face of a tetrahedron.
    LooseTriangle,
    /// Two triangles have the same nodes.
    DuplicateTriangle,
    /// The boundary is no surface along an edge: not exactly two of its triangles meet there, and the edge is not tagged.
    NonManifoldEdge,
    /// A tagged edge is no edge of a tetrahedron.
    LooseEdge,
    /// The tetrahedra at a vertex are in parts that share no face: they meet only in the vertex or in an edge.
    NonManifoldVertex,
    /// A vertex of no tetrahedron.
    UnusedVertex,
    /// Two triangles of the boundary pass through each other: the mesh overlaps itself. Only looked for where all tetrahedra are
    /// positive.
    CrossingTriangles,
}

impl FlawKind {
    /// In words, for a count of them.
    pub fn words(self) -> &'static str {
        match self {
            Self::RepeatedNodes => "elements that name a node twice",
            Self::InvertedTet => "inverted tetrahedra",
            Self::FlatTet => "flat tetrahedra",
            Self::DuplicateTet => "duplicate tetrahedra",
            Self::NonManifoldFace => "faces of more than two tetrahedra",
            Self::FoldedFace => "faces with both tetrahedra on one side",
            Self::OpenBoundary => "boundary faces without a triangle",
            Self::LooseTriangle => "triangles that are no face of a tetrahedron",
            Self::DuplicateTriangle => "duplicate triangles",
            Self::NonManifoldEdge => "non-manifold boundary edges",
            Self::LooseEdge => "tagged edges that are no edge of a tetrahedron",
            Self::NonManifoldVertex => "non-manifold vertices (their tetrahedra share no face)",
            Self::UnusedVertex => "unused vertices (of no tetrahedron)",
            Self::CrossingTriangles => "pairs of boundary triangles that cross",
        }
    }
}

/// One of the offenders. Indices count from 0; in JSON from 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Offender {
    /// Index of the element or vertex. For a face that is no element it is that of its tetrahedron; for an edge that is none, there is none.
    #[serde(serialize_with = "from_one")]
    pub index: Option<usize>,
    /// Index of the other one, of two that cross.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "from_one")]
    pub other: Option<usize>,
    /// Its nodes; of two those of both.
    #[serde(serialize_with = "from_one")]
    pub nodes: Vec<u32>,
    /// Its middle, or where the two meet; model units.
    pub at: Vec3,
}

/// A kind of flaw that the mesh has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flaw {
    /// The kind.
    pub kind: FlawKind,
    /// How often.
    pub count: usize,
    /// The first few.
    pub first: Vec<Offender>,
}

/// For people: numbers from 1, as in files.
impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.count, self.kind.words())?;
        for (i, offender) in self.first.iter().enumerate() {
            f.write_str(if i == 0 { ": " } else { "; " })?;
            if let Some(index) = offender.index {
                write!(f, "no. {}", index + 1)?;
                offender.other.map_or(Ok(()), |other| write!(f, " and {}", other + 1))?;
                f.write_str(", ")?;
            }
            let [x, y, z] = offender.at;
            let nodes: Vec<u32> = offender.nodes.iter().map(|v| v + 1).collect();
            write!(f, "nodes {nodes:?} at ({x:.6}, {y:.6}, {z:.6})")?;
        }
        Ok(())
    }
}
