//! How much the passes do: all that a unit mesh takes, or what a draft takes, a mesh that is only asked for the sizes of the next.

/// How much the passes do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Whether there are stages. They save insertions in thin layers; a first mesh is too coarse everywhere, and there they only take time.
    pub stages: bool,
    /// Whether edges wait for flips, as [`Limits::waits`](crate::adapt::core::context::Limits::waits) says. From a first mesh, which has no
    /// vertex inside, that halves the insertions; a mesh that is good already gets no better, and takes more sweeps.
    pub waits: bool,
    /// Whether the passes for the sizes smooth too.
    pub smooths: bool,
    /// A pass for the sizes that changes less than this share of the vertices is the last.
    pub little: f64,
    /// Whether there are passes for the shapes once all vertices are on the model.
    pub shapes: bool,
}

impl Effort {
    /// For a unit mesh.
    pub const FULL: Self = Self { stages: true, waits: false, smooths: true, little: 0.05, shapes: true };

    /// For a draft.
    pub const DRAFT: Self = Self { stages: false, waits: true, smooths: false, little: 0.1, shapes: false };
}
