//! What a geometry metric is made by.
use crate::geometry::Topology;
use serde::Serialize;

/// Segments for a radian of a curve by default: 12.6 for a full circle, off by 3 % of the radius between them.
const SEGMENTS: f64 = 2.0;
/// Cells across a thin part or a gap by default: one vertex between its two sides.
const CELLS: f64 = 2.0;
/// Greatest size by default, as a share of the diagonal of the model's box (what refine and gmsh take too).
const GREATEST: f64 = 0.1;
/// Least size by default, as a share of the diagonal. It is there for apices and for what all but touches: a box of the far field may be
/// hundreds of times larger than what lies in it, so a thousandth would hide a wing's nose.
const LEAST: f64 = 1e-5;
/// Ratio of the sizes of neighbouring cells by default.
pub const GRADATION: f64 = 1.5;

/// What a geometry metric is made by. Lengths are in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Options {
    /// Segments n for a radian of curvature: the size is 1/(n |κ|).
    pub segments: f64,
    /// Least size.
    pub least: f64,
    /// Greatest size, and that of what is flat.
    pub greatest: f64,
    /// Greatest ratio of the sizes at a point; none for no limit.
    pub aspect_ratio: Option<f64>,
    /// Cells across a thin part or a gap; none to leave these alone.
    pub cells: Option<f64>,
    /// Ratio of gradation; none to leave the sizes as the geometry has them.
    pub gradation: Option<f64>,
}

impl Options {
    /// The defaults for a model: sizes between 1e-5 and a tenth of its diagonal.
    pub fn of(topology: &Topology) -> Self {
        let diagonal = topology.diagonal();
        Self {
            segments: SEGMENTS,
            least: LEAST * diagonal,
            greatest: GREATEST * diagonal,
            aspect_ratio: None,
            cells: Some(CELLS),
            gradation: Some(GRADATION),
        }
    }

    /// The size for a curvature in 1/length; that of none is the greatest.
    #[inline]
    pub(super) fn size(&self, curvature: f64) -> f64 {
        self.clip(1.0 / (self.segments * curvature.abs()))
    }

    /// A size between least and greatest.
    #[inline]
    pub(super) fn clip(&self, size: f64) -> f64 {
        size.max(self.least).min(self.greatest)
    }
}
