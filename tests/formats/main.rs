//! Meshes and fields in the files of other programs: what is written comes back, what others write is read.
mod cgns;
mod damage;
mod foreign;
mod gmsh;
mod other_solvers;
mod round_trip;
mod sample;
mod stacks;
mod su2;
mod ugrid;
mod vtu;
