//! Classification: which B-rep entity each boundary vertex, ridge edge and triangle of a mesh lies on.
//!
//! Triangles come first ([`patches`], and [`triangles`] where a patch spans several faces); mesh edges between
//! different faces are ridges and find their model edge ([`ridges`]); vertices of the model find their mesh vertex
//! ([`corners`]); then everything has its entity ([`entities`]), and [`coverage`] checks that the mesh covers the whole model.
mod associate;
mod corners;
mod coverage;
mod entities;
mod error;
mod fit;
mod hints;
mod landing;
mod patches;
mod report;
mod result;
mod ridges;
mod settle;
#[cfg(test)]
mod tests;
mod triangles;
mod units;

pub use associate::{Associated, associate, keeps_references};
pub use error::Error;
pub use fit::{Options, classify, usual_tolerance};
pub use report::{Dimension, Offset, Report};
pub use result::Classification;
