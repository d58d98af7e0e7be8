//! Metrics: the tensor algebra, edge length and mean ratio, fields, analytic fields, the background.
pub mod tensor;

pub use tensor::Sym3;
