//! What the mesh should be like.
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// What the mesh should be like.
pub struct Wish {
    /// Greatest size, model units.
    pub greatest: f64,
    /// Least size: the curvature at an apex has no bound.
    pub least: f64,
    /// Diagonal of the model's box.
    pub diagonal: f64,
    /// Segments for a radian of curvature.
    pub segments: f64,
    /// How long a run may take.
    pub limit: Duration,
    /// Set when the user ends it.
    pub stop: &'static AtomicBool,
}
