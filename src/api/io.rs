//! Meshes, metrics and fields in libMeshb's files: .mesh and .meshb, .sol and .solb, told apart by their content when read and by the
//! extension when written. Every file is written beside its place and then renamed.
//!
//! ```
//! use geo_adapt::{Sym3, io};
//! # let folder = std::env::temp_dir().join(format!("geo-adapt-io-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//!
//! let path = folder.join("sizes.solb");
//! io::write_metric(&path, &[[4.0, 0.0, 4.0, 0.0, 0.0, 100.0]])?;
//! assert_eq!(io::read_metric(&path, 1)?.content, [Sym3::diagonal(4.0, 4.0, 100.0)]);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
pub use crate::mesh::io::{
    Error, FieldKind, Read, Solution, SolutionField, read_mesh, read_solution, write_mesh, write_solution,
};

use crate::metric::{Field, Sym3};
use std::path::Path;

/// Reads a metric of a mesh of so many vertices: a .sol or .solb file with one field, of symmetric
/// tensors, all positive definite, or of scalars, which are isotropic sizes h and become h⁻² I.
///
/// # Errors
/// When the file cannot be read, has other fields or another number of vertices, or when a tensor is not positive definite, or a size
/// not positive.
pub fn read_metric(path: &Path, vertices: usize) -> Result<Read<Vec<Sym3>>, crate::metric::Error> {
    let Read { content, notices } = Field::read(path, vertices)?;
    Ok(Read { content: content.metrics, notices })
}

/// Writes a metric, a tensor a vertex, as .sol or .solb.
///
/// # Errors
/// As [`write_solution`].
pub fn write_metric<M: Copy + Into<Sym3>>(path: &Path, metric: &[M]) -> Result<(), Error> {
    let terms: Vec<[f64; 6]> = metric.iter().map(|&metric| metric.into().0).collect();
    write_solution(path, &Solution::metric(&terms))
}
