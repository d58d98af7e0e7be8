//! The layers along walls (METHOD.md §1.15): sizes that depend on the exact distance from some faces of a model.
//!
//! `search` finds the closest points of faces, `foot` what the distance is like there: its gradient, and its second derivatives, which are the
//! curvatures of the surfaces of equal distance. `growth` has the sizes that a user prescribes, `spalding` the profile of a turbulent boundary
//! layer, whose second derivatives are known so without a recovery from the mesh; `spec` reads both from words. `corners` are where faces of a wall bend
//! towards each other, `triangles` is the distance where there is no model, `measured` says what layers a mesh has, and `follows` how thin they can be
//! on a coarse one.
mod corners;
mod feet;
mod follows;
mod foot;
mod growth;
mod measured;
mod metric;
mod search;
pub mod spalding;
mod spec;
mod triangles;

pub use feet::Feet;
pub use follows::{THICKER, thickness};
pub use foot::Foot;
pub use growth::{Growth, Outside};
pub use measured::{Measured, measure};
pub use metric::{Asked, Error, OfWall, Options, Summary, wall_metric};
pub use search::Search;
pub use spec::{Wall, Walls};
pub use triangles::from_triangles;

use crate::geometry::Model;
use crate::geometry::classify::Classification;
use crate::mesh::TetMesh;
use crate::tasks::Team;

/// The exact distance of each vertex of a mesh from these faces of its model, shape (n,), model units; 0 on them. Faces that the mesh has no
/// triangle on are not looked at.
pub fn distances(team: Team<'_>, mesh: &TetMesh, place: &Classification, model: &Model, faces: &[u32]) -> Vec<f64> {
    Search::new(mesh, place, model, faces).distances(team)
}
