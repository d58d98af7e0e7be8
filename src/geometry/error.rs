//! Errors of models and classification.
use std::path::PathBuf;

/// What is wrong with a model or with a mesh on it, where, and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be opened.
    #[error("{}: {source}{}", path.display(), crate::mesh::io::meant(path, source))]
    Open {
        /// The model file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The file is no readable model.
    #[error("{}: {message}", path.display())]
    Model {
        /// The model file.
        path: PathBuf,
        /// What is wrong and the remedy.
        message: String,
    },
    /// The mesh does not fit the model.
    #[error("{0}")]
    Classification(#[from] super::classify::Error),
}
