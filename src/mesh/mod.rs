//! Tetrahedral meshes as plain arrays: the input and the output of everything.
pub mod adjacency;
pub mod bisection;
pub mod box_tree;
pub mod crossing;
pub mod disjoint_sets;
mod flaw;
pub mod hilbert;
pub mod io;
pub mod locate;
mod matched_faces;
pub mod numbers;
pub mod predicate;
pub mod quadrature;
pub mod ranges;
#[doc(hidden)]
pub mod samples;
pub mod split_nonmanifold;
pub mod stack;
pub mod stamped_set;
mod starts;
mod tet_mesh;
pub mod triangle_pair;
mod unfolded;
pub mod validity;
pub mod vector;
pub mod vertex_neighbours;

pub use flaw::{Flaw, FlawKind, Offender};
pub use tet_mesh::{Association, Elements, OnEdge, OnFace, OnVertex, TetMesh};
