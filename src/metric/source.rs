//! Where a new vertex takes its metric from.
use super::{Analytic, Background, Sym3};
use crate::mesh::vector::Vec3;

/// The source of the metric at any point. Shared by all threads.
pub enum Source {
    /// An analytic field, evaluated.
    Analytic {
        /// The field.
        field: Analytic,
        /// Logarithm of the factor of M (scaling to a complexity); 0 leaves the field as it is.
        log_scale: f64,
    },
    /// The background mesh, interpolated.
    Background(Background),
}

impl Source {
    /// ln M at p. `hint` serves the background (see [`Background::log_at`]): keep one a thread or a vertex.
    #[inline]
    pub fn log_at(&self, p: Vec3, hint: &mut u32) -> Sym3 {
        match self {
            Self::Analytic { field, log_scale } => field.log_at(p).plus_identity(*log_scale),
            Self::Background(background) => background.log_at(p, hint),
        }
    }

    /// Scales M by e^log_factor.
    pub fn scale(&mut self, log_factor: f64) {
        match self {
            Self::Analytic { log_scale, .. } => *log_scale += log_factor,
            Self::Background(background) => background.scale(log_factor),
        }
    }
}
