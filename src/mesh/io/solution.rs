//! Fields at the vertices of a mesh, as solution files carry them.

/// What one field holds at each vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// One value (libMeshb 1).
    Scalar,
    /// Three values (libMeshb 2).
    Vector,
    /// Six values of a symmetric tensor, 11 12 22 13 23 33 (libMeshb 3).
    SymmetricTensor,
    /// Nine values, row by row (libMeshb 4).
    Tensor,
}

/// One field.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionField {
    /// What it holds.
    pub kind: FieldKind,
    /// Values, shape (vertices, values of the kind), row by row.
    pub values: Vec<f64>,
}

/// The fields of a solution file (`SolAtVertices`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// Number of vertices.
    pub vertices: usize,
    /// The fields.
    pub fields: Vec<SolutionField>,
}
