//! The metric of a goal: the mesh whose interpolation error does the least harm to a functional J for its number of vertices (METHOD.md §1.16;
//! Loseille, Dervieux & Alauzet 2010; Belme, Dervieux & Alauzet 2012).
//!
//! Terms are pairs of a weight g_i ≥ 0 and a field u_i: |δJ| ≲ Σ ∫ g_i |u_i - Πu_i|. Q = Σ g_i |H(u_i)| then stands where the multiscale metric has
//! |H|: M = D det(Q)^(-1/(2p+3)) Q with p = 1, D by the complexity. A weight is given, or made of the derivatives of an adjoint λ, each in absolute
//! value: signed, they would sum up to the adjoint equation, which vanishes wherever the functional has no source.
mod boundary;
mod error;
mod flow;
mod incompressible;
mod sum;
pub mod terms;
#[cfg(test)]
mod tests;
mod weights;

pub use boundary::Boundary;
pub use error::Error;
pub use flow::{Gas, Variables, Viscosity};
pub use incompressible::Fluid;
pub use sum::{Goal, NORM};
pub use weights::{Derivative, Weight};
