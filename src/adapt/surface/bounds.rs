//! The user's bounds of the surface: triangles that deviate too far from the model are split, and no operation makes new ones.
use super::deviation::SurfaceDeviation;
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{FACE, TetId};
use crate::adapt::core::worker::Worker;

/// Bounds of how far surface triangles may deviate from the model. Without them operations only keep triangles from becoming worse than
/// the kernel's own limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceBounds {
    /// Greatest angle in degrees between a triangle's normal and the model's at the point closest to its centroid, and half the greatest
    /// angle between the model's normals at its vertices.
    pub normal_deviation: Option<f64>,
    /// Greatest distance from the model of a triangle's centroid and of the middles of its edges: the chord error, in model units.
    pub hausdorff: Option<f64>,
}

impl SurfaceBounds {
    /// Whether there are any.
    pub fn is_some(&self) -> bool {
        self.normal_deviation.is_some() || self.hausdorff.is_some()
    }

    /// The least cosine of the angle: the kernel's own or the user's, whichever is stricter.
    pub fn cosine(&self, default: f64) -> f64 {
        self.normal_deviation.map_or(default, |degrees| degrees.to_radians().cos().max(default))
    }

    /// Greatest chord error.
    pub fn chord(&self) -> f64 {
        self.hausdorff.unwrap_or(f64::INFINITY)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Whether a triangle deviates farther from the model than it may.
    pub fn deviates(&self, deviation: SurfaceDeviation) -> bool {
        let limits = self.context.limits;
        deviation.cos_deviation.abs() < limits.cos_deviation
            || deviation.cos_variation < limits.cos_variation
            || deviation.chord > limits.chord
    }

    /// How many surface triangles of a tetrahedron deviate. A triangle of an interface counts for the tetrahedron with the lesser id.
    pub fn count_deviating(&mut self, t: TetId) -> usize {
        let (vertices, tags) = (self.store.vertices(t), self.store.tags(t));
        let mut count = 0;
        for i in (0..4).filter(|&i| tags[i] != 0) {
            let behind = self.store.neighbour(t, i);
            if !behind.is_some() || t < behind {
                let deviation = self.surface_deviation(FACE[i].map(|k| vertices[k]), tags[i] - 1);
                count += usize::from(self.deviates(deviation));
            }
        }
        count
    }
}
