//! The field on new tetrahedra, each by itself, from the old one on its pieces.
use super::corners::Corners;
use super::front::Front;
use crate::mesh::locate::{Locator, Size};
use crate::mesh::vector::Vec3;

/// A tetrahedron of which less than this share lies in the old mesh is outside.
pub const OUTSIDE: f64 = 1e-6;

/// A tetrahedron of which this share or more lies there is inside.
pub const INSIDE: f64 = 1.0 - 1e-9;

/// No bounds: all values are beyond.
pub const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// A component on a new tetrahedron.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct OnTet {
    /// At the corners.
    pub values: [f64; 4],
    /// Of the old field on the tetrahedra that are met.
    pub bounds: [f64; 2],
}

/// One for each thread or chunk. It keeps its memory.
pub struct Pieces<'l> {
    locator: &'l Locator,
    values: &'l [f64],
    front: Front<'l>,
    corners: Corners,
}

impl<'l> Pieces<'l> {
    /// Of a mesh, of this size or a part of one of this size, with rows of `width` values at its vertices.
    pub fn new(locator: &'l Locator, size: &Size, width: usize, values: &'l [f64]) -> Self {
        Self { locator, values, front: Front::new(locator, size), corners: Corners::new(width) }
    }

    /// Each component on a new tetrahedron with these corners, at which the nearest points have these rows of values. Returns the share of the
    /// tetrahedron that the old mesh covers.
    pub fn of(&mut self, x: &[Vec3; 4], nearest: [&[f64]; 4], found: &mut [OnTet]) -> f64 {
        let Self { locator, values, front, corners } = self;
        let width = found.len();
        corners.clear(x[0]);
        let covered = front.over(x, |old, planes, piece| {
            let rows = locator.tets()[old as usize].map(|v| &values[v as usize * width..][..width]);
            corners.add(locator.corners(old), rows, planes, piece);
        });
        if covered < OUTSIDE {
            Self::outside(nearest, found);
        } else {
            for (c, found) in found.iter_mut().enumerate() {
                let (values, bounds) = corners.values(c, x);
                *found = OnTet { values, bounds };
            }
        }
        covered
    }

    /// Each component on a new tetrahedron outside the old mesh.
    pub fn outside(nearest: [&[f64]; 4], found: &mut [OnTet]) {
        for (c, found) in found.iter_mut().enumerate() {
            let values = nearest.map(|row| row[c]);
            let bounds = values.into_iter().fold(NOTHING, |b, x| [b[0].min(x), b[1].max(x)]);
            *found = OnTet { values, bounds };
        }
    }
}
