//! Where the metric of a run comes from: a file, one size, an analytic field, a field whose multiscale metric is made, or the terms of a goal.
use crate::cli::metric::fields;
use crate::cli::metric::goal::Asked;
use crate::metric::Analytic;
use clap::ArgGroup;
use std::path::PathBuf;

/// The metric: exactly one of the five.
#[derive(Clone, clap::Args)]
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
    /// The terms of a goal, a TOML file as `metric goal --terms` has it, whose metric is made for --complexity or --vertices
    #[arg(long, value_name = "TERMS.toml", requires = "amount")]
    pub goal: Option<PathBuf>,
}

impl FieldArguments {
    /// Whether the metric is made of fields on the mesh.
    pub fn is_of_fields(&self) -> bool {
        !self.field.is_empty() || self.goal.is_some()
    }

    /// The terms of --goal.
    ///
    /// # Errors
    /// As [`Asked::read`].
    pub fn terms(&self) -> Result<Option<Asked>, String> {
        self.goal.as_deref().map(Asked::read).transpose()
    }
}

/// What a metric is made of.
const MADE: &str = "made_of";

/// Allows the options of the metrics that are made, and of the geometry's metric, with --field or --goal only, and forbids bounds of the sizes
/// with an analytic field.
pub fn only_with_field(command: clap::Command) -> clap::Command {
    let command = command.group(ArgGroup::new(MADE).args(["field", "goal"]));
    let options = fields::OF_MADE.into_iter().chain(["segments", "feature_cells", "no_geometry"]);
    let command = options.fold(command, |command, name| command.mut_arg(name, |option| option.requires(MADE)));
    let of_field = fields::OF_FIELD.into_iter();
    // What conflicts with what is given is not asked for: so it does not suffice that they require --field.
    let only = |option: clap::Arg| option.requires("field").conflicts_with("goal");
    let command = of_field.fold(command, |command, name| command.mut_arg(name, only));
    let bounds = fields::BOUNDS.into_iter().chain(["local", "walls", "limit_chords"]);
    bounds.fold(command, |command, name| command.mut_arg(name, |option| option.conflicts_with("analytic")))
}
