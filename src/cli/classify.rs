//! `geo-adapt classify`.
use super::files::{Files, Outputs, reading};
use super::surface::SurfaceArguments;
use super::{Outcome, load};
use crate::geometry::classify::{Associated, Options, Report, associate, classify};
use crate::geometry::discrete::complete_boundary;
use crate::geometry::on_mesh;
use crate::tasks::{Plan, Team};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt classify`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh, in any format that `convert` reads
    mesh: PathBuf,
    /// The model: .step, .stp, .iges, .igs, .brep or .egads
    #[arg(long, value_name = "MODEL", required_unless_present = "surface")]
    pub(super) cad: Option<PathBuf>,
    #[command(flatten)]
    surface: SurfaceArguments,
    /// Where the mesh with its association goes: .mesh or .meshb; other formats that `convert` writes hold no association
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    output: PathBuf,
    /// How far a vertex may be from the model, in its units [default: 1e-6 of its diagonal, or twice what the model
    /// states for an entity]
    #[arg(long, value_name = "T", value_parser = super::positive, allow_negative_numbers = true)]
    tolerance: Option<f64>,
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let mut files = Files::new().reads_meshes([&arguments.mesh]).reads_models(&arguments.cad);
    files = files.reads_any(&arguments.surface.surface);
    let target = files.writes_mesh(&arguments.output, "-o")?;
    let pool = super::pool()?;
    let team = Team::new(&pool, Plan::default());
    let mut read = reading::mesh(team, &arguments.mesh)?;
    let (model, path) = match (&arguments.cad, &arguments.surface.surface) {
        (Some(path), _) => (load::model(path)?, path),
        (None, Some(path)) => {
            let model = arguments.surface.model(team, &mut read.notices)?;
            (model.ok_or_else(|| format!("{}: no model", path.display()))?, path)
        }
        (None, None) => return Err("give a model: --cad, or --surface".into()),
    };
    let mesh = &mut read.content.mesh;
    let added = complete_boundary(team, mesh);
    if added > 0 {
        read.notices.push(format!("{added} triangles were missing on the boundary or between regions, and were added"));
    }
    let options = Options { tolerance: arguments.tolerance, ..Options::default() };
    let (classification, report) = classify(team, mesh, &model, &options)
        .map_err(|error| format!("{} on {}: {error}", arguments.mesh.display(), path.display()))?;
    let given = std::mem::take(&mut read.content.names);
    let associated = associate(mesh, &classification);
    let known = !given.is_empty() && !associated.references_replaced;
    read.content.names = if known { given } else { on_mesh(mesh, &classification, &model) };
    let mut outputs = Outputs::new();
    let lost = outputs.mesh(team, &target, &read.content)?;
    outputs.commit()?;
    for notice in read.notices.iter().chain(&report.notices).chain(&lost) {
        crate::cli::note(notice);
    }
    super::say(&table(&report, associated))?;
    Ok(ExitCode::SUCCESS)
}

/// The report as text.
fn table(report: &Report, associated: Associated) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<10}{:>10}{:>12}{:>14}{:>16}{:>14}",
        "on", "vertices", "as in file", "by geometry", "greatest dist.", "mean dist."
    );
    for (name, dimension) in ["vertices", "edges", "faces"].iter().zip(&report.dimensions) {
        let geometry = dimension.count - dimension.from_file;
        let _ = writeln!(
            text,
            "{name:<10}{:>10}{:>12}{geometry:>14}{:>16.3e}{:>14.3e}",
            dimension.count, dimension.from_file, dimension.greatest, dimension.mean
        );
    }
    let _ = writeln!(
        text,
        "ridges: {}; triangles: {}, {} with the number of their face as reference; tolerance {:.3e}",
        report.ridges, report.triangles, report.faces_from_file, report.tolerance
    );
    for offset in report.worst.iter().take(3).filter(|offset| offset.distance > 0.0) {
        let [x, y, z] = offset.point;
        let _ = writeln!(
            text,
            "farthest: vertex {} at ({x:.6}, {y:.6}, {z:.6}), {:.3e} from {}",
            offset.vertex + 1,
            offset.distance,
            offset.entity
        );
    }
    if associated.references_replaced {
        text.push_str(
            "the triangles' references did not tell the model's faces apart: they are now the faces' numbers\n",
        );
    }
    if associated.edges_dropped > 0 {
        let _ =
            writeln!(text, "{} listed edges lie on no edge of the model and were dropped", associated.edges_dropped);
    }
    text
}
