//! Smoothing: Newton's step on the energy of a vertex' tetrahedra and edges.
pub mod patch;
pub mod vertex;
