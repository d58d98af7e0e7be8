//! The folder for the pieces of a mesh that is adapted part by part.
use super::input::Error;
use crate::cli::files::room;
use crate::decomposition::{JOURNAL, Shelf};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The file that makes a folder ours, before there is a journal.
const OURS: &str = "geo-adapt-scratch";

/// Bytes that a vertex takes in pieces, of which a round has old and new ones.
const BYTES_A_VERTEX: f64 = 600.0;

/// A scratch folder. It is removed at the end of a run, and stays when that is killed, so that it may go on.
pub struct Scratch {
    folder: PathBuf,
}

impl Scratch {
    /// Beside the output, if no other is asked for.
    pub fn folder(asked: Option<&Path>, output: &Path) -> PathBuf {
        let mut beside = output.as_os_str().to_owned();
        beside.push(".scratch");
        asked.map_or_else(|| beside.into(), Path::to_owned)
    }

    /// One that another process has opened.
    pub fn of(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// Opens or makes it, with room for a mesh of so many vertices.
    ///
    /// # Errors
    /// When it cannot be made, is another's, or there is not enough room.
    pub fn open(folder: PathBuf, vertices: f64) -> Result<Self, Error> {
        let named = |error: std::io::Error| format!("{}: {error}", folder.display());
        fs::create_dir_all(&folder).map_err(named)?;
        let is_empty = fs::read_dir(&folder).map_err(named)?.next().is_none();
        if !is_empty && !folder.join(OURS).exists() {
            let what = "this folder is not empty, and no scratch folder of geo-adapt; give --scratch a new folder";
            return Err(format!("{}: {what}", folder.display()).into());
        }
        fs::write(
            folder.join(OURS),
            "The pieces of a mesh that geo-adapt works on. When no run is at it, it may be removed.\n",
        )
        .map_err(named)?;
        let scratch = Self { folder };
        if let Some(why) = room::lacking_bytes(&scratch.folder, BYTES_A_VERTEX * vertices) {
            if !scratch.folder.join(JOURNAL).exists() {
                scratch.remove();
            }
            return Err(format!("{why}; --scratch chooses a folder on another disk").into());
        }
        Ok(scratch)
    }

    /// As a shelf.
    pub fn shelf(&self) -> Shelf {
        Shelf::Disk(self.folder.clone())
    }

    /// Removes what is in it, and the folder. What others have put there stays.
    pub fn remove(self) {
        self.shelf().clear();
        drop(fs::remove_file(self.folder.join(OURS)));
        if let Err(error) = fs::remove_dir(&self.folder)
            && error.kind() != ErrorKind::NotFound
        {
            crate::cli::note(format_args!("{}: {error}", self.folder.display()));
        }
    }
}
