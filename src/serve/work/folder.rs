//! The folder of a run: its inputs are put there, and what it has made is taken out.
use super::protocol::{FILES, LOG, PRINTED, TEMPORARY};
use crate::cycle::left;
use crate::serve::blobs::{Blobs, digest_of};
use crate::serve::catalogue::Produced;
use crate::serve::ids::is_file_name;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Most files that are taken out of a folder.
const MOST: usize = 1000;

/// Names of results that the service gives.
pub const LOG_NAME: &str = "log.txt";
const PRINTED_NAME: &str = "printed.txt";

/// A file with its name.
fn named(path: PathBuf) -> Option<(String, PathBuf)> {
    let name = path.file_name()?.to_str().filter(|name| is_file_name(name))?.to_owned();
    Some((name, path))
}

/// The folder of a run. It goes when this is dropped.
pub struct Folder {
    path: PathBuf,
    inputs: Vec<String>,
}

impl Folder {
    /// Makes one, with these files.
    ///
    /// # Errors
    /// When a file is not there, or there is no room.
    pub async fn make(path: PathBuf, blobs: &Blobs, files: &BTreeMap<String, String>) -> io::Result<Self> {
        drop(fs::remove_dir_all(&path));
        let this = Self { path, inputs: files.keys().cloned().collect() };
        for name in [FILES, TEMPORARY] {
            fs::create_dir_all(this.path.join(name))?;
        }
        for (name, id) in files {
            let named = |error: io::Error| io::Error::new(error.kind(), format!("{name}: {error}"));
            blobs.place(id, &this.path.join(FILES).join(name)).await.map_err(named)?;
        }
        Ok(this)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes what the run has made into the store.
    ///
    /// # Errors
    /// When it cannot be kept.
    pub async fn collect(&self, blobs: &Blobs) -> io::Result<Vec<Produced>> {
        let mut made = Vec::new();
        for entry in fs::read_dir(self.path.join(FILES))? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_new = !self.inputs.contains(&name) && is_file_name(&name) && entry.file_type()?.is_file();
            if is_new && made.len() < MOST {
                made.push((name, entry.path()));
            } else if entry.file_type()?.is_dir() {
                made.extend(left::files(&entry.path()).into_iter().filter_map(named).take(MOST));
            }
        }
        for (name, file) in [(LOG_NAME, LOG), (PRINTED_NAME, PRINTED)] {
            let path = self.path.join(file);
            if fs::metadata(&path).is_ok_and(|of| of.len() > 0) && !made.iter().any(|(other, _)| other == name) {
                made.push((name.to_owned(), path));
            }
        }
        made.sort();
        let mut results = Vec::new();
        for (name, path) in made {
            let bytes = fs::metadata(&path)?.len() as i64;
            let of = path.clone();
            let id = tokio::task::spawn_blocking(move || digest_of(&of)).await.map_err(io::Error::other)??;
            blobs.put(&path, &id).await?;
            results.push(Produced { name, id, bytes });
        }
        Ok(results)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        drop(fs::remove_dir_all(&self.path));
    }
}
