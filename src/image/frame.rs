//! Where the voxels of an image lie in space.
use crate::mesh::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// The affine map between voxel indices and space. A voxel's centre is at whole indices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Centre of voxel (0, 0, 0).
    pub origin: Vec3,
    /// The step from a voxel to the next along each axis of the image.
    pub axes: [Vec3; 3],
    /// Rows of the inverse.
    inverse: [Vec3; 3],
}

impl Frame {
    /// A frame; none when the axes do not span space.
    pub fn new(origin: Vec3, axes: [Vec3; 3]) -> Option<Self> {
        let volume = dot(axes[0], cross(axes[1], axes[2]));
        let flat = 1e-9 * norm(axes[0]) * norm(axes[1]) * norm(axes[2]);
        let finite = axes.iter().flatten().chain(&origin).all(|x| x.is_finite()) && volume.is_finite();
        if !finite || volume.abs() <= flat {
            return None;
        }
        let inverse: [Vec3; 3] =
            std::array::from_fn(|i| scale(cross(axes[(i + 1) % 3], axes[(i + 2) % 3]), 1.0 / volume));
        inverse.iter().flatten().all(|x| x.is_finite()).then_some(Self { origin, axes, inverse })
    }

    /// Voxels along the axes of space.
    pub fn of_spacings(spacings: Vec3) -> Option<Self> {
        let [x, y, z] = spacings;
        Self::new([0.0; 3], [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
    }

    /// The point at an index, which need not be whole.
    #[inline]
    pub fn point(&self, index: Vec3) -> Vec3 {
        let [a, b, c] = self.axes;
        add(self.origin, add(scale(a, index[0]), add(scale(b, index[1]), scale(c, index[2]))))
    }

    /// The index of a point.
    #[inline]
    pub fn index(&self, point: Vec3) -> Vec3 {
        let from = sub(point, self.origin);
        self.inverse.map(|row| dot(row, from))
    }

    /// The gradient in space of each index, 1/length.
    pub fn gradients(&self) -> [Vec3; 3] {
        self.inverse
    }

    /// Volume of a voxel.
    pub fn volume(&self) -> f64 {
        dot(self.axes[0], cross(self.axes[1], self.axes[2])).abs()
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
