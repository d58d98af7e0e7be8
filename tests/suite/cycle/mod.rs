//! `geo-adapt cycle`: loops with solvers.
mod browser;
mod goal;
mod loops;
mod openfoam;
mod openfoam_adjoint;
mod openfoam_viscous;
mod place;
mod stacks;
mod su2;
