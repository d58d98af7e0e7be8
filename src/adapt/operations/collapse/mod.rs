//! Collapse of edges that are too short: one end onto the other, both ends to the middle, or many vertices at a time in a crowded mesh.
pub mod onto_best;
pub mod onto_end;
pub mod thinning;
pub mod to_middle;
