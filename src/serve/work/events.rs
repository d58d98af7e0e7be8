//! The progress of a run, read from its file while it grows.
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Most of the file that is looked at in one go; what comes in between is old by then.
const MOST: u64 = 1 << 16;

/// The file, and how far it was read.
pub struct Events {
    path: PathBuf,
    read: u64,
}

impl Events {
    /// Of a run that begins.
    pub fn of(path: PathBuf) -> Self {
        Self { path, read: 0 }
    }

    /// All that was said since the last look, as far as it is JSON.
    pub fn news(&mut self) -> Vec<serde_json::Value> {
        self.lines().unwrap_or_default().iter().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    fn lines(&mut self) -> std::io::Result<Vec<String>> {
        let mut file = std::fs::File::open(&self.path)?;
        let length = file.metadata()?.len();
        let from = self.read.max(length.saturating_sub(MOST));
        file.seek(SeekFrom::Start(from))?;
        let mut bytes = Vec::new();
        file.take(MOST).read_to_end(&mut bytes)?;
        // A line that is not complete is for the next look.
        let whole = bytes.iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        self.read = from + whole as u64;
        Ok(String::from_utf8_lossy(&bytes[..whole]).lines().map(str::to_owned).collect())
    }
}

/// The last lines of a text that may be long.
pub fn tail(path: &Path, most: u64) -> String {
    let read = || -> std::io::Result<String> {
        let mut file = std::fs::File::open(path)?;
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(most)))?;
        let mut bytes = Vec::new();
        file.take(most).read_to_end(&mut bytes)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    };
    read().unwrap_or_default()
}
