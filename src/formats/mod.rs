//! Meshes and fields in the files of other programs.
mod dataset;
pub mod foam;

pub use dataset::{Dataset, NamedField};
