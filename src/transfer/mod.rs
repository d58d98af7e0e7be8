//! Fields at the vertices of one mesh brought to the vertices of another.
//!
//! There are two ways. [`interpolate`] takes the value of the old field, linear in each tetrahedron, at each new vertex. It is exact for linear
//! fields and within the bounds of the old field, and it keeps no integral. [`conservative`] makes the new field from the integrals of the old one over the
//! pieces in which the tetrahedra of both meshes meet (Alauzet & Mehrenbach, *P1-conservative solution interpolation on unstructured
//! triangular meshes*, Int. J. Numer. Meth. Engng 84, 2010). It is exact for linear fields too, within the bounds of the old field, and keeps the mean.
//!
//! Values come in rows of `width` a vertex, in whichever order: several fields are brought over at the price of one.
//! All results are the same bit for bit on any number of threads.
mod balance;
mod clip;
mod conservative;
mod corners;
mod distance;
mod error;
mod front;
mod interpolate;
mod mass;
pub mod out_of_core;
mod pieces;
mod places;

pub use conservative::{Conserved, Keep, conservative};
pub use distance::{Distance, distance};
pub use error::{Error, Which};
pub use interpolate::{interpolate, interpolate_in};
pub use mass::{Component, measure};
pub use places::Places;
