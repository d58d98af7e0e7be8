//! The tables of a configuration.
use super::goal::Until;
use crate::metric::recovery::Recovery;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What `surface` says for the first mesh itself.
pub const FIRST: &str = "first";

/// `[mesh]`: a mesh that is there, a model that `geo-adapt bootstrap` makes one of, or the unit cube.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    /// A mesh: .mesh, .meshb, or what `geo-adapt convert` reads.
    pub file: Option<PathBuf>,
    /// The unit cube, so many cells along an edge: to try the loop with nothing at hand.
    pub cube: Option<u32>,
    /// The model of which the first mesh is made.
    pub bootstrap: Option<PathBuf>,
    /// The model that the boundary of `file` lies on.
    pub cad: Option<PathBuf>,
    /// Instead of `cad`, the surface that the boundary of `file` lies on, as `adapt --surface` has it. "first" is the first mesh.
    pub surface: Option<PathBuf>,
    /// The space around the model, as `bootstrap --far-field` has it.
    pub far_field: Option<String>,
    /// The direction in which the model is one half: x, y or z.
    pub symmetry: Option<String>,
    /// Further words for `geo-adapt bootstrap`.
    #[serde(default)]
    pub options: Vec<String>,
}

/// An entry of `[probes]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Probe {
    /// A field, or of a vector `U` one component `U:x` or its length `U:norm`.
    pub field: String,
    /// Where, model units.
    pub at: [f64; 3],
}

/// `[metric]`: the fields whose interpolation error is made small, and bounds of the sizes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metric {
    /// Names of the solver's fields; of a vector `U` one component `U:x` or its length `U:norm`. All scalars without.
    #[serde(default)]
    pub fields: Vec<String>,
    /// The p of the L^p norm.
    pub norm: Option<NormWord>,
    /// How second derivatives are recovered: fit, l2 or jumps.
    pub hessian: Option<RecoveryWord>,
    /// Greatest growth of the sizes from an edge to the next, or "off".
    pub gradation: Option<Growth>,
    /// Least size, model units.
    pub hmin: Option<f64>,
    /// Greatest size, model units.
    pub hmax: Option<f64>,
    /// Greatest ratio of the sizes at a vertex.
    pub aspect_ratio: Option<f64>,
    /// Greatest sizes on some surfaces and regions, as `adapt --local` has them: "wall:h=0.01".
    #[serde(default)]
    pub local: Vec<String>,
    /// Walls and the layers along them, as `adapt --wall` has them: "wing:yplus=1,re=6e6,length=1". They are made anew on the mesh of each cycle.
    #[serde(default)]
    pub walls: Vec<String>,
    /// Whether the sizes that the geometry asks for are intersected; by default where there is a model.
    pub geometry: Option<bool>,
    /// Segments for a radian of curvature.
    pub segments: Option<f64>,
    /// Cells across thin parts and gaps.
    pub feature_cells: Option<f64>,
}

/// The p of a norm: a number, or "inf".
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "give a number from 1 on, or \"inf\"")]
pub enum NormWord {
    /// p.
    Number(f64),
    /// inf.
    Word(String),
}

/// A growth: a number, or "off".
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "give a number above 1, or \"off\"")]
pub enum Growth {
    /// The ratio.
    Number(f64),
    /// off.
    Word(String),
}

impl std::fmt::Display for NormWord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(p) => p.fmt(f),
            Self::Word(word) => word.fmt(f),
        }
    }
}

impl std::fmt::Display for Growth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(ratio) => ratio.fmt(f),
            Self::Word(word) => word.fmt(f),
        }
    }
}

/// How Hessians are recovered, by the words of the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecoveryWord {
    /// [`Recovery::Fit`].
    Fit,
    /// [`Recovery::L2`].
    L2,
    /// [`Recovery::Jumps`].
    Jumps,
}

impl RecoveryWord {
    /// As the command line spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => Recovery::Fit,
            Self::L2 => Recovery::L2,
            Self::Jumps => Recovery::Jumps,
        }
        .name()
    }
}

/// `[schedule]`: complexities, and when the loop ends: with the first of `cycles`, `max_complexity` and `converged` that is reached.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Schedule {
    /// The complexity of the first cycle: about half the number of vertices.
    pub complexity: f64,
    /// By which it is multiplied.
    #[serde(default = "twice")]
    pub factor: f64,
    /// Cycles at each complexity.
    #[serde(default = "one")]
    pub every: u32,
    /// The greatest; after `every` cycles with it the loop ends.
    pub max_complexity: Option<f64>,
    /// Adaptations at most.
    pub cycles: Option<u32>,
    /// Ends when a functional does not change any more.
    pub converged: Option<Converged>,
    /// Ends when the estimate of the goal's error is small: "error(drag) < 1e-4".
    pub until: Option<Until>,
}

fn twice() -> f64 {
    2.0
}

fn one() -> u32 {
    1
}

/// `[schedule.converged]`: a functional whose relative change stays below `change` over so many cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Converged {
    /// The functional, as the solver calls it.
    pub functional: String,
    /// Greatest relative change between a cycle and the next.
    pub change: f64,
    /// Cycles in a row.
    #[serde(default = "two")]
    pub cycles: u32,
}

fn two() -> u32 {
    2
}

/// `[adapt]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adapt {
    /// Processes: above 1 the mesh is adapted part by part, and mpirun starts them.
    pub processes: Option<u32>,
    /// Threads of each process; those of the loop without, shared out.
    pub threads: Option<u16>,
    /// Memory of each process, as `adapt --memory` has it: "4GiB". With it the mesh is adapted part by part by one process, too.
    pub memory: Option<String>,
    /// The folder for parts that do not fit into the memory. Without, it is in that of the step, and goes with it.
    pub scratch: Option<PathBuf>,
    /// Further words for `geo-adapt adapt`, such as ["--freeze", "inlet"].
    #[serde(default)]
    pub options: Vec<String>,
}

impl Adapt {
    /// Processes, at least 1.
    pub fn processes(&self) -> u32 {
        self.processes.unwrap_or(1)
    }

    /// Whether the mesh is adapted part by part, which gives another mesh, by however many processes.
    pub fn is_by_parts(&self) -> bool {
        self.processes() > 1 || self.memory.is_some()
    }
}

/// `[transfer]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// How.
    #[serde(default)]
    pub method: TransferMethod,
}

/// How a solution comes to the next mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TransferMethod {
    /// Linear interpolation.
    #[default]
    Interpolate,
    /// So that integrals stay.
    Conservative,
    /// Not at all: each solve begins anew.
    None,
}

/// `[output]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// The folder of the loop; by default the name of the configuration, ending in .cycle.
    pub folder: Option<PathBuf>,
    /// Whether pictures are drawn of the mesh of each complexity.
    #[serde(default = "yes")]
    pub pictures: bool,
    /// The plane of the second picture, as `view --cut` has it: "x=0.5". Through the middle of the box without.
    pub cut: Option<String>,
    /// Azimuth and elevation of the camera, degrees.
    pub view: Option<[f64; 2]>,
    /// What is in the middle, model units; of the surface only where nothing is hidden.
    pub at: Option<[f64; 3]>,
    /// So many times larger than what fits; likewise.
    pub zoom: Option<f64>,
    /// Surfaces that are not shown, by reference.
    #[serde(default)]
    pub hide: Vec<i32>,
}

fn yes() -> bool {
    true
}

impl Default for Output {
    fn default() -> Self {
        Self { folder: None, pictures: true, cut: None, view: None, at: None, zoom: None, hide: Vec::new() }
    }
}
