//! What the subcommands of `metric` share: arguments to flatten, reading with notices, the output.
//!
//! Metric files hold the six terms of M at each vertex in libMeshb's order 11 12 22 13 23 33, in 1/length².
use crate::adapt::meeting::VERTICES_PER_COMPLEXITY;
use crate::cli::amount::bytes;
use crate::cli::files::reading::{self, Carrier, Fields};
use crate::cli::files::{Files, On, Outputs, Target, room};
use crate::cli::terminal::PrintError;
use crate::formats::Dataset;
use crate::geometry::discrete::complete_boundary;
use crate::mesh::TetMesh;
use crate::mesh::io::Read;
use crate::mesh::ranges::Scratch;
use crate::mesh::vector::distance;
use crate::metric::{Limits, Sym3, field, held};
use crate::tasks::{Pool, Team};
use std::path::{Path, PathBuf};

/// An error that ends the subcommand with code 2.
pub type Failure = Box<dyn std::error::Error>;

/// Threads.
#[derive(clap::Args)]
pub struct RunArguments {
    /// Threads [default: all cores]. The result is the same bit for bit on any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true)]
    threads: Option<u16>,
}

impl RunArguments {
    /// The threads that are asked for; `Team::new(&pool, Plan::default())` works on them.
    pub fn pool(&self) -> Result<Pool, Failure> {
        Ok(Pool::new(self.threads.map_or_else(super::super::cores, usize::from))?)
    }

    /// Shows notes on standard error, unless quiet.
    pub fn note(&self, notices: &[String]) {
        notices.iter().for_each(crate::cli::note);
    }

    /// Prints a table, unless quiet.
    pub fn print(&self, text: &str) -> Result<(), PrintError> {
        super::super::say(text)
    }
}

/// How much memory there is for a mesh that is larger.
#[derive(clap::Args)]
pub struct MemoryArguments {
    /// Works from the files, by slices, within this memory: 500MB, 4GiB. The result is the same. For .meshb and .solb, to .solb
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub memory: Option<u64>,
    /// Where what does not fit into the memory lies [default: beside the output]. Nothing of it stays
    #[arg(long, value_name = "FOLDER", requires = "memory")]
    scratch: Option<PathBuf>,
}

impl MemoryArguments {
    /// The scratch folder of a run with this output, in which there is room for so many bytes.
    pub fn scratch(&self, output: &Path, bytes: f64) -> Result<Scratch, String> {
        let beside = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = self.scratch.as_deref().unwrap_or(beside);
        if !folder.is_dir() {
            return Err(format!("{}: there is no folder of this name; give --scratch a folder", folder.display()));
        }
        match room::lacking_bytes(folder, bytes) {
            Some(why) => Err(format!("{why}; --scratch chooses a folder on another disk")),
            None => Ok(Scratch::within(folder)),
        }
    }
}

/// Where the metric goes.
#[derive(clap::Args)]
pub struct OutputArgument {
    /// Where the metric goes: .sol or .solb; or with the mesh: .vtu, or another format that `convert` knows and that holds fields
    #[arg(short, long, visible_short_alias = 'x', value_name = "OUT")]
    pub output: PathBuf,
}

impl OutputArgument {
    /// The file, among those of the command.
    pub fn target(&self, files: &mut Files) -> Result<Target, String> {
        files.writes_fields(&self.output, "-o")
    }
}

/// Writes M = exp of these logarithms, and tells what the format cannot carry.
pub fn write_logs(run: &RunArguments, team: Team<'_>, to: &Target, logs: &[Sym3], on: On<'_>) -> Result<(), Failure> {
    let mut outputs = Outputs::new();
    let lost = outputs.logs(team, to, logs, on)?;
    outputs.commit()?;
    run.note(&lost);
    Ok(())
}

/// A mesh that fields or metrics are written with.
pub fn on(data: &Dataset) -> On<'_> {
    Some(data)
}

/// How much the metric is to ask for.
#[derive(Clone, clap::Args)]
#[group(id = "amount", multiple = false)]
pub struct Amount {
    /// Scale the metric to this complexity ∫ √det M, the volume in the metric: about half the number of vertices
    #[arg(long, value_name = "C", value_parser = super::super::positive, allow_negative_numbers = true)]
    pub complexity: Option<f64>,
    /// Scale the metric to so many vertices: a complexity of N/2. `adapt` counts, and tries again where it is off by more than 10 %
    #[arg(long, value_name = "N", value_parser = super::super::positive, allow_negative_numbers = true)]
    pub vertices: Option<f64>,
}

impl Amount {
    /// The complexity that is asked for, at first.
    pub fn complexity(&self) -> Option<f64> {
        self.complexity.or(self.vertices.map(|vertices| vertices / VERTICES_PER_COMPLEXITY))
    }

    /// The complexity of a command that needs one.
    pub fn needed(&self) -> Result<f64, Failure> {
        self.complexity().ok_or_else(|| "give a --complexity or --vertices".into())
    }

    /// The option that was given.
    pub fn name(&self) -> &'static str {
        if self.vertices.is_some() { "--vertices" } else { "--complexity" }
    }
}

/// Says that one of the two is needed.
pub fn needs_amount(command: clap::Command) -> clap::Command {
    command.mut_group("amount", |group| group.required(true))
}

/// Bounds of the sizes.
#[derive(Clone, clap::Args)]
pub struct LimitArguments {
    /// Least size, in model units
    #[arg(long, value_name = "H", value_parser = super::super::positive, allow_negative_numbers = true)]
    hmin: Option<f64>,
    /// Greatest size, in model units
    #[arg(long, value_name = "H", value_parser = super::super::positive, allow_negative_numbers = true)]
    hmax: Option<f64>,
    /// Greatest ratio of the sizes at a vertex: greater sizes are cut to so many times the least
    #[arg(long, value_name = "A", value_parser = at_least_one, allow_negative_numbers = true)]
    aspect_ratio: Option<f64>,
}

impl LimitArguments {
    /// No limits.
    pub fn none() -> Self {
        Self { hmin: None, hmax: None, aspect_ratio: None }
    }

    /// The limits; refuses a least size above the greatest.
    pub fn limits(&self) -> Result<Limits, String> {
        let Self { hmin, hmax, aspect_ratio } = *self;
        if let (Some(hmin), Some(hmax)) = (hmin, hmax)
            && hmin > hmax
        {
            return Err(format!("--hmin {hmin} is above --hmax {hmax}; give a least size below the greatest"));
        }
        Ok(Limits { hmin, hmax, aspect_ratio })
    }
}

/// How fast sizes may grow.
#[derive(Clone, clap::Args)]
pub struct GradationArgument {
    /// Greatest growth of the sizes from an edge to the next (Alauzet 2010, mixed space), or `off` [default: 1.5]
    #[arg(long, value_name = "R", value_parser = gradation, allow_negative_numbers = true)]
    gradation: Option<Gradation>,
}

/// Growth of the sizes where none is given.
const USUAL_GROWTH: f64 = 1.5;

impl GradationArgument {
    /// The ratio; none when off.
    pub fn ratio(&self) -> Option<f64> {
        self.gradation.map_or(Some(USUAL_GROWTH), |gradation| gradation.0)
    }

    /// No bound on growth.
    pub fn off() -> Self {
        Self { gradation: Some(Gradation(None)) }
    }

    /// Whether one was given.
    pub fn is_given(&self) -> bool {
        self.gradation.is_some()
    }
}

/// A ratio, or off. (A type of its own, since clap would take an Option for an argument that may be left out.)
#[derive(Clone, Copy)]
struct Gradation(Option<f64>);

fn gradation(text: &str) -> Result<Gradation, String> {
    if text == "off" { Ok(Gradation(None)) } else { growth(text).map(|ratio| Gradation(Some(ratio))) }
}

/// Parses a ratio of growth.
pub fn growth(text: &str) -> Result<f64, String> {
    match super::super::positive(text) {
        Ok(ratio) if ratio > 1.0 => Ok(ratio),
        _ => Err("give a number above 1, such as 1.5".into()),
    }
}

/// Parses a number that is 1 or more.
fn at_least_one(text: &str) -> Result<f64, String> {
    match super::super::positive(text) {
        Ok(ratio) if ratio >= 1.0 => Ok(ratio),
        _ => Err("give 1 or more".into()),
    }
}

/// Reads a volume mesh, its names, and the fields of its file, and shows the notices.
pub fn mesh(run: &RunArguments, team: Team<'_>, path: &Path) -> Result<Dataset, Failure> {
    let read = reading::mesh(team, path)?;
    run.note(&read.notices);
    if read.content.mesh.tets.is_empty() {
        return Err(format!("{}: no tetrahedra: a volume mesh is needed", path.display()).into());
    }
    Ok(read.content)
}

/// Adds the triangles that a mesh lacks on its boundary and between regions, and says so.
pub fn close(run: &RunArguments, team: Team<'_>, data: &mut Dataset) {
    let added = complete_boundary(team, &mut data.mesh);
    if added > 0 {
        run.note(&[format!("{added} triangles were missing on the boundary or between regions, and were added")]);
    }
}

/// Reads the fields at the vertices of a mesh that an argument names, one at least, and shows the notices.
pub fn fields(run: &RunArguments, team: Team<'_>, asked: &Path, of: Carrier<'_>) -> Result<Fields, Failure> {
    let Read { content, notices } = reading::fields(team, asked, of)?;
    run.note(&notices);
    let name = asked.display();
    let (found, vertices) = (content.solution.vertices, of.vertices.len());
    if found != vertices {
        let mesh = of.path.display();
        return Err(format!(
            "{name}: values at {found} vertices, but {mesh} has {vertices}; give the mesh they belong to"
        )
        .into());
    }
    if content.solution.fields.is_empty() {
        return Err(format!("{name}: no field at the vertices").into());
    }
    Ok(content)
}

/// Reads ln M at the vertices of a mesh, and shows the notices.
pub fn logs(run: &RunArguments, team: Team<'_>, asked: &Path, of: Carrier<'_>) -> Result<Vec<Sym3>, Failure> {
    let (Read { content, notices }, _) = reading::logs(team, asked, of, Some(of.vertices.len()))?;
    run.note(&notices);
    Ok(content)
}

/// Reads ln M at the vertices of a mesh that is not read, but for the one that the file holds too. `vertices`, where that is known.
pub fn all_logs(
    run: &RunArguments,
    team: Team<'_>,
    asked: &Path,
    vertices: Option<usize>,
) -> Result<(Vec<Sym3>, Option<Dataset>), Failure> {
    let none = Carrier { path: asked, vertices: &[], fields: &[] };
    let (Read { content, notices }, mesh) = reading::logs(team, asked, none, vertices)?;
    run.note(&notices);
    Ok((content, mesh))
}

/// The complexity of ln M on a mesh (`path` is for the error): positive.
pub fn complexity(team: Team<'_>, path: &Path, mesh: &TetMesh, logs: &[Sym3]) -> Result<f64, String> {
    held::check(team, logs.len(), |v| logs[v]).map_err(|error| format!("{}: {error}", path.display()))?;
    let complexity = field::complexity_of_logs(team, mesh, logs);
    if complexity > 0.0 && complexity.is_finite() {
        return Ok(complexity);
    }
    Err(format!(
        "{}: the complexity there is {complexity}; are all tetrahedra positive? (geo-adapt inspect tells)",
        path.display()
    ))
}

/// The diagonal of the box around the vertices.
pub fn diameter(mesh: &TetMesh) -> f64 {
    let corner = |f: fn(f64, f64) -> f64| {
        mesh.vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
    };
    distance(corner(f64::min), corner(f64::max))
}
