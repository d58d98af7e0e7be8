//! Where a write to a path goes, and whether it can.
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// After so many links they are called a circle. Linux has the same bound.
const MOST_LINKS: usize = 40;

/// Most bytes of a name that a temporary name repeats. File systems allow 255 in all.
const MOST_REPEATED: usize = 100;

/// Where the bytes for a path go.
pub(super) enum Place {
    /// A file, which may be there already: it is replaced. Links are followed.
    File { path: PathBuf, before: Option<Metadata> },
    /// A device or a pipe: it is written directly.
    Device,
    /// `/dev/stdout`, redirected to a file. To replace that file would lose what is printed.
    Stdout,
}

impl Place {
    /// Of a path.
    ///
    /// # Errors
    /// For a folder, a read-only file, a circle of links, and where a part of the path is no folder.
    pub fn of(path: &Path) -> io::Result<Self> {
        if path.file_name().is_none() || path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(refusal("this is a folder; name a file"));
        }
        let is_device = path.starts_with("/dev") || path.starts_with("/proc");
        let path = follow(path)?;
        match fs::metadata(&path) {
            Ok(metadata) if metadata.is_dir() => Err(refusal("this is a folder; name a file")),
            Ok(metadata) if !metadata.is_file() => Ok(Self::Device),
            Ok(metadata) if is_device && is_stdout(&metadata) => Ok(Self::Stdout),
            Ok(metadata) if metadata.permissions().readonly() => {
                Err(refusal("the file is read-only; name another, or allow writing to it"))
            }
            Ok(metadata) => Ok(Self::File { path, before: Some(metadata) }),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let folder = folder_of(&path);
                if !folder.is_dir() {
                    let message = format!("there is no folder {}; make it first", folder.display());
                    return Err(io::Error::new(ErrorKind::NotFound, message));
                }
                Ok(Self::File { path, before: None })
            }
            Err(error) => Err(error),
        }
    }
}

/// Finds out before the work whether a file could be written, without touching it.
///
/// # Errors
/// For a folder, a read-only file, and where its folder is not there or takes no new file.
pub fn check_writable(path: &Path) -> io::Result<()> {
    match Place::of(path)? {
        Place::File { before: Some(metadata), .. } if is_stdout(&metadata) => {
            Err(refusal("standard output goes to this file; name another, or /dev/stdout"))
        }
        Place::File { path, .. } => new_beside(&path, create_file).map(drop),
        Place::Device | Place::Stdout => Ok(()),
    }
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What a path names behind all links, also where that is not there yet.
///
/// # Errors
/// For a circle of links, and where a part of the path is no folder or must not be looked into.
pub fn follow(path: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        found => return found,
    }
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(next) => path = path.parent().unwrap_or(Path::new("")).join(next),
            Err(_) => return Ok(path),
        }
    }
    Err(refusal("its links go round in a circle; name a file"))
}

/// Whether standard output is redirected to this file.
#[cfg(unix)]
fn is_stdout(metadata: &Metadata) -> bool {
    use std::os::fd::AsFd;
    use std::os::unix::fs::MetadataExt;
    let own = io::stdout().as_fd().try_clone_to_owned().and_then(|out| File::from(out).metadata());
    own.is_ok_and(|own| (own.dev(), own.ino()) == (metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn is_stdout(_: &Metadata) -> bool {
    false
}

/// Something new beside its target. It is removed with this, unless it has been renamed.
pub(super) struct Temporary {
    pub path: PathBuf,
    pub is_renamed: bool,
    /// Locked as long as this run is there: so the next one knows what a killed one has left.
    _lock: Option<File>,
}

impl Temporary {
    /// Gives it the name that it is meant for.
    pub fn rename(mut self, target: &Path) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.is_renamed = true;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.is_renamed {
            // The error that led here is the one to report.
            let _ = if self.path.is_dir() { fs::remove_dir_all(&self.path) } else { fs::remove_file(&self.path) };
        }
    }
}

/// Makes a new file.
pub(super) fn create_file(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// How old something of another run must be before it can be one that was left: younger ones may not be locked yet.
const BEING_MADE: Duration = Duration::from_secs(2);

/// Removes what killed runs were writing for a target: what has its hidden name, and is not locked by anybody.
fn remove_left(folder: &Path, name: &OsStr) {
    let mut start = OsString::from(".");
    start.push(name);
    start.push(".");
    let is_hidden = |found: &OsStr| {
        let rest = found.as_encoded_bytes().strip_prefix(start.as_encoded_bytes());
        let numbers = rest.and_then(|rest| rest.strip_suffix(b".tmp"));
        numbers.is_some_and(|numbers| {
            let mut parts = numbers.split(|byte| *byte == b'-');
            let mut is_number =
                || parts.next().is_some_and(|part| !part.is_empty() && part.iter().all(u8::is_ascii_digit));
            is_number() && is_number() && parts.next().is_none()
        })
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten().filter(|entry| is_hidden(&entry.file_name())) {
        let is_old = |data: Metadata| {
            let age = data.modified().ok().and_then(|changed| changed.elapsed().ok());
            !data.is_symlink() && age.is_some_and(|age| age > BEING_MADE)
        };
        let path = entry.path();
        if entry.metadata().is_ok_and(is_old)
            && let Ok(left) = File::open(&path)
            && left.try_lock().is_ok()
        {
            let _ = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}

/// Locks a new file or folder. Where there are no locks nobody takes it for one that was left.
fn locked(path: &Path) -> Option<File> {
    File::open(path).ok().filter(|file| file.try_lock().is_ok())
}

/// Makes something new in the folder of `target`, hidden, with a name that no other run takes.
pub(super) fn new_beside<T>(target: &Path, create: impl Fn(&Path) -> io::Result<T>) -> io::Result<(T, Temporary)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let Some(name) = target.file_name() else { return Err(refusal("this names no file")) };
    let name = if name.len() <= MOST_REPEATED { name } else { "geo-adapt".as_ref() };
    remove_left(folder_of(target), name);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{number}.tmp", std::process::id()));
        let path = folder_of(target).join(hidden);
        match create(&path) {
            Ok(made) => {
                let _lock = locked(&path);
                return Ok((made, Temporary { path, is_renamed: false, _lock }));
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {} // left by a run that was killed
            Err(error) => return Err(error),
        }
    }
}

pub(super) fn refusal(message: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, message)
}
