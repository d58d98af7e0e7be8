//! Between our tensors and nalgebra's.
use super::{Eigen, Sym3};
use nalgebra::Matrix3;

impl From<[f64; 6]> for Sym3 {
    /// Of the terms 11 12 22 13 23 33.
    #[inline(always)]
    fn from(terms: [f64; 6]) -> Self {
        Self(terms)
    }
}

impl From<Sym3> for [f64; 6] {
    #[inline(always)]
    fn from(tensor: Sym3) -> Self {
        tensor.0
    }
}

impl From<Sym3> for Matrix3<f64> {
    fn from(tensor: Sym3) -> Self {
        let [a, b, c, d, e, f] = tensor.0;
        Self::new(a, b, d, b, c, e, d, e, f)
    }
}

impl From<Matrix3<f64>> for Sym3 {
    /// Takes the symmetric part. Of a matrix that is symmetric to rounding nothing else is lost.
    fn from(m: Matrix3<f64>) -> Self {
        let mean = |i: usize, j: usize| 0.5 * (m[(i, j)] + m[(j, i)]);
        Self([m[(0, 0)], mean(0, 1), m[(1, 1)], mean(0, 2), mean(1, 2), m[(2, 2)]])
    }
}

impl From<Eigen> for (nalgebra::Vector3<f64>, Matrix3<f64>) {
    /// The eigenvalues, ascending, and the matrix whose columns are their vectors.
    fn from(eigen: Eigen) -> Self {
        (eigen.values.into(), Matrix3::from_columns(&eigen.vectors.map(Into::into)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    const TENSOR: Sym3 = Sym3([4.0, 1.0, 3.0, -0.5, 0.25, 2.0]);

    #[test]
    fn a_tensor_there_and_back_is_the_same() {
        let matrix = Matrix3::from(TENSOR);
        assert_eq!(matrix, matrix.transpose());
        assert_eq!(Sym3::from(matrix), TENSOR);
        assert_eq!(Sym3::from(<[f64; 6]>::from(TENSOR)), TENSOR);
        let v = [0.3, -0.7, 2.0];
        assert_eq!(matrix * Vector3::from(v), Vector3::from(TENSOR.apply(v)));
    }

    #[test]
    fn of_any_matrix_the_symmetric_part_is_taken() {
        let skew = Matrix3::new(0.0, 1.0, -2.0, -1.0, 0.0, 3.0, 2.0, -3.0, 0.0);
        assert_eq!(Sym3::from(Matrix3::from(TENSOR) + skew), TENSOR);
    }

    #[test]
    fn a_spectral_decomposition_gives_the_tensor_again() {
        let (values, vectors) = TENSOR.eigen().into();
        let again: Matrix3<f64> = vectors * Matrix3::from_diagonal(&values) * vectors.transpose();
        assert!((again - Matrix3::from(TENSOR)).norm() < 1e-14);
        // And nalgebra finds the same eigenvalues.
        let mut theirs = Matrix3::from(TENSOR).symmetric_eigenvalues();
        theirs.as_mut_slice().sort_by(f64::total_cmp);
        assert!((theirs - values).norm() < 1e-14);
    }
}
