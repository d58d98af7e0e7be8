//! `geo-adapt adapt` on the mesh's own surface, and how it is called.
mod discrete;
mod errors;
mod habits;
mod stacks;
mod stop;
mod telling;
mod touching;
mod tune;
