//! Flips: edges and faces are removed where a criterion gains by it.
pub mod boundary_tet_removal;
pub mod criteria;
pub mod edge_removal;
pub mod face_removal;
pub mod multi_face_removal;
pub mod ring;
pub mod sweep;
