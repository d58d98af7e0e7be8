//! Where the voxels of an image lie in space.
use crate::mesh::vector::{Vec3, norm};
use nalgebra::{Matrix3, Vector3};

/// The affine map between voxel indices and space. A voxel's centre is at whole indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre of voxel (0, 0, 0).
    pub origin: Vec3,
    /// The step from a voxel to the next along each axis of the image.
    pub axes: [Vec3; 3],
    /// The axes as columns.
    to_space: Matrix3<f64>,
    /// Its inverse.
    to_index: Matrix3<f64>,
}

impl Frame {
    /// A frame; none when the axes do not span space.
    pub fn new(origin: Vec3, axes: [Vec3; 3]) -> Option<Self> {
        let to_space = Matrix3::from_columns(&axes.map(Vector3::from));
        let volume = to_space.determinant();
        let flat = 1e-9 * norm(axes[0]) * norm(axes[1]) * norm(axes[2]);
        let finite = axes.iter().flatten().chain(&origin).all(|x| x.is_finite()) && volume.is_finite();
        if !finite || volume.abs() <= flat {
            return None;
        }
        let to_index = to_space.try_inverse()?;
        to_index.iter().all(|x| x.is_finite()).then_some(Self { origin, axes, to_space, to_index })
    }

    /// Voxels along the axes of space.
    pub fn of_spacings(spacings: Vec3) -> Option<Self> {
        let [x, y, z] = spacings;
        Self::new([0.0; 3], [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
    }

    /// The point at an index, which need not be whole.
    #[inline]
    pub fn point(&self, index: Vec3) -> Vec3 {
        (Vector3::from(self.origin) + self.to_space * Vector3::from(index)).into()
    }

    /// The index of a point.
    #[inline]
    pub fn index(&self, point: Vec3) -> Vec3 {
        (self.to_index * (Vector3::from(point) - Vector3::from(self.origin))).into()
    }

    /// Second derivatives by the indices as those in space.
    pub fn hessian(&self, of_index: &Matrix3<f64>) -> Matrix3<f64> {
        self.to_index.tr_mul(of_index) * self.to_index
    }

    /// Volume of a voxel.
    pub fn volume(&self) -> f64 {
        self.to_space.determinant().abs()
    }

    /// Distance between voxels along each axis.
    pub fn spacings(&self) -> Vec3 {
        self.axes.map(norm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::distance;

    #[test]
    fn there_and_back() {
        let frame = Frame::new([1.0, -2.0, 3.0], [[0.0, 2.0, 0.1], [-0.5, 0.0, 0.0], [0.2, 0.3, -1.5]]).unwrap();
        for index in [[0.0; 3], [3.5, -2.0, 7.25]] {
            assert!(distance(frame.index(frame.point(index)), index) < 1e-12);
        }
    }

    #[test]
    fn axes_in_a_plane_are_none() {
        assert_eq!(Frame::new([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]), None);
        assert_eq!(Frame::of_spacings([1.0, 0.0, 1.0]), None);
        assert_eq!(Frame::of_spacings([1.0, f64::NAN, 1.0]), None);
    }
}
