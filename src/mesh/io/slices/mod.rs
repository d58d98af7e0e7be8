//! Meshes and metrics that are larger than memory: binary files that are written and read by slices.
//!
//! Writing: the counts come first ([`MeshWriter::create`]), since they tell where each row is; then rows are put in any order, from any thread,
//! and [`MeshWriter::finish`] sees that none is missing. The bytes are those of the mesh written whole. The file is that of
//! [`Batch::open`](super::Batch::open). Several processes write one file: the others [`MeshWriter::join`], and tell with [`MeshWriter::leave`] what they
//! have written.
//!
//! Reading: [`MeshReader::open`] reads the heads of the sections alone, then each range of rows is read where it stands, with the checks
//! of a mesh that is read whole.
mod covered;
mod file;
mod reader;
mod writer;

pub(in crate::mesh) use file::Positioned;
pub use reader::{MeshReader, SolutionReader};
pub use writer::{MeshWriter, MetricWriter, SolutionWriter, Written};

#[cfg(test)]
mod tests;
