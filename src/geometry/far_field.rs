//! The space around a body, for external flows.
use crate::mesh::vector::Vec3;

/// A box, or a sphere, without the body; all in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarField {
    /// The box: least and greatest corner. With a plane of symmetry only the part of a sphere in this box is kept.
    pub bounds: [Vec3; 2],
    /// Centre and radius of the sphere, if it is one.
    pub sphere: Option<(Vec3, f64)>,
    /// The plane of symmetry, if there is one: the axis of its normal (0, 1, 2) and its place on that axis. It is a side of the box.
    pub symmetry: Option<(usize, f64)>,
}
