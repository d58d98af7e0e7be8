//! How a loop is cut into tasks, and which back-end runs them.
use serde::Serialize;

/// Who runs the tasks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// Our own work-stealing threads: each takes its newest task, or another's oldest; the caller is one of them.
    #[default]
    Stealing,
    /// The threads of rayon.
    Rayon,
    /// oneTBB; needs the feature `tbb`.
    Tbb,
    /// OpenMP's tasks; needs the feature `openmp`. Its idle threads wait busily, unless OMP_WAIT_POLICY=passive is in the environment: without
    /// it a loop took 12 ms on a machine whose cores had other work too, with it 5 µs.
    OpenMp,
}

/// In which order tasks are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// One task makes all the others.
    Flat,
    /// Two tasks a thread, each of which makes its share.
    #[default]
    TwoLevel,
    /// Each task gives half of what it has away until one chunk is left.
    Hierarchical,
}

impl Backend {
    /// All of them, built in or not.
    pub const ALL: [Self; 4] = [Self::Stealing, Self::Rayon, Self::Tbb, Self::OpenMp];

    /// As the command line and the features spell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stealing => "stealing",
            Self::Rayon => "rayon",
            Self::Tbb => "tbb",
            Self::OpenMp => "openmp",
        }
    }

    /// Whether this program was built with it.
    pub const fn is_built(self) -> bool {
        match self {
            Self::Stealing | Self::Rayon => true,
            Self::Tbb => cfg!(feature = "tbb"),
            Self::OpenMp => cfg!(feature = "openmp"),
        }
    }
}

impl Strategy {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Flat, Self::TwoLevel, Self::Hierarchical];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::TwoLevel => "two-level",
            Self::Hierarchical => "hierarchical",
        }
    }
}

/// How a loop is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub struct Plan {
    /// Who runs the tasks.
    pub backend: Backend,
    /// In which order they are made.
    pub strategy: Strategy,
    /// Items a task; 0 counts as 1. Chunks begin at its multiples, so they do not depend on the threads.
    pub grain: usize,
}

impl Plan {
    /// A plan of so many items a task, with the default back-end and strategy.
    pub fn of_grain(grain: usize) -> Self {
        Self { grain, ..Self::default() }
    }
}

impl Default for Plan {
    fn default() -> Self {
        Self { backend: Backend::default(), strategy: Strategy::default(), grain: 1 }
    }
}
