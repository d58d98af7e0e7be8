//! What may be tried in turn to make a mesh.

/// What gmsh is called.
pub const GMSH: &str = "gmsh";

/// What netgen is called.
pub const NETGEN: &str = "netgen";

/// What our own is called.
pub const OWN: &str = "geo-adapt";

/// Which meshers may be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Choice {
    /// geo-adapt itself; gmsh, then netgen, where it fails and they are installed
    #[default]
    Auto,
    /// geo-adapt itself: no other program is needed
    Own,
    /// gmsh only
    Gmsh,
    /// netgen only
    Netgen,
}

/// What one run of a mesher is to do; sizes are divided by `finer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rung {
    /// Our own: constrained Delaunay tetrahedra of our own triangulation.
    Own { finer: f64 },
    /// gmsh, with its numbers of the algorithms in two and in three dimensions.
    Gmsh { surface: u32, volume: u32, finer: f64, least: Least },
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

/// What is tried in turn. gmsh: 6 is frontal-Delaunay, 1 MeshAdapt; in three dimensions 1 is Delaunay, 10 HXT.
const RUNGS: [Rung; 8] = [
    Rung::Own { finer: 1.0 },
    Rung::Own { finer: 2.0 },
    Rung::Gmsh { surface: 6, volume: 1, finer: 1.0, least: Least::Usual },
    Rung::Gmsh { surface: 6, volume: 10, finer: 1.0, least: Least::Usual },
    Rung::Gmsh { surface: 1, volume: 1, finer: 1.0, least: Least::Large },
    Rung::Gmsh { surface: 6, volume: 1, finer: 2.0, least: Least::Usual },
    Rung::Netgen { finer: 1.0 },
    Rung::Netgen { finer: 2.0 },
];

impl Rung {
    /// What may be tried.
    pub fn of(choice: Choice) -> impl Iterator<Item = Self> {
        RUNGS.into_iter().filter(move |rung| match rung {
            Self::Own { .. } => matches!(choice, Choice::Auto | Choice::Own),
            Self::Gmsh { .. } => matches!(choice, Choice::Auto | Choice::Gmsh),
            Self::Netgen { .. } => matches!(choice, Choice::Auto | Choice::Netgen),
        })
    }

    /// The program.
    pub fn program(self) -> &'static str {
        match self {
            Self::Own { .. } => OWN,
            Self::Gmsh { .. } => GMSH,
            Self::Netgen { .. } => NETGEN,
        }
    }

    /// Whether it is to be tried where another rung of the program took too long.
    pub fn is_light(self) -> bool {
        match self {
            Self::Gmsh { least, .. } => least == Least::Large,
            Self::Own { finer } => finer < 2.0,
            Self::Netgen { finer } => finer < 1.0,
        }
    }
}

impl std::fmt::Display for Rung {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let finer = match *self {
            Self::Own { finer } => {
                write!(f, "geo-adapt (constrained Delaunay")?;
                finer
            }
            Self::Gmsh { surface, volume, finer, least } => {
                write!(f, "gmsh ({} surfaces, {} volumes", algorithm(surface), algorithm_3d(volume))?;
                if least == Least::Large {
                    write!(f, ", no small sizes")?;
                }
                finer
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

/// gmsh's name of an algorithm for surfaces.
fn algorithm(number: u32) -> &'static str {
    match number {
        1 => "MeshAdapt",
        _ => "frontal-Delaunay",
    }
}

/// gmsh's name of an algorithm for volumes.
fn algorithm_3d(number: u32) -> &'static str {
    match number {
        10 => "HXT",
        _ => "Delaunay",
    }
}
