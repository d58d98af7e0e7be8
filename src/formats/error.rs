//! Short forms for the errors of files.
use crate::mesh::io::{Error, read_file_on};
use crate::tasks::Team;
use std::path::Path;

/// Wrong content at a place of a file.
pub(super) fn at(path: &Path, place: impl Into<String>, message: impl Into<String>) -> Error {
    Error::Content { path: path.to_owned(), place: place.into(), message: message.into() }
}

/// A name in a file as an error shows it. In a damaged file it can be very long, and of any characters.
pub(super) fn short(name: &str) -> String {
    name.chars().take(40).flat_map(char::escape_debug).collect()
}

/// The bytes of a file. An empty file is an error here: what the reader of a format would say of it does not help.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    read_on(Team::alone(), path)
}

/// As [`read`], on the threads of a team.
pub(super) fn read_on(team: Team<'_>, path: &Path) -> Result<Vec<u8>, Error> {
    let bytes = read_file_on(team, path)?;
    if bytes.is_empty() {
        return Err(at(path, "byte 0", "the file is empty; write it again"));
    }
    Ok(bytes)
}
