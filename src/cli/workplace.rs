//! A folder for the files that processes of one run hand to each other.
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, Once};
use std::time::Duration;
use std::{fs, io};

/// How the names of all of them begin.
const NAME: &str = "geo-adapt-";

/// The file in each that is locked as long as its run is there.
const LOCK: &str = "lock";

/// A folder without that file is being made, unless it is so old.
const BEING_MADE: Duration = Duration::from_secs(2);

/// The folders of this process.
static OURS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A folder of this run, which goes with it; where the run is killed, with the next one.
pub struct Workplace {
    folder: PathBuf,
    _lock: File,
}

impl Workplace {
    /// In the system's folder for such.
    pub fn new() -> io::Result<Self> {
        static SWEEP: Once = Once::new();
        SWEEP.call_once(|| sweep(&std::env::temp_dir()));
        Self::within(&std::env::temp_dir())
    }

    fn within(folder: &Path) -> io::Result<Self> {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        loop {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let folder = folder.join(format!("{NAME}{}-{number}", std::process::id()));
            match fs::create_dir(&folder) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue, // of another system's process of this number
                made => made?,
            }
            if let Ok(mut ours) = OURS.lock() {
                ours.push(folder.clone());
            }
            // Another run may have taken it for one that was left, before it was locked.
            match held(&folder) {
                Ok(Some(lock)) => return Ok(Self { folder, _lock: lock }),
                Ok(None) => {}
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
}

impl Drop for Workplace {
    fn drop(&mut self) {
        // In this order: an interrupt that ends the process meanwhile still finds it in the list.
        let _ = fs::remove_dir_all(&self.folder);
        if let Ok(mut ours) = OURS.lock() {
            ours.retain(|folder| *folder != self.folder);
        }
    }
}

/// The locked file of a new folder; none where the folder has gone, or goes.
fn held(folder: &Path) -> io::Result<Option<File>> {
    let path = folder.join(LOCK);
    let lock = File::create(&path)?;
    // Where there are no locks nobody takes the folder for one that was left.
    let is_taken = matches!(lock.try_lock(), Err(TryLockError::WouldBlock));
    Ok(Some(lock).filter(|_| !is_taken && path.exists()))
}

/// Removes all folders of this process, which is about to end.
pub fn clear() {
    // Who holds it is about to add or to remove one.
    if let Ok(ours) = OURS.try_lock() {
        ours.iter().for_each(|folder| drop(fs::remove_dir_all(folder)));
    }
}

/// Removes what runs have left that were killed.
fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_name = |name: &str| {
        let numbers = name.strip_prefix(NAME).and_then(|rest| rest.split_once('-'));
        numbers.is_some_and(|(id, number)| [id, number].iter().all(|text| text.parse::<u32>().is_ok()))
    };
    let named = entries.filter(|entry| is_name(&entry.file_name().to_string_lossy()));
    for path in named.map(|entry| entry.path()) {
        // One that is not ours cannot be opened, or not be removed.
        let is_left = match File::options().write(true).open(path.join(LOCK)) {
            Ok(lock) => lock.try_lock().is_ok(),
            Err(error) => error.kind() == io::ErrorKind::NotFound && is_old(&path),
        };
        if is_left {
            let _ = fs::remove_dir_all(path);
        }
    }
}

fn is_old(folder: &Path) -> bool {
    let changed = fs::symlink_metadata(folder).ok().filter(fs::Metadata::is_dir).and_then(|data| data.modified().ok());
    changed.and_then(|changed| changed.elapsed().ok()).is_some_and(|age| age > BEING_MADE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_run_has_left_goes_with_the_next_one() {
        let root = tempfile::tempdir().unwrap();
        let kept = Workplace::within(root.path()).unwrap();
        fs::write(kept.file("model.bin"), b"here").unwrap();
        let make = |name: &str, lock: bool| {
            let folder = root.path().join(name);
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("model.bin"), b"left").unwrap();
            if lock {
                fs::write(folder.join(LOCK), b"").unwrap();
            }
            folder
        };
        let left = make("geo-adapt-1-0", true);
        let [new, other] = [make("geo-adapt-1-1", false), make("geo-adapt-out", true)];
        let unlocked = make("geo-adapt-1-2", false);
        File::open(&unlocked).unwrap().set_modified(std::time::SystemTime::now() - 2 * BEING_MADE).unwrap();
        sweep(root.path());
        assert!(!left.exists() && !unlocked.exists(), "nobody holds their lock");
        assert!(kept.file("model.bin").exists(), "it is in use");
        assert!(new.exists() && other.exists(), "being made, and not ours");
        let folder = kept.folder.clone();
        drop(kept);
        assert!(!folder.exists());
    }
}
