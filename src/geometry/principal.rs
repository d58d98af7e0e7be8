//! Principal curvatures from a shape operator.
use crate::mesh::vector::{Vec3, add, cross, scale};
use nalgebra::{Matrix2, SymmetricEigen};

/// The principal curvatures κ1, κ2 of a shape operator S in the axes of a tangent plane, |κ1| ≥ |κ2|, and their unit directions. The axes are
/// orthonormal and right-handed with the normal.
pub(crate) fn principal(shape: Matrix2<f64>, axes: [Vec3; 2]) -> ([f64; 2], [Vec3; 2]) {
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(shape);
    let first = usize::from(eigenvalues[1].abs() > eigenvalues[0].abs());
    let along = eigenvectors.column(first);
    let direction = add(scale(axes[0], along[0]), scale(axes[1], along[1]));
    let normal = cross(axes[0], axes[1]);
    ([eigenvalues[first], eigenvalues[1 - first]], [direction, cross(normal, direction)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::dot;

    const AXES: [Vec3; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    #[test]
    fn curvatures_come_by_their_size_and_directions_are_orthonormal() {
        // Curvatures a and b at an angle: S = R diag(a, b) Rᵀ.
        for (a, b) in [(2.0, 1.0), (-3.0, 1.0), (0.5, -0.5), (4.0, 0.0)] {
            let (s, c) = 0.7f64.sin_cos();
            let shape = Matrix2::new(a * c * c + b * s * s, (a - b) * s * c, (a - b) * s * c, a * s * s + b * c * c);
            let ([k1, k2], [d1, d2]) = principal(shape, AXES);
            assert!(k1.abs() >= k2.abs() - 1e-15 && dot(d1, d2).abs() < 1e-15 && (dot(d1, d1) - 1.0).abs() < 1e-14);
            for (k, d) in [(k1, d1), (k2, d2)] {
                let image = shape * nalgebra::Vector2::new(d[0], d[1]);
                assert!((image[0] - k * d[0]).abs() < 1e-14 && (image[1] - k * d[1]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_plane_and_a_sphere_have_any_directions() {
        for k in [0.0, -1.5] {
            let (curvatures, [d1, d2]) = principal(Matrix2::identity() * k, AXES);
            assert_eq!(curvatures, [k, k]);
            assert!(dot(d1, d2).abs() < 1e-15 && (dot(d1, d1) - 1.0).abs() < 1e-15);
        }
    }
}
