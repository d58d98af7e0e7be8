//! Tetrahedral meshes as plain arrays: what goes in and what comes out.
pub mod io;
mod tet_mesh;
pub mod vector;

pub use tet_mesh::{Association, Elements, OnEdge, OnFace, OnVertex, TetMesh};
