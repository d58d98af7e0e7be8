//! The kernel: the mesh store, its operations, and the passes that make a unit mesh.
mod access;
mod build;
mod cavity;
mod collapse;
mod context;
mod criteria;
mod edge_removal;
mod face_removal;
mod ids;
mod insert;
mod local;
mod outcome;
mod pipeline;
mod project;
mod reconnect;
mod schedule;
mod shape;
mod shell;
mod smooth;
mod star;
mod store;
mod surface;
mod worker;

pub use criteria::Criterion;
pub use outcome::{Counts, Refusal};
