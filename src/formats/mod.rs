//! Meshes and fields in the files of other programs.
mod dataset;

pub use dataset::{Dataset, NamedField};
