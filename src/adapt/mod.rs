//! The kernel: the mesh store, its operations, and the passes that make a unit mesh.
mod access;
mod ball;
#[doc(hidden)]
pub mod bench_support;
mod build;
mod cavity;
#[cfg(test)]
mod check;
mod coarsen;
mod collapse;
mod context;
mod create;
mod criteria;
mod discipline;
mod edge_removal;
mod edges;
mod extend;
mod extract;
mod face_removal;
mod fan;
mod ids;
mod insert;
mod local;
mod mend;
mod merge;
mod multi_face;
mod numbering;
mod outcome;
mod pipeline;
mod project;
mod reconnect;
mod required;
mod ring;
mod run;
mod schedule;
mod shape;
mod shed;
mod shell;
mod smooth;
mod star;
mod store;
mod supply;
mod surface;
#[cfg(test)]
mod tests;
mod thin;
mod work;
mod worker;

pub use build::Error;
pub use create::PointCreation;
pub use criteria::Criterion;
pub use extract::Extracted;
pub use outcome::{Counts, Refusal};
pub use required::Freeze;
pub use run::{Adapted, Options, adapt};
pub use schedule::{Grains, Scheduler};
pub use work::{KINDS, Kind, Observer, Work};
