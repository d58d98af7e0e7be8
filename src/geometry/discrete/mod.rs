//! The surface of a mesh as its own geometry, and what is needed to read features off a surface mesh.
mod boundary;
mod build;
mod chains;
mod edges;
mod evaluate;
mod features;
mod patch;
mod polyline;
mod restore;
#[cfg(test)]
pub(crate) mod samples;
#[cfg(test)]
mod tests;
mod tree;

pub use boundary::{complete_boundary, complete_matched, outward_triangles};
pub use build::{DEFAULT_RIDGE_ANGLE, Discrete};
pub use evaluate::DiscreteEvaluator;

pub(crate) use chains::{Chain, trace_chains};
pub(crate) use edges::EdgeTable;
pub(crate) use features::Features;
pub(crate) use tree::{BoxTree, box_of};
