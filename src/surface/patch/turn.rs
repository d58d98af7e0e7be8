//! Diagonals turned until the triangles of a face are Delaunay in space.
use super::super::plane::{NONE, in_circle, turn};
use super::{Patch, UPRIGHT, look};
use crate::mesh::vector::{Vec3, cross, dot, norm, sub};

/// By how much a turned diagonal must better a cosine.
const GAIN: f64 = 0.05;

impl Patch {
    /// Turns diagonals until the triangles in space are Delaunay: the angles opposite to an edge are no more than half a turn together.
    pub(super) fn straighten(&mut self, mut stack: Vec<(u32, usize)>) {
        let mut left = 32 * (self.triangles.len() + stack.len());
        while let Some((t, i)) = stack.pop() {
            if self.is_better_turned(t, i) {
                left -= 1;
                if left == 0 {
                    return;
                }
                let u = self.beside[t as usize][i];
                self.flip(t, i);
                stack.extend([(t, 0), (t, 2), (u, 0), (u, 1)]);
            }
        }
    }

    pub(super) fn is_better_turned(&self, t: u32, i: usize) -> bool {
        let u = self.beside[t as usize][i];
        if u == NONE || self.fixed[t as usize][i] != NONE {
            return false;
        }
        let Some(j) = self.beside[u as usize].iter().position(|&x| x == t) else { return false };
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let d = self.triangles[u as usize][j];
        if self.is_one(a, d) {
            return false;
        }
        let [a2, b2, c2, d2] = [a, b, c, d].map(|c| self.plane[c as usize]);
        let [p, q, r, s] = [a, b, c, d].map(|c| self.spot(c));
        let corner = |at: Vec3, x: Vec3, y: Vec3| {
            let [x, y] = [sub(x, at), sub(y, at)];
            (norm(cross(x, y)), dot(x, y))
        };
        let ((sin_a, cos_a), (sin_d, cos_d)) = (corner(p, q, r), corner(s, r, q));
        // Flat ones in one row have angles of half a turn and none.
        let is_flat = sin_a <= 1e-9 * cos_a.abs() && cos_a < 0.0 || sin_d <= 1e-9 * cos_d.abs() && cos_d < 0.0;
        // Beside the line of a pole both are the same in space: in the plane each point is to go to what is nearest of it.
        if !is_flat && [[a, b], [a, c], [d, b], [d, c]].into_iter().any(|[x, y]| self.is_one(x, y)) {
            return in_circle(a2, b2, c2, d2) > 0.0 && turn(a2, b2, d2) > 0.0 && turn(a2, d2, c2) > 0.0;
        }
        if !(turn(a2, b2, d2) > 0.0 && turn(a2, d2, c2) > 0.0) {
            return false;
        }
        let [n_a, n_b, n_c, n_d] = [a, b, c, d].map(|v| self.normals[v as usize]);
        let before = look([p, q, r], [n_a, n_b, n_c]).min(look([q, s, r], [n_b, n_d, n_c]));
        let after = look([p, q, s], [n_a, n_b, n_d]).min(look([p, s, r], [n_a, n_d, n_c]));
        // What looks away is turned even where the angles, which know of no folds, are fine;
        if before < UPRIGHT && after > before + GAIN {
            return true;
        }
        let turned = sin_a * cos_d + cos_a * sin_d;
        let size = (sin_a.hypot(cos_a)) * (sin_d.hypot(cos_d));
        let is_turned = size > 0.0 && turned < -1e-9 * size;
        // and none must come to look away.
        (is_flat || is_turned) && after >= before.min(UPRIGHT) - 1e-12
    }
}
