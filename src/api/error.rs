//! What is wrong with the input of the library's adapter.
use crate::{adapt, geometry, tasks};

/// Why nothing was adapted, with place and remedy. Numbers count from 0, as in the slices.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Two slices do not belong together.
    #[error("{found} {what} are given for {expected}: give one each")]
    Length {
        /// What there are too many or too few of.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// An element refers to what is not there.
    #[error("{what} {element} refers to {index}, but there are only {count}")]
    OutOfRange {
        /// Which slice.
        what: &'static str,
        /// Element of the slice.
        element: usize,
        /// What it refers to.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is infinite or NaN.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// More than numbers of 32 bits can count.
    #[error("{found} {what} are more than the {most} that can be numbered")]
    TooMany {
        /// What.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// A metric that measures no lengths.
    #[error("the metric of vertex {vertex} is not positive definite and finite")]
    Metric {
        /// The vertex.
        vertex: usize,
    },
    /// A complexity that no mesh can have.
    #[error(
        "a complexity of {complexity:e} cannot be had: it must be above 0 and at most {most:e}; are mesh and metric in the same units?"
    )]
    Complexity {
        /// That is asked for, or that the metric has.
        complexity: f64,
        /// The greatest.
        most: f64,
    },
    /// A share of the longest chords along curved walls that is none.
    #[error("a share of {share} of √(8 h R): give one above 0, and no more than 1")]
    Share {
        /// It.
        share: f64,
    },
    /// The place of the mesh does not belong to it or to the model.
    #[error("the place of the mesh does not fit: {message}; give the one that came with this mesh, or none")]
    Place {
        /// Why.
        message: String,
    },
    /// The model cannot be read, or the mesh does not lie on it.
    #[error(transparent)]
    Model(#[from] geometry::Error),
    /// The mesh is no valid tetrahedral mesh. Here numbers count from 1.
    #[error(transparent)]
    Mesh(#[from] adapt::Error),
    /// The threads cannot be had.
    #[error(transparent)]
    Threads(#[from] tasks::Error),
}

impl Error {
    pub(super) fn place(message: String) -> Self {
        Self::Place { message }
    }
}
