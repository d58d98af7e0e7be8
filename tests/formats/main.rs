//! Meshes and fields in the files of other programs: what is written comes back, what others write is read.
mod round_trip;
mod sample;
mod su2;
mod vtu;
