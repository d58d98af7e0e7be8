//! Classification: which B-rep entity each boundary vertex, ridge edge and triangle of a mesh lies on.
mod error;
mod result;

pub use error::Error;
pub use result::Classification;
