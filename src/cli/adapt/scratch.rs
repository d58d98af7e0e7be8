//! The folder for the pieces of a mesh that is adapted part by part.
use super::input::Error;
use crate::cli::files::room;
use crate::decomposition::{JOURNAL, Shelf};
use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The file that makes a folder ours, before there is a journal. It is locked as long as a run is at it.
const OURS: &str = "geo-adapt-scratch";

/// What it says.
const SAYS: &str = "The pieces of a mesh that geo-adapt works on. When no run is at it, it may be removed.\n";

/// How long a run waits for the end of one before it: where mpirun is killed its processes find out after three seconds.
const PATIENCE: Duration = Duration::from_secs(10);

/// Bytes that a vertex takes in pieces, of which a round has old and new ones.
const BYTES_A_VERTEX: f64 = 600.0;

/// Bytes that a vertex of the input takes, where its metric lies in blocks: in these, and in what the parts of a round take of them.
const BYTES_OF_GROUND: f64 = 700.0;

/// A scratch folder. It is removed at the end of a run, and stays when that is killed, so that it may go on.
pub struct Scratch {
    folder: PathBuf,
    _lock: Option<File>,
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
        Self { folder, _lock: None }
    }

    /// Opens or makes it, with room for a mesh of so many vertices, and for a metric in blocks on so many.
    ///
    /// # Errors
    /// When it cannot be made, is another's, another run is at it, or there is not enough room.
    pub fn open(folder: PathBuf, vertices: f64, ground: f64) -> Result<Self, Error> {
        let lock = held(&folder).map_err(|what| format!("{}: {what}", folder.display()))?;
        let scratch = Self { folder, _lock: Some(lock) };
        if let Some(why) = room::lacking_bytes(&scratch.folder, BYTES_A_VERTEX * vertices + BYTES_OF_GROUND * ground) {
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

/// Makes the folder, and locks the file that makes it ours.
fn held(folder: &Path) -> Result<File, String> {
    let (file, began) = (folder.join(OURS), Instant::now());
    let named = |error: std::io::Error| error.to_string();
    loop {
        fs::create_dir_all(folder).map_err(named)?;
        let is_empty = fs::read_dir(folder).map_err(named)?.next().is_none();
        if !is_empty && !file.exists() {
            return Err(
                "this folder is not empty, and no scratch folder of geo-adapt; give --scratch a new folder".into()
            );
        }
        let mut lock = File::options().write(true).create(true).truncate(false).open(&file).map_err(named)?;
        // Where there are no locks nobody waits.
        let is_taken = matches!(lock.try_lock(), Err(TryLockError::WouldBlock));
        // A run that ends removes it.
        if !is_taken && file.exists() {
            lock.write_all(SAYS.as_bytes()).map_err(named)?;
            return Ok(lock);
        }
        if began.elapsed() > PATIENCE {
            return Err(
                "another run of geo-adapt is at work in this folder: wait for its end, or give another --scratch"
                    .into(),
            );
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}
