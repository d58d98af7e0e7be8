//! What was found on the way to a geometry metric.
use super::Gap;
use serde::Serialize;

/// Counts of mesh vertices, and the nearest gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Mesh vertices on vertices of the model.
    pub on_vertices: usize,
    /// On its edges.
    pub on_edges: usize,
    /// On its faces.
    pub on_faces: usize,
    /// Inside.
    pub inside: usize,
    /// At poles, apices and the like, where the curvature is a limit.
    pub singular: usize,
    /// Where curvature or gap ask for the least size, or for less.
    pub at_least_size: usize,
    /// Limited by a gap or a thin part.
    pub at_gaps: usize,
    /// The nearest gap that limits sizes, at a vertex or between.
    pub nearest_gap: Option<Gap>,
    /// Places between the vertices that were looked at, where edges are long for the metric.
    pub between: usize,
    /// Vertices whose sizes gradation has made smaller.
    pub graded: usize,
}

impl Summary {
    /// Takes what was found between the vertices: how many places were looked at, and the nearest gap there.
    pub(super) fn note_between(&mut self, (places, gap): (usize, Option<Gap>)) {
        self.between = places;
        self.note(gap);
    }

    /// Takes the nearer of the gaps.
    pub(super) fn note(&mut self, gap: Option<Gap>) {
        self.nearest_gap = Gap::nearer(self.nearest_gap, gap);
    }
}
