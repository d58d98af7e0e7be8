//! Errors of files.
use std::path::PathBuf;

/// What was wrong with a file: what, where, and the remedy.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Opening, reading or writing failed.
    #[error("{}: {source}", path.display())]
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
