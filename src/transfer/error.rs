//! Meshes that a conservative transfer cannot use.
use thiserror::Error;

/// One of the two meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// That the field comes from.
    Old,
    /// That it goes to.
    New,
}

impl std::fmt::Display for Which {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Old => "old",
            Self::New => "new",
        })
    }
}

/// Why nothing was transferred.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Error {
    /// Such a mesh overlaps itself, and integrals over it mean nothing.
    #[error("tetrahedron {} of the {mesh} mesh is inverted; geo-adapt inspect lists all such", .tet + 1)]
    Inverted {
        /// Which mesh.
        mesh: Which,
        /// The tetrahedron, from 0.
        tet: usize,
    },
    /// All its tetrahedra are flat, or it has none.
    #[error("the {0} mesh has no volume")]
    NoVolume(Which),
}
