//! The space around a body, for external flows.
use crate::mesh::vector::Vec3;

/// A box, or a sphere, without the body; all in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarField {
    /// The box: least and greatest corner. Of a sphere no more than what is in it is kept, where there is a plane of symmetry.
    pub bounds: [Vec3; 2],
    /// Centre and radius of the sphere, if it is one.
    pub sphere: Option<(Vec3, f64)>,
    /// The plane of symmetry, if there is one: its normal's axis (0, 1, 2) and its place on it. It is a side of the box.
    pub symmetry: Option<(usize, f64)>,
}
