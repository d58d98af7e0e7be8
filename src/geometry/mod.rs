//! The geometry of the domain: entities, their shape, and the classification of a mesh on them.
pub mod classify;
pub mod discrete;
mod entity;
mod error;
mod far_field;
pub mod fidelity;
mod healed;
mod labels;
mod model;
pub mod names;
#[cfg(feature = "occt")]
mod occt;
mod principal;
mod traits;

pub use discrete::Discrete;
pub use entity::{CurveKind, EdgeEntity, Entity, FaceEntity, SurfaceKind, Topology, VertexEntity};
pub use error::Error;
pub use far_field::FarField;
pub use healed::{ClosedGap, DoubleWall, Healed, Remedy};
pub use labels::on_mesh;
pub use model::{Evaluator, Model};
pub use names::{Label, Names, called};
#[cfg(feature = "occt")]
pub use occt::{EdgeUse, OcctEvaluator, OcctModel, Side, Use};
pub(crate) use principal::principal;
pub use traits::{CurveFrame, Evaluate, Geometry, OnCurve, OnSurface, SurfaceFrame};

/// Has OpenCASCADE, and all C++, call this where it finds no memory, before it answers by an error of its own. It comes back only where one
/// request was too large for a machine that has memory left.
pub fn on_memory_end(leave: extern "C" fn()) {
    #[cfg(feature = "occt")]
    occt::on_memory_end(leave);
    #[cfg(not(feature = "occt"))]
    let _ = leave;
}
