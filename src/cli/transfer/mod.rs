//! `geo-adapt transfer`.
mod in_memory;
mod of_files;
mod report;

pub(super) use in_memory::{components, rows};

use super::Outcome;
use super::figures::FigureArguments;
use super::files::{Files, JSON};
use super::metric::common::{MemoryArguments, OutputArgument, RunArguments};
use crate::tasks::{Plan, Team};
use crate::transfer::{Error, Keep, Which};
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Arguments of `geo-adapt transfer`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The mesh that has the fields, in any format that `convert` reads
    old_mesh: PathBuf,
    /// The fields at its vertices: .sol, .solb, a restart of SU2 (.csv, .dat), the mesh again where its file holds them, or the name of one of
    /// these
    old_fields: PathBuf,
    /// The mesh that gets them
    new_mesh: PathBuf,
    #[command(flatten)]
    to: OutputArgument,
    /// Keep the integral of each value over the mesh, with no new extremum, instead of interpolating. Where the meshes differ in volume
    /// (curved boundaries) `mean` keeps the integral by the volume, and a constant one; `mass` the integral, as far as no new extremum comes of it
    #[arg(long, value_name = "KEEP", num_args = 0..=1, require_equals = true, default_missing_value = "mean")]
    conservative: Option<Kept>,
    /// The file is a metric: interpolate its logarithm, so that sizes between two are their geometric mean
    #[arg(long, conflicts_with = "conservative")]
    metric: bool,
    #[command(flatten)]
    memory: MemoryArguments,
    #[command(flatten)]
    figures: FigureArguments,
    #[command(flatten)]
    run: RunArguments,
}

/// What a conservative transfer keeps where the volumes differ.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kept {
    /// The integral by the volume of the mesh
    Mean,
    /// The integral
    Mass,
}

impl Kept {
    fn keep(self) -> Keep {
        match self {
            Self::Mean => Keep::Mean,
            Self::Mass => Keep::Mass,
        }
    }
}

/// Runs the subcommand.
pub fn run(arguments: &Arguments) -> Outcome {
    let start = Instant::now();
    let mut files = Files::new().reads_meshes([&arguments.old_mesh, &arguments.new_mesh]);
    files = files.reads_fields([&arguments.old_fields], &arguments.old_mesh);
    let target = arguments.to.target(&mut files)?;
    let json = arguments.figures.target(&mut files, JSON)?;
    let pool = arguments.run.pool()?;
    let team = Team::new(&pool, Plan::default());
    let (mut outputs, report) = match arguments.memory.memory {
        Some(memory) => arguments.of_files(team, &target, memory, start)?,
        None => arguments.in_memory(team, &target, start)?,
    };
    let Some(report) = report else {
        outputs.commit()?;
        return Ok(ExitCode::SUCCESS);
    };
    outputs.json(json.as_ref(), &report)?;
    outputs.commit()?;
    arguments.figures.print(&report, || report.text())?;
    Ok(ExitCode::SUCCESS)
}

impl Arguments {
    fn method(&self) -> &'static str {
        match self.conservative {
            Some(Kept::Mean) => "conservative, the mean kept",
            Some(Kept::Mass) => "conservative, the integral kept",
            None if self.metric => "interpolation of the metric",
            None => "linear interpolation",
        }
    }

    /// An error of the transfer, with the file that it is about.
    fn named(&self, error: &Error) -> String {
        let (Error::Inverted { mesh, .. } | Error::NoVolume(mesh)) = error;
        format!("{}: {error}", self.path(*mesh).display())
    }

    fn path(&self, mesh: Which) -> &Path {
        if mesh == Which::Old { &self.old_mesh } else { &self.new_mesh }
    }
}
