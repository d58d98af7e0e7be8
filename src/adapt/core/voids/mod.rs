//! Narrow voids: places where two parts of the boundary face each other, nearer than they may come to move.
//!
//! Inside, positive tetrahedra keep the mesh from overlapping itself. Across a void nothing does: the chords of its walls rise when their
//! edges get longer, and one wall would pass through the other. So where walls are near ([`near`] finds these places between sweeps), each
//! change of the surface is tested against the triangles there ([`guard`]), by exact predicates, and refused where it would bring two of
//! them through each other. Elsewhere, and where there are no narrow voids, nothing is tested.
//!
//! Changes are tested in the same way near what must stay on a curved surface, as at the cuts of a part: short edges beside long chords that
//! stay may fold the surface.
//!
//! What lies across a void cannot be claimed by vertices, so one thread alone makes such changes. Beside other threads they are a conflict,
//! and wait for the end of the sweep, which one thread does. So the mesh does not depend on the threads.
mod guard;
mod near;
#[cfg(test)]
mod tests;
mod triangles;

use crate::mesh::box_tree::{Bounds, BoxTree, overlap};
use crate::mesh::triangle_pair::Corners;
use std::sync::{PoisonError, RwLock, RwLockReadGuard};
use triangles::Triangles;

pub use guard::{Guarded, SurfaceChange};

/// The narrow voids of a mesh.
#[derive(Default)]
pub struct Voids {
    narrow: Option<Narrow>,
}

/// Where walls are near each other, and the boundary triangles there.
struct Narrow {
    /// Boxes about the triangles that were near others when they were looked for, with all that these may come to fill.
    zone: BoxTree,
    boxes: Vec<Bounds>,
    /// The boundary triangles whose boxes meet the zone, always as they are.
    triangles: RwLock<Triangles>,
}

impl Voids {
    /// Whether there is none.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.narrow.is_none()
    }
}

impl Narrow {
    fn new(boxes: Vec<Bounds>) -> Self {
        let zone = BoxTree::new(boxes.len(), |i| boxes[i as usize]);
        Self { zone, boxes, triangles: RwLock::default() }
    }

    /// Whether a triangle's box meets the zone.
    fn meets(&self, corners: &Corners) -> bool {
        let around = bounds(corners, 0.0);
        self.zone.any_overlapping(&around, |i| overlap(&around, &self.boxes[i as usize]))
    }

    fn triangles(&self) -> RwLockReadGuard<'_, Triangles> {
        self.triangles.read().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The box of a triangle, so much larger on all sides.
fn bounds([p, q, r]: &Corners, margin: f64) -> Bounds {
    [[0, 1, 2].map(|k| p[k].min(q[k]).min(r[k]) - margin), [0, 1, 2].map(|k| p[k].max(q[k]).max(r[k]) + margin)]
}
