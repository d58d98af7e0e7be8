//! Errors of files, shortly.
use crate::mesh::io::Error;
use std::path::Path;

/// Wrong content at a place of a file.
pub(super) fn at(path: &Path, place: impl Into<String>, message: impl Into<String>) -> Error {
    Error::Content { path: path.to_owned(), place: place.into(), message: message.into() }
}

/// The bytes of a file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|source| Error::System { path: path.to_owned(), source })
}
