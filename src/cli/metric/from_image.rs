//! `geo-adapt metric from-image`.
use super::common::{self, Amount, GradationArgument, LimitArguments, OutputArgument, RunArguments};
use crate::cli::Outcome;
use crate::cli::files::Files;
use crate::cli::table::Table;
use crate::image::{self, Image, Smoothed};
use crate::mesh::TetMesh;
use crate::metric::from_image::{Wish, of_borders, of_hessians};
use crate::metric::multiscale::five_digits;
use crate::metric::summary::Summary;
use crate::metric::{Limits, Sym3};
use crate::tasks::{GRAIN, Plan, Team};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `geo-adapt metric from-image`.
#[derive(clap::Args)]
#[command(defer(common::needs_amount))]
pub struct Arguments {
    /// The image: .nrrd or .nhdr, of 3 axes. Integers are labels: sizes are small at borders between them. Floating-point values are grey:
    /// sizes follow their second derivatives. Without --hmin no size is below half a voxel
    image: PathBuf,
    /// The mesh, in the image's space, in any format that `convert` reads. Its vertices are where the image is looked at: it should resolve what matters
    #[arg(long, value_name = "MESH")]
    mesh: PathBuf,
    #[command(flatten)]
    amount: Amount,
    /// Integers are grey values too, not labels
    #[arg(long)]
    grey: bool,
    /// Standard deviation of the Gaussian that smooths grey values first, voxels; 0 for none
    #[arg(long, value_name = "VOXELS", value_parser = deviation, default_value_t = 1.5, allow_negative_numbers = true)]
    smooth: f64,
    #[command(flatten)]
    limits: LimitArguments,
    #[command(flatten)]
    gradation: GradationArgument,
    #[command(flatten)]
    to: OutputArgument,
    #[command(flatten)]
    run: RunArguments,
}

/// Parses a standard deviation.
fn deviation(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=100.0).contains(&value) => Ok(value),
        _ => Err("give a number of voxels from 0 to 100".into()),
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let Arguments { run, to, .. } = arguments;
    let target = to.target(&mut Files::new().reads_images([&arguments.image]).reads_meshes([&arguments.mesh]))?;
    let limits = arguments.limits.limits()?;
    let pool = run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let data = common::mesh(run, team, &arguments.mesh)?;
    let mesh = &data.mesh;
    let image = image::read(&arguments.image)?;
    let diameter = common::diameter(mesh);
    let hmax = limits.hmax.unwrap_or(diameter).min(diameter);
    let half_voxel = 0.5 * image.frame.spacings().into_iter().fold(f64::INFINITY, f64::min);
    // The image has nothing finer.
    let limits = Limits { hmin: Some(limits.hmin.unwrap_or(half_voxel.min(hmax))), hmax: Some(hmax), ..limits };
    let wish = Wish { complexity: arguments.amount.needed()?, limits, gradation: arguments.gradation.ratio() };
    let outside = outside(team, &image, mesh);
    if outside > 0 {
        run.note(&[format!("{outside} vertices lie outside the image and see its border")]);
    }
    let is_grey = arguments.grey || !image.kind.is_integer();
    let logs = if is_grey {
        grey(team, arguments, &image, mesh, &wish)
    } else {
        labels(team, arguments, &image, mesh, &wish)
    }?;
    common::write_logs(run, team, &target, &logs, common::on(&data))?;
    let mut table = Table::new();
    table.row("the image is", if is_grey { "grey" } else { "of labels" });
    super::show::rows(&mut table, &Summary::of(team, mesh, &logs), None);
    run.print(table.text())?;
    Ok(ExitCode::SUCCESS)
}

/// ln M of a grey image.
fn grey(
    team: Team<'_>,
    arguments: &Arguments,
    image: &Image,
    mesh: &TetMesh,
    wish: &Wish,
) -> Result<Vec<Sym3>, String> {
    let name = arguments.image.display();
    let smoothed = Smoothed::new(team, image, arguments.smooth).map_err(|voxel| {
        let [x, y, _] = image.sizes;
        let [i, j, k] = [voxel % x, voxel / x % y, voxel / (x * y)];
        format!("{name}: voxel ({i}, {j}, {k}) is no finite number; replace it")
    })?;
    let hessians = team.map(GRAIN / 16, mesh.vertices.len(), |v| Sym3(smoothed.hessian(mesh.vertices[v])));
    let logs = of_hessians(team, mesh, &hessians, smoothed.rounding(), wish)
        .map_err(|error| unreachable(arguments, error.nearest))?;
    logs.ok_or_else(|| {
        format!(
            "{name}: its second derivatives are 0 at all vertices of {}; do both lie in the same space?",
            arguments.mesh.display()
        )
    })
}

/// ln M of an image of labels.
fn labels(
    team: Team<'_>,
    arguments: &Arguments,
    image: &Image,
    mesh: &TetMesh,
    wish: &Wish,
) -> Result<Vec<Sym3>, String> {
    let borders = image::borders(team, image);
    if borders.is_empty() {
        let name = arguments.image.display();
        return Err(format!("{name}: has no border between labels: all voxels are 0"));
    }
    of_borders(team, mesh, &borders, wish).map_err(|error| unreachable(arguments, error.nearest))
}

fn unreachable(arguments: &Arguments, nearest: f64) -> String {
    let (name, target) = (arguments.mesh.display(), arguments.amount.complexity().unwrap_or_default());
    format!(
        "{name}: a complexity of {target} cannot be reached, the nearest is {}; give another --complexity, other limits, or \
         a mesh that is finer where the image has its borders",
        five_digits(nearest)
    )
}

/// How many vertices lie farther than a voxel outside the image.
fn outside(team: Team<'_>, image: &Image, mesh: &TetMesh) -> usize {
    let is_outside = |v: &usize| {
        let index = image.frame.index(mesh.vertices[*v]);
        (0..3).any(|i| !(-1.0..=image.sizes[i] as f64).contains(&index[i]))
    };
    team.chunks(GRAIN, mesh.vertices.len(), |range| range.filter(is_outside).count()).into_iter().sum()
}
