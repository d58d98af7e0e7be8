//! Length, orientation and shape of what is in the store.
use super::access::Access;
use super::ids::VertexId;
use super::worker::Worker;
use crate::mesh::vector::{Vec3, sub, volume6};
use crate::metric::quality::{edge_length, may_exceed, mean_ratio};
use robust::{Coord3D, orient3d};

/// Whether the tetrahedron is positive: exact.
#[inline]
pub fn is_positive(p: [Vec3; 4]) -> bool {
    let volume = volume6(p[0], p[1], p[2], p[3]);
    let size = |k: usize| sub(p[k], p[0]).iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    // Thrice the forward error bound of the 3×3 determinant of rounded differences.
    if volume.abs() > 4e-14 * size(1) * size(2) * size(3) {
        return volume > 0.0;
    }
    let [a, b, c, d] = p.map(|[x, y, z]| Coord3D { x, y, z });
    // robust's sign is opposite: positive when d sees (a, b, c) clockwise from the other side.
    orient3d(a, b, c, d) < 0.0
}

impl<A: Access> Worker<'_, '_, A> {
    /// Length of the edge in the metric.
    #[inline]
    pub fn length(&self, a: VertexId, b: VertexId) -> f64 {
        let v = sub(self.store.position(b), self.store.position(a));
        edge_length(v, &self.store.metric(a), &self.store.metric(b))
    }

    /// Whether the vertices, in this order, make a positive tetrahedron: exact.
    #[inline]
    pub fn positive(&self, vertices: [VertexId; 4]) -> bool {
        is_positive(vertices.map(|v| self.store.position(v)))
    }

    /// Mean ratio of the tetrahedron that the vertices make; at most 0 when it is not positive (exact).
    #[inline]
    pub fn shape(&self, vertices: [VertexId; 4]) -> f64 {
        let points = vertices.map(|v| self.store.position(v));
        if !is_positive(points) {
            return 0.0;
        }
        let logs = vertices.map(|v| self.store.log(v));
        mean_ratio(points, [&logs[0], &logs[1], &logs[2], &logs[3]])
    }

    /// As [`Worker::shape`], but 0 at once when a cheap bound shows that it does not exceed `floor`.
    #[inline]
    pub fn shape_above(&self, vertices: [VertexId; 4], floor: f64) -> f64 {
        let points = vertices.map(|v| self.store.position(v));
        if !is_positive(points) {
            return 0.0;
        }
        let logs = vertices.map(|v| self.store.log(v));
        let logs = [&logs[0], &logs[1], &logs[2], &logs[3]];
        if may_exceed(points, logs, floor) { mean_ratio(points, logs) } else { 0.0 }
    }
}
