//! The kernel: the mesh store, its operations, and the passes that make a unit mesh.
//!
//! Imports go one way: `beside → run → { passes → operations → { surface, schedule }, coarsen, extract } → core`.
#[cfg(any(test, feature = "internals"))]
pub mod bench_support;
pub mod beside;
mod coarsen;
mod core;
mod extract;
pub mod forecast;
pub mod meeting;
mod operations;
mod passes;
mod references;
mod run;
mod schedule;
mod surface;
#[cfg(test)]
mod tests;

pub use core::fill::Error;
pub use core::refusal::{Counts, Refusal};
pub use core::required::{Freeze, held_vertices};
pub use extract::{Extracted, Joint};
pub use operations::insertion::centroid::PointCreation;
pub use operations::reconnection::criteria::Criterion;
pub use passes::pipeline::{Effort, GrowthEnd};
pub use references::References;
pub use run::{Adapted, Options, Part, adapt, adapt_part};
pub use schedule::work::{KINDS, Kind, Observer, Silent, Work};
pub use schedule::{Grains, Scheduler};
pub use surface::bounds::SurfaceBounds;
