//! What a finished step leaves: `done.json`, written last.
use super::error::Error;
use super::layout::DONE;
use crate::mesh::io::write_beside;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::Path;

/// What `done.json` says.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Done<T> {
    /// Seconds, of the attempt that came to its end.
    pub seconds: f64,
    /// What came of it.
    pub result: T,
}

/// What a finished step left, if it is finished.
pub fn finished<T: DeserializeOwned>(folder: &Path) -> Option<Done<T>> {
    read(folder).ok().flatten()
}

/// What a finished step left; none where there is no such file.
///
/// # Errors
/// When there is one that cannot be read.
pub fn read<T: DeserializeOwned>(folder: &Path) -> Result<Option<Done<T>>, String> {
    match fs::read(folder.join(DONE)) {
        Ok(bytes) => serde_json::from_slice(&bytes).map(Some).map_err(|error| error.to_string()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

/// Writes JSON beside, then renames.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Error> {
    let bytes =
        serde_json::to_vec_pretty(value).map_err(|error| Error::Failed(format!("{}: {error}", path.display())))?;
    Ok(write_beside(path, |file| file.write_all(&bytes).and_then(|()| file.write_all(b"\n")))?)
}
