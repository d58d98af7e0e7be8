//! Where the metric of a run comes from: a file, one size, an analytic field, or a field whose multiscale metric is made.
use crate::cli::metric::fields;
use crate::metric::Analytic;
use std::path::PathBuf;

/// The metric: exactly one of the four.
#[derive(clap::Args)]
#[group(required = true, multiple = false)]
pub struct FieldArguments {
    /// The metric at the vertices of the mesh, .sol or .solb, or the name of one in the mesh's file: symmetric tensors, or scalars, which are
    /// isotropic sizes
    #[arg(long, value_name = "FILE")]
    pub metric: Option<PathBuf>,
    /// The same size everywhere, in all directions, in model units
    #[arg(long, value_name = "H", value_parser = crate::cli::positive, allow_negative_numbers = true, conflicts_with = "amount")]
    pub size: Option<f64>,
    /// An analytic metric: linear, polar-1 or polar-2
    #[arg(long, value_name = "NAME")]
    pub analytic: Option<Analytic>,
    /// A field at the vertices whose multiscale metric is made for --complexity or --vertices: .sol, .solb, a restart of SU2 (.csv, .dat), or
    /// the name of a field in the mesh's file; again for each further step in time
    #[arg(long, value_name = "FIELD", requires = "amount")]
    pub field: Vec<PathBuf>,
}

/// Allows the options of the multiscale metric and of the geometry's metric with --field only, and forbids bounds of the sizes with an
/// analytic field.
pub fn only_with_field(command: clap::Command) -> clap::Command {
    let options = fields::OPTIONS.into_iter().chain(["segments", "feature_cells", "no_geometry"]);
    let command = options.fold(command, |command, name| command.mut_arg(name, |option| option.requires("field")));
    let bounds = fields::BOUNDS.into_iter().chain(["local", "walls", "limit_chords"]);
    bounds.fold(command, |command, name| command.mut_arg(name, |option| option.conflicts_with("analytic")))
}
