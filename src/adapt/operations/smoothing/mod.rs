//! Smoothing: Newton's step on the energy of a vertex' tetrahedra and edges; moves for the worst tetrahedron alone.
pub mod patch;
pub mod vertex;
pub mod worst;
