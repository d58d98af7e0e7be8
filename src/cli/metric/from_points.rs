//! `geo-adapt metric from-points`.
use super::common::{self, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::{Files, reading};
use crate::cli::table::{Table, figure};
use crate::formats::Format;
use crate::mesh::io::{Error, Read, read_points};
use crate::mesh::vector::Vec3;
use crate::metric::field;
use crate::metric::from_points::{FromPoints, TooFew, from_points};
use crate::tasks::{Plan, Team};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Arguments of `geo-adapt metric from-points`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The points: a text file of x y z, also with commas, or the vertices of a mesh
    points: PathBuf,
    /// How many of the nearest points the ellipsoid about a vertex holds
    #[arg(long, value_name = "K", default_value_t = 12, value_parser = clap::value_parser!(u32).range(4..=100_000), allow_negative_numbers = true)]
    neighbours: u32,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Reads the points: of a mesh the vertices, by its ending.
fn points(team: Team<'_>, path: &Path) -> Result<Read<Vec<Vec3>>, Error> {
    if Format::of(path).is_ok_and(|format| !format.is_fields()) {
        let Read { content, notices } = reading::mesh(team, path)?;
        return Ok(Read { content: content.mesh.vertices, notices });
    }
    read_points(path)
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_meshes([&arguments.mesh]).reads_any([&arguments.points]))?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(run, team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let Read { content: points, notices } = points(team, &arguments.points)?;
    run.note(&notices);
    let found = from_points(team, &mesh.vertices, &points, arguments.neighbours as usize);
    let FromPoints { logs, duplicates, flat } = found.map_err(|TooFew { distinct }| {
        let (name, neighbours) = (arguments.points.display(), arguments.neighbours);
        format!("{name}: {distinct} different points, fewer than the {neighbours} neighbours; give more points or a smaller --neighbours")
    })?;
    if duplicates > 0 {
        run.note(&[format!("{duplicates} points are there more than once, and count once")]);
    }
    if flat > 0 {
        run.note(&[format!("at {flat} vertices the nearest points lie in a plane, nearly: sizes across are 1/1000 of the greatest distance; give more --neighbours, or bound them by `metric limit --hmin`")]);
    }
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let mut table = Table::new();
    table.row("points", points.len());
    table.row("vertices", logs.len());
    table.row("complexity", figure(field::complexity_of_logs(team, mesh, &logs)));
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}
