//! The identity of files, by which two paths to one file are known.
use crate::mesh::io::follow;
use std::ffi::OsString;
use std::fs::Metadata;
use std::path::Path;
#[cfg(not(unix))]
use std::path::PathBuf;

/// A file, whatever path leads to it.
#[derive(PartialEq, Eq)]
pub struct Identity {
    inode: Inode,
    /// In that folder, of a file that is not there.
    name: Option<OsString>,
}

#[cfg(unix)]
type Inode = (u64, u64);

#[cfg(not(unix))]
type Inode = PathBuf;

impl Identity {
    /// Of a file that is there; none of devices and pipes, which keep nothing.
    pub fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        let keeps = metadata.is_file() || metadata.is_dir();
        keeps.then(|| inode(path, &metadata)).flatten().map(|inode| Self { inode, name: None })
    }

    /// Of a file that is there or not; none of devices and pipes, and where there is no folder.
    pub fn of_output(path: &Path) -> Option<Self> {
        let path = follow(path).ok()?;
        if path.exists() {
            return Self::of(&path);
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let inode = inode(folder, &std::fs::metadata(folder).ok()?)?;
        Some(Self { inode, name: Some(path.file_name()?.to_owned()) })
    }
}

#[cfg(unix)]
fn inode(_: &Path, metadata: &Metadata) -> Option<Inode> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn inode(path: &Path, _: &Metadata) -> Option<Inode> {
    path.canonicalize().ok()
}
