//! From a 3D image to tetrahedra: speculative Delaunay refinement on the tasks' threads, a client of theirs beside the adapter.
//!
//! The way of the data: nrrd → [`Image`] → [`Domain`] (which region is a point in?) → `seeds` → `refine` (on a `store`, by `delaunay`)
//! → `extract` → [`crate::mesh::TetMesh`]. The method is restricted Delaunay refinement (Boissonnat, Oudot 2005; Oudot, Rineau, Yvinec
//! 2005), run optimistically as in PODM (Foteinos, Chrisochoides 2014; Tsolakis 2021, 5.3.2), without its removals of vertices.
mod circumsphere;
mod delaunay;
mod domain;
mod edge_table;
mod extract;
mod frame;
mod list;
mod manifold;
mod nrrd;
mod refine;
mod rules;
mod seeds;
mod smoothed;
mod store;
#[cfg(test)]
mod tests;

pub use domain::{Domain, DomainError};
pub use extract::{Extracted, RadiusEdge, Surface};
pub use frame::Frame;
pub use list::Counts;
pub use nrrd::{Encoding, Image, Kind, data_file, read, write};
pub use refine::mesh;
pub use rules::{Error, Limits, Wish};
pub use smoothed::{Smoothed, borders};
