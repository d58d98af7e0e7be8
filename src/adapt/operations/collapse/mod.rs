//! Edges that are too short go: a vertex onto a neighbour, both to the middle, or many at a time in a crowded mesh.
pub mod onto_best;
pub mod onto_end;
pub mod thinning;
pub mod to_middle;
