//! The bytes of a file: the one place where files that users give are opened.
use super::Error;
use crate::tasks::Team;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Refuses what is no regular file: a folder has no bytes, a device may have no end, and a pipe may never begin.
///
/// # Errors
/// [`Error::System`] for such, and when there is no file.
pub fn check_regular(path: &Path) -> Result<(), Error> {
    let metadata = std::fs::metadata(path).map_err(|error| Error::system(path, error))?;
    let what = match metadata.file_type() {
        kind if kind.is_file() => return Ok(()),
        kind if kind.is_dir() => "is a folder; name a file",
        _ => "is a device or a pipe, which may have no end; write what it gives to a file and name that",
    };
    Err(Error::system(path, io::Error::new(ErrorKind::InvalidInput, what)))
}

/// All bytes of a regular file.
///
/// # Errors
/// [`Error::System`] when it cannot be read, or is none.
pub fn read_file(path: &Path) -> Result<Vec<u8>, Error> {
    check_regular(path)?;
    std::fs::read(path).map_err(|error| Error::system(path, error))
}

/// The first bytes of a regular file, as many at most.
///
/// # Errors
/// [`Error::System`] when it cannot be read, or is none.
pub fn read_head(path: &Path, most: usize) -> Result<Vec<u8>, Error> {
    check_regular(path)?;
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(most as u64).read_to_end(&mut bytes));
    read.map_err(|error| Error::system(path, error))?;
    Ok(bytes)
}

/// As [`read_file`]; of a large one every thread of the team reads parts.
///
/// # Errors
/// As there.
pub fn read_file_on(team: Team<'_>, path: &Path) -> Result<Vec<u8>, Error> {
    check_regular(path)?;
    match in_parts(team, path) {
        Some(bytes) => Ok(bytes),
        None => read_file(path),
    }
}

/// Bytes a task reads at once.
#[cfg(unix)]
const PART: usize = 1 << 22;

/// Reads the bytes on many threads; none where that is not worth it, or not possible for whatever reason.
#[cfg(unix)]
fn in_parts(team: Team<'_>, path: &Path) -> Option<Vec<u8>> {
    use std::os::unix::fs::FileExt;
    use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
    if team.threads() == 1 {
        return None;
    }
    let file = std::fs::File::open(path).ok()?;
    let metadata = file.metadata().ok()?;
    let size = usize::try_from(metadata.len()).ok()?;
    if !metadata.is_file() || size < 2 * PART {
        return None;
    }
    let mut bytes: Vec<u8> = crate::memory::try_zeroed_vec(size)?;
    let is_whole = AtomicBool::new(true);
    team.fill(PART, &mut bytes, |start, part| {
        if file.read_exact_at(part, start as u64).is_err() {
            is_whole.store(false, Relaxed);
        }
    });
    is_whole.into_inner().then_some(bytes)
}

#[cfg(not(unix))]
fn in_parts(_: Team<'_>, _: &Path) -> Option<Vec<u8>> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{Plan, Pool};

    #[test]
    fn many_threads_read_what_one_does() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let pool = Pool::new(3).unwrap();
        let team = Team::new(&pool, Plan::default());
        for size in [0, 5, (9 << 20) + 7] {
            let bytes: Vec<u8> = (0..size).map(|i: usize| (i * 31 % 251) as u8).collect();
            std::fs::write(&path, &bytes).unwrap();
            assert!(
                read_file_on(team, &path).unwrap() == bytes && read_file_on(Team::alone(), &path).unwrap() == bytes
            );
        }
        assert!(read_file_on(team, &folder.path().join("none")).unwrap_err().to_string().contains("none: "));
    }
}
