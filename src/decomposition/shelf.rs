//! Where pieces lie while others are worked on: in memory, or as files of a scratch folder.
use super::bytes::{decoded, encoded};
use super::piece::Piece;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The file in the scratch folder that says how far the run is.
pub const JOURNAL: &str = "journal.json";

/// How the names of all other files there end.
const ENDINGS: [&str; 8] = [".active", ".finished", ".share", ".ground", ".around", ".done", ".parts", ".part"];

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub enum Key {
    /// What a part became in a round, as far as it is not finished.
    Active { round: u32, part: u32 },
    /// What is finished of it.
    Finished { round: u32, part: u32 },
    /// What a part takes in a round of that which another one became in the round before.
    Share { round: u32, part: u32, of: u32 },
    /// A block of the metric of the input.
    Ground { block: u32 },
    /// What a part takes in a round of a block of the metric.
    Around { round: u32, part: u32, of: u32 },
}

impl Key {
    fn file(self) -> String {
        match self {
            Self::Active { round, part } => format!("r{round:02}-p{part:05}.active"),
            Self::Finished { round, part } => format!("r{round:02}-p{part:05}.finished"),
            Self::Share { round, part, of } => format!("r{round:02}-p{part:05}-of-{of:05}.share"),
            Self::Ground { block } => format!("b{block:05}.ground"),
            Self::Around { round, part, of } => format!("r{round:02}-p{part:05}-of-{of:05}.around"),
        }
    }

    /// The part, or the block.
    pub fn part(self) -> u32 {
        match self {
            Self::Active { part, .. } | Self::Finished { part, .. } => part,
            Self::Share { part, .. } | Self::Around { part, .. } => part,
            Self::Ground { block } => block,
        }
    }

    /// As numbers: what it is, and those that say which.
    pub fn numbers(self) -> [u32; 4] {
        match self {
            Self::Active { round, part } => [0, round, part, 0],
            Self::Finished { round, part } => [1, round, part, 0],
            Self::Share { round, part, of } => [2, round, part, of],
            Self::Ground { block } => [3, 0, block, 0],
            Self::Around { round, part, of } => [4, round, part, of],
        }
    }

    /// Of these numbers.
    pub fn of_numbers([what, round, part, of]: [u32; 4]) -> Option<Self> {
        Some(match what {
            0 => Self::Active { round, part },
            1 => Self::Finished { round, part },
            2 => Self::Share { round, part, of },
            3 => Self::Ground { block: part },
            4 => Self::Around { round, part, of },
            _ => return None,
        })
    }
}

/// A piece that could not be kept or found again.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The disk refuses.
    #[error("{}: {error}; the scratch folder needs room for a few times the mesh, and --scratch chooses another disk", path.display())]
    Disk {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file is not as it was written.
    #[error("{}: this is no piece of a mesh any more; remove the scratch folder and begin again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
    },
}

/// Where pieces lie.
pub enum Shelf {
    /// In memory.
    Memory(Mutex<BTreeMap<Key, Piece>>),
    /// In files of this folder.
    Disk(PathBuf),
}

impl Shelf {
    /// An empty shelf in memory.
    pub fn in_memory() -> Self {
        Self::Memory(Mutex::default())
    }

    /// Puts a piece away. A file comes whole or not at all.
    ///
    /// # Errors
    /// When the disk refuses.
    pub fn put(&self, key: Key, piece: Piece) -> Result<(), Error> {
        match self {
            Self::Memory(pieces) => {
                pieces.lock().unwrap_or_else(PoisonError::into_inner).insert(key, piece);
                Ok(())
            }
            Self::Disk(folder) => write(&folder.join(key.file()), &encoded(&piece)),
        }
    }

    /// Takes a piece. A file stays until it is forgotten.
    ///
    /// # Errors
    /// When the file cannot be read, or is damaged.
    pub fn take(&self, key: Key) -> Result<Piece, Error> {
        match self {
            Self::Memory(pieces) => {
                Ok(pieces.lock().unwrap_or_else(PoisonError::into_inner).remove(&key).unwrap_or_default())
            }
            Self::Disk(folder) => {
                let path = folder.join(key.file());
                match fs::read(&path) {
                    Ok(bytes) => decoded(&bytes).ok_or(Error::Damaged { path }),
                    Err(error) => Err(Error::Disk { path, error }),
                }
            }
        }
    }

    /// Puts back what was taken, as it was.
    pub fn give_back(&self, key: Key, piece: Piece) {
        if let Self::Memory(pieces) = self {
            pieces.lock().unwrap_or_else(PoisonError::into_inner).insert(key, piece);
        }
    }

    /// Removes all pieces and what is known of them. That a file stays does no harm.
    pub fn clear(&self) {
        match self {
            Self::Memory(pieces) => pieces.lock().unwrap_or_else(PoisonError::into_inner).clear(),
            Self::Disk(folder) => {
                // The journal first: without it nothing else counts.
                drop(fs::remove_file(folder.join(JOURNAL)));
                for file in fs::read_dir(folder).into_iter().flatten().flatten() {
                    let name = file.file_name();
                    if name.to_str().is_some_and(|name| ENDINGS.iter().any(|ending| name.ends_with(ending))) {
                        drop(fs::remove_file(file.path()));
                    }
                }
            }
        }
    }

    /// A piece is not needed any more. That a file stays does no harm.
    pub fn forget(&self, key: Key) {
        match self {
            Self::Memory(pieces) => drop(pieces.lock().unwrap_or_else(PoisonError::into_inner).remove(&key)),
            Self::Disk(folder) => drop(fs::remove_file(folder.join(key.file()))),
        }
    }
}

/// Writes a file beside and renames it.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = Path::new(&beside);
    let written = fs::write(beside, bytes).and_then(|()| fs::rename(beside, path));
    written.map_err(|error| {
        drop(fs::remove_file(beside));
        Error::Disk { path: path.to_owned(), error }
    })
}
