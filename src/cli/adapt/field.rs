//! Where the metric of a run comes from: a file, an analytic field, or a field whose multiscale metric is made here.
use super::Arguments;
use crate::adapt;
use crate::cli::metric::fields::Made;
use crate::mesh::TetMesh;
use crate::mesh::adjacency::MatchedFaces;
use crate::metric::multiscale::Measure;
use crate::metric::{Analytic, Background, Field, Source};
use crate::tasks::Team;
use std::path::PathBuf;
use std::sync::Arc;

/// The metric: exactly one of the three.
#[derive(clap::Args)]
#[group(required = true, multiple = false)]
pub struct FieldArguments {
    /// The metric at the vertices of the mesh: .sol or .solb
    #[arg(long, value_name = "FILE")]
    pub metric: Option<PathBuf>,
    /// An analytic metric: linear, polar-1 or polar-2
    #[arg(long, value_name = "NAME")]
    analytic: Option<Analytic>,
    /// A field at the vertices, .sol or .solb, whose multiscale metric is made for --complexity; again for each further step in time
    #[arg(long, value_name = "FIELD", requires = "complexity")]
    pub field: Vec<PathBuf>,
}

/// Lets the options of the multiscale metric be given with --field only.
pub fn only_with_field(command: clap::Command) -> clap::Command {
    let options = crate::cli::metric::fields::OPTIONS;
    options.into_iter().fold(command, |command, name| command.mut_arg(name, |option| option.requires("field")))
}

/// The metric's source: the analytic field, or the input mesh as background with the file's metric or with the one that was made, and
/// what was done to make it.
pub fn source(
    team: Team<'_>,
    arguments: &Arguments,
    mesh: &Arc<TetMesh>,
    faces: MatchedFaces,
    notices: &mut Vec<String>,
) -> Result<(Source, Option<Made>), Box<dyn std::error::Error>> {
    let FieldArguments { metric, analytic, field } = &arguments.field;
    if let Some(field) = *analytic {
        return Ok((Source::Analytic { field, log_scale: 0.0 }, None));
    }
    if mesh.tets.is_empty() {
        return Err(format!("{}: {}", arguments.mesh.display(), adapt::Error::Empty).into());
    }
    let (logs, made) = if let Some(path) = metric {
        let read = Field::read_logs(team, path, mesh.vertices.len())?;
        notices.extend(read.notices);
        (read.content, None)
    } else {
        let complexity = arguments.complexity.ok_or("--field needs a --complexity")?;
        let wanted = (complexity, Measure::Between);
        let (logs, made) = arguments.multiscale.make(team, mesh, field, wanted, notices)?;
        (logs, Some(made))
    };
    Ok((Source::Background(Background::on(team, Arc::clone(mesh), faces, logs)), made))
}
