//! The sizes that a geometry asks for (METHOD.md §1.13): the curvature of its faces and edges, and what is thin or near.
//!
//! `curvature` makes the tensor of an entity at a point, `estimate` does where the model is a mesh's own surface; `feature` finds the
//! entities that come near without touching (`touch`), by boxes over samples of the model (`pieces`, `tree`), where nothing stands between
//! (`sight`), of the same body (`bodies`). `coarse` looks between the vertices of a coarse mesh, and `field` puts it together;
//! `resolve` adds vertices to a coarse mesh until it resolves the metric. `around` has the sizes that a user asks for in some places.
//! `chords` cuts the sizes of any metric along the curved faces near a vertex (`walls`), so that straight edges can have them. `layer` has the
//! layers along walls, from the exact distance. `rises` makes a background of a metric at vertices,
//! which follows the model between the chords of its mesh.
pub mod around;
mod bodies;
mod bound;
pub mod chords;
mod coarse;
mod curvature;
mod estimate;
mod feature;
mod field;
pub mod layer;
mod options;
mod others;
mod pieces;
mod resolve;
mod rises;
mod sight;
mod summary;
mod touch;
mod tree;
mod twins;
mod walls;

pub use curvature::{Curvature, Local};
pub use feature::Gap;
pub use field::{Body, geometry_metric, resolved_metric};
pub use options::Options;
pub use resolve::Resolved;
pub use rises::{background, rises};
pub use summary::Summary;
