//! The boundary on the model: where points belong, how far triangles deviate from it, and the bounds that the user sets.
pub mod bounds;
pub mod conormal;
pub mod deviation;
pub mod placement;
