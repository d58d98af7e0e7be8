//! The surface of a mesh as its own geometry, and what is needed to read features off a surface mesh.
mod boundary;
mod build;
mod chains;
mod corners;
mod crossing;
mod cubic;
mod edges;
mod evaluate;
mod features;
mod foot;
mod local_fit;
mod nets;
mod patch;
mod plane;
mod polyline;
mod restore;
#[cfg(test)]
pub(crate) mod samples;
mod sectors;
mod smooth;
#[cfg(test)]
mod smooth_tests;
mod tangents;
#[cfg(test)]
mod tests;
mod tree;
mod vertex_normals;

pub use boundary::{complete_boundary, complete_matched, outward_triangles};
pub use build::{DEFAULT_RIDGE_ANGLE, Discrete, DiscreteOptions};
pub use evaluate::DiscreteEvaluator;

pub(crate) use chains::{Chain, trace_chains};
pub(crate) use edges::EdgeTable;
pub(crate) use features::Features;
pub(crate) use polyline::closest_on_triangle;
pub(crate) use tree::{BoxTree, box_of};
