//! Errors of files.
use std::path::{Path, PathBuf};

/// What was wrong with a file: what, where, and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Opening, reading or writing failed.
    #[error("{}: {source}{}", path.display(), super::missing::meant(path, source))]
    System {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// The content is wrong.
    #[error("{}: {place}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Line (ASCII) or byte and keyword (binary).
        place: String,
        /// What is wrong and the remedy.
        message: String,
    },
}

impl Error {
    /// An error of the operating system at a file.
    pub(in crate::mesh) fn system(path: &Path, source: std::io::Error) -> Self {
        Self::System { path: path.to_owned(), source }
    }

    /// Wrong content at a place of a file.
    pub(super) fn content(path: &Path, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), place: place.into(), message: message.into() }
    }
}
