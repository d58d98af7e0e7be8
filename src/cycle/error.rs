//! Why a loop did not go to its end.

/// What ends a loop early.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The user ended it: it goes on with the same command.
    #[error("interrupted")]
    Interrupted,
    /// A program found no more memory.
    #[error("{0}")]
    OutOfMemory(String),
    /// Something is wrong: place and remedy.
    #[error("{0}")]
    Failed(String),
}

impl From<String> for Error {
    fn from(message: String) -> Self {
        Self::Failed(message)
    }
}

impl From<crate::mesh::io::Error> for Error {
    fn from(error: crate::mesh::io::Error) -> Self {
        Self::Failed(error.to_string())
    }
}
