//! The one door: the store, how its vertices are claimed, and the few functions that write to it.
//!
//! The writing methods of [`store::Store`] are visible in this module alone. Whoever changes a mesh calls [`commit`] (a cavity is replaced),
//! [`vertex_moves`] (a vertex moves), [`vertex_replacement`] (a vertex goes onto another, in the records that are there),
//! [`boundary_tets`] (a tetrahedron at the boundary goes) or, after a commit, [`ridges`]. The first four check what is required or frozen.
pub mod access;
pub mod ball;
pub mod boundary_tets;
#[cfg(test)]
pub mod check;
pub mod commit;
pub mod context;
pub mod edge_list;
pub mod fill;
pub mod id_pool;
pub mod ids;
mod lock_checker;
pub mod measure;
pub mod numbering;
pub mod parts;
pub mod refusal;
pub mod required;
pub mod ridges;
pub mod shell;
pub mod stages;
pub mod stamped;
pub mod star;
pub mod store;
pub mod timed_evaluator;
pub mod vertex_moves;
pub mod vertex_replacement;
pub mod voids;
pub mod worker;
