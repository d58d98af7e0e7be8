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

impl FieldKind {
    const ALL: [Self; 4] = [Self::Scalar, Self::Vector, Self::SymmetricTensor, Self::Tensor];

    /// Number of values at a vertex.
    pub fn values(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector => 3,
            Self::SymmetricTensor => 6,
            Self::Tensor => 9,
        }
    }

    /// Number that stands for the kind in a file.
    pub(super) fn code(self) -> i64 {
        match self {
            Self::Scalar => 1,
            Self::Vector => 2,
            Self::SymmetricTensor => 3,
            Self::Tensor => 4,
        }
    }

    /// The kind of a file's number.
    pub(super) fn from_code(code: i64) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.code() == code)
    }
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

impl Solution {
    /// The values of one number a vertex, shape (vertices,), counted from 0 through all fields; none where there are not so many.
    pub fn component(&self, index: usize) -> Option<Vec<f64>> {
        let mut before = index;
        for SolutionField { kind, values } in &self.fields {
            if before < kind.values() {
                return Some(values.iter().skip(before).step_by(kind.values()).copied().collect());
            }
            before -= kind.values();
        }
        None
    }

    /// A solution of one symmetric tensor field, shape (vertices, 6), each 11 12 22 13 23 33: what a
    /// metric file holds.
    ///
    /// ```
    /// use geo_adapt::io::Solution;
    /// let metric = [[1.0, 0.0, 4.0, 0.0, 0.0, 9.0]];
    /// assert_eq!(Solution::metric(&metric).as_metric(), Some(&metric[..]));
    /// ```
    pub fn metric(tensors: &[[f64; 6]]) -> Self {
        let field = SolutionField { kind: FieldKind::SymmetricTensor, values: tensors.as_flattened().to_vec() };
        Self { vertices: tensors.len(), fields: vec![field] }
    }

    /// The tensors, shape (vertices, 6), each 11 12 22 13 23 33, when the solution has exactly one field
    /// and that is symmetric tensors. Whether they are positive definite is not asked here.
    pub fn as_metric(&self) -> Option<&[[f64; 6]]> {
        match &self.fields[..] {
            [SolutionField { kind: FieldKind::SymmetricTensor, values }] => Some(values.as_chunks().0),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metric_is_exactly_one_field_of_symmetric_tensors() {
        let mut solution = Solution::metric(&[[1.0; 6], [2.0; 6]]);
        assert_eq!(solution.as_metric(), Some(&[[1.0; 6], [2.0; 6]][..]));
        solution.fields.push(SolutionField { kind: FieldKind::Scalar, values: vec![0.0; 2] });
        assert_eq!(solution.as_metric(), None);
        solution.fields.remove(0);
        assert_eq!(solution.as_metric(), None);
    }
}
