//! `geo-adapt metric intersect`.
use super::common::{self, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::table::{Table, figure};
use crate::formats::{Dataset, Format};
use crate::mesh::io::FieldKind;
use crate::metric::{field, intersect_all};
use crate::tasks::{Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric intersect`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Two or more metrics of the same mesh: .sol or .solb, or meshes with a metric in their file. The mesh may come first, then complexities
    /// are printed
    #[arg(required = true, value_name = "[MESH] METRIC METRIC", num_args = 1..)]
    files: Vec<PathBuf>,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_meshes(&arguments.files))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let is_mesh = |path: &&PathBuf| Format::of(path).is_ok_and(|format| !format.is_fields());
    let mesh_path = arguments.files.first().filter(is_mesh);
    let data = mesh_path.map(|path| common::mesh(run, team, path)).transpose()?;
    // A mesh whose file holds a metric too is both.
    let is_metric = |data: &Dataset| data.fields.iter().any(|field| field.kind == FieldKind::SymmetricTensor);
    let is_mesh_alone = data.as_ref().is_some_and(|data| !is_metric(data));
    let paths = &arguments.files[usize::from(is_mesh_alone)..];
    let [first, others @ ..] = paths else { return Err("give two metrics at least".into()) };
    if others.is_empty() {
        return Err(
            format!("{}: one metric has nothing to be intersected with; give two at least", first.display()).into()
        );
    }
    let mesh = data.as_ref().map(|data| &data.mesh);
    let (mut logs, _) = common::all_logs(run, team, first, mesh.map(|mesh| mesh.vertices.len()))?;
    let mut table = Table::new();
    table.row("vertices", logs.len());
    let complexity = |logs: &[_]| {
        mesh.map_or(String::new(), |mesh| {
            format!(", complexity {}", figure(field::complexity_of_logs(team, mesh, logs)))
        })
    };
    table.row(&first.display().to_string(), format_args!("first{}", complexity(&logs)));
    for path in others {
        // Metrics of other numbers of vertices are of another mesh.
        let (other, _) = common::all_logs(run, team, path, Some(logs.len()))?;
        let own = complexity(&other);
        let changed = intersect_all(team, &mut logs, &other);
        table.row(&path.display().to_string(), format_args!("changes {changed} vertices{own}"));
    }
    if mesh.is_some() {
        table.row("intersection", &complexity(&logs)[2..]);
    }
    common::write_logs(run, team, &target, &logs, data.as_ref().and_then(common::on))?;
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
