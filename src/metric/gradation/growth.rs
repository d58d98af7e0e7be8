//! How a metric grows along an edge.
use super::super::frame::Frame;
use crate::mesh::vector::{Vec3, dot};

impl Frame {
    /// The roots of this metric grown along e, `growth` = ln r (mixed space, t = 1/8):
    /// λ_i · [(1 + √λ_i |e| ln r)^t (1 + L(e) ln r)^(1−t)]^(−2).
    #[inline]
    pub fn grown(&self, e: Vec3, growth: f64) -> [f64; 3] {
        let along = [0, 1, 2].map(|i| self.roots[i] * dot(self.vectors[i], e));
        let uniform = 1.0 + growth * dot(along, along).sqrt();
        let own = growth * dot(e, e).sqrt();
        let common = eighth_root(uniform) / uniform;
        self.roots.map(|root| root * common / eighth_root(1.0 + root * own))
    }
}

/// x^(1/8).
#[inline(always)]
fn eighth_root(x: f64) -> f64 {
    x.sqrt().sqrt().sqrt()
}
