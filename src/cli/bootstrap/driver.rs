//! The meshers that we can start, and where they are looked for.
use super::{gmsh, netgen};
use std::path::{Path, PathBuf};

/// The Python of the virtual environment that scripts/setup.sh makes for netgen, from the root of the project.
const ENVIRONMENT: &str = ".venv/mesher/bin/python3";

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

/// What one run of a mesher is to do; sizes are divided by `finer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rung {
    /// gmsh, with its numbers of the algorithms in two and in three dimensions.
    Gmsh { surface: u32, volume: u32, finer: f64, least: Least },
    /// gmsh, on OpenCASCADE's own triangles: poor ones, but there are some of any face.
    Triangles,
    /// netgen.
    Netgen { finer: f64 },
}

/// How small curvature may make sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Least {
    /// As small as those of the metric of the geometry.
    Usual,
    /// No smaller than a thousandth of the model's diagonal: at a sharp apex gmsh divides edges for ever.
    Large,
}

/// What is tried in turn. gmsh: 6 is frontal-Delaunay, 5 Delaunay, 1 MeshAdapt; in three dimensions 1 is Delaunay, 10 HXT, 4 frontal.
const RUNGS: [Rung; 12] = [
    Rung::Gmsh { surface: 6, volume: 1, finer: 1.0, least: Least::Usual },
    Rung::Gmsh { surface: 5, volume: 1, finer: 1.0, least: Least::Usual },
    Rung::Gmsh { surface: 6, volume: 10, finer: 1.0, least: Least::Usual },
    Rung::Triangles,
    Rung::Gmsh { surface: 6, volume: 1, finer: 1.0, least: Least::Large },
    Rung::Gmsh { surface: 1, volume: 1, finer: 1.0, least: Least::Large },
    Rung::Gmsh { surface: 6, volume: 1, finer: 2.0, least: Least::Usual },
    Rung::Gmsh { surface: 1, volume: 4, finer: 2.0, least: Least::Usual },
    Rung::Gmsh { surface: 5, volume: 10, finer: 4.0, least: Least::Usual },
    Rung::Netgen { finer: 1.0 },
    Rung::Netgen { finer: 2.0 },
    Rung::Netgen { finer: 0.5 },
];

impl Rung {
    /// What may be tried.
    pub fn of(choice: Choice) -> impl Iterator<Item = Self> {
        RUNGS.into_iter().filter(move |rung| match rung {
            Self::Gmsh { .. } | Self::Triangles => choice != Choice::Netgen,
            Self::Netgen { .. } => choice != Choice::Gmsh,
        })
    }

    /// The program.
    pub fn program(self) -> &'static str {
        match self {
            Self::Gmsh { .. } | Self::Triangles => gmsh::NAME,
            Self::Netgen { .. } => netgen::NAME,
        }
    }

    /// Whether it is to be tried where another rung of the program took too long.
    pub fn is_light(self) -> bool {
        match self {
            Self::Gmsh { least, .. } => least == Least::Large,
            Self::Triangles => true,
            Self::Netgen { finer } => finer < 1.0,
        }
    }
}

impl std::fmt::Display for Rung {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let finer = match *self {
            Self::Gmsh { surface, volume, finer, least } => {
                write!(f, "gmsh ({} surfaces, {} volumes", gmsh::algorithm(surface), gmsh::algorithm_3d(volume))?;
                if least == Least::Large {
                    write!(f, ", no small sizes")?;
                }
                finer
            }
            Self::Triangles => {
                write!(f, "gmsh (OpenCASCADE's triangles, Delaunay volumes")?;
                1.0
            }
            Self::Netgen { finer } => {
                write!(f, "netgen (its usual algorithms")?;
                finer
            }
        };
        if finer != 1.0 {
            write!(f, ", sizes divided by {finer}")?;
        }
        write!(f, ")")
    }
}

/// Where gmsh is: what its variable names, else in the search path.
pub fn gmsh_places() -> Vec<PathBuf> {
    vec![named(gmsh::VARIABLE).unwrap_or_else(|| gmsh::NAME.into())]
}

/// Where a Python with netgen may be: what its variable names; else the project's virtual environment (looked for from the program's own
/// place and from the working folder upwards), then the system's Python.
pub fn netgen_places() -> Vec<PathBuf> {
    if let Some(python) = named(netgen::VARIABLE) {
        return vec![python];
    }
    let own = std::env::current_exe().ok();
    let here = std::env::current_dir().ok();
    let roots = own.iter().chain(&here).flat_map(|path| path.ancestors().map(Path::to_owned).collect::<Vec<_>>());
    let local = roots.map(|root| root.join(ENVIRONMENT)).find(|path| path.is_file());
    local.into_iter().chain([PathBuf::from("python3")]).collect()
}

fn named(variable: &str) -> Option<PathBuf> {
    std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from)
}
