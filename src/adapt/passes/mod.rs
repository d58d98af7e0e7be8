//! The passes: what is done, in which order, until the mesh is a unit mesh.
pub mod pipeline;
