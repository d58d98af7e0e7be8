//! Metrics: the tensor algebra, edge length and mean ratio, fields, analytic fields, the background.
mod analytic;
mod background;
pub mod batch;
mod conversions;
mod eigen;
mod ellipsoid;
mod error;
mod exponential;
pub mod field;
pub mod frame;
pub mod from_image;
pub mod from_points;
pub mod gradation;
pub mod held;
pub mod implied;
mod interpolation;
mod intersection;
pub mod lanes;
mod limit;
pub mod multiscale;
pub mod quality;
#[cfg(test)]
mod random;
mod ratios;
pub mod recovery;
mod scalar;
mod source;
pub mod statistics;
pub mod summary;
pub mod tensor;
#[cfg(test)]
mod tests;
pub mod transfer;

pub use analytic::Analytic;
pub use background::Background;
pub use eigen::{Eigen, plane_basis};
pub use error::Error;
pub use field::Field;
pub use gradation::{Graded, grade};
pub use interpolation::Interpolation;
pub use intersection::intersect_all;
pub use limit::Limits;
pub use ratios::mean_ratios;
pub use scalar::Scalar;
pub use source::Source;
pub use statistics::{Distribution, Statistics};
pub use tensor::Sym3;
