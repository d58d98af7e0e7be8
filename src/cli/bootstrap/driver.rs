//! The meshers that we can start, and where they are looked for.
use super::{gmsh, netgen};
use std::path::{Path, PathBuf};

/// The virtual environment that scripts/setup.sh makes for them, from the root of the project.
const ENVIRONMENT: &str = ".venv/mesher/bin";

/// Which meshers may be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Choice {
    /// gmsh, then netgen
    #[default]
    Auto,
    /// gmsh only
    Gmsh,
    /// netgen only
    Netgen,
}

/// What one run of a mesher is to do.
#[derive(Clone, Copy)]
pub enum Rung {
    /// gmsh, with its numbers of the algorithms in two and in three dimensions.
    Gmsh { surface: u32, volume: u32, finer: f64 },
    /// netgen.
    Netgen { finer: f64 },
}

/// What is tried in turn. gmsh: 6 is frontal-Delaunay, 5 Delaunay, 1 MeshAdapt; in three dimensions 1 is Delaunay, 10 HXT, 4 frontal.
const RUNGS: [Rung; 9] = [
    Rung::Gmsh { surface: 6, volume: 1, finer: 1.0 },
    Rung::Gmsh { surface: 5, volume: 1, finer: 1.0 },
    Rung::Gmsh { surface: 6, volume: 10, finer: 1.0 },
    Rung::Gmsh { surface: 1, volume: 1, finer: 1.0 },
    Rung::Gmsh { surface: 6, volume: 1, finer: 2.0 },
    Rung::Gmsh { surface: 1, volume: 4, finer: 2.0 },
    Rung::Gmsh { surface: 5, volume: 10, finer: 4.0 },
    Rung::Netgen { finer: 1.0 },
    Rung::Netgen { finer: 2.0 },
];

impl Rung {
    /// What may be tried.
    pub fn of(choice: Choice) -> impl Iterator<Item = Self> {
        RUNGS.into_iter().filter(move |rung| match rung {
            Self::Gmsh { .. } => choice != Choice::Netgen,
            Self::Netgen { .. } => choice != Choice::Gmsh,
        })
    }

    /// How many times finer than wished.
    pub fn finer(self) -> f64 {
        match self {
            Self::Gmsh { finer, .. } | Self::Netgen { finer } => finer,
        }
    }

    /// The program.
    pub fn program(self) -> &'static str {
        match self {
            Self::Gmsh { .. } => gmsh::NAME,
            Self::Netgen { .. } => netgen::NAME,
        }
    }
}

impl std::fmt::Display for Rung {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match *self {
            Self::Gmsh { surface, volume, .. } => {
                write!(f, "gmsh ({} surfaces, {} volumes", gmsh::algorithm(surface), gmsh::algorithm_3d(volume))?;
            }
            Self::Netgen { .. } => write!(f, "netgen (its usual algorithms")?,
        }
        if self.finer() > 1.0 {
            write!(f, ", {} times finer", self.finer())?;
        }
        write!(f, ")")
    }
}

/// The places a program may be in: what the environment variable names, the project's virtual environment (found from the program's own
/// place and from the working folder), the system's.
pub fn places(variable: &str, name: &str) -> Vec<PathBuf> {
    let own = std::env::current_exe().ok();
    let here = std::env::current_dir().ok();
    let roots = own.iter().chain(&here).flat_map(|path| path.ancestors().map(Path::to_owned).collect::<Vec<_>>());
    let local = roots.map(|root| root.join(ENVIRONMENT).join(name)).filter(|path| path.is_file());
    let named = std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
    // What the user names is all there is.
    match named {
        Some(path) => vec![path],
        None => local.chain([PathBuf::from(name)]).collect(),
    }
}
