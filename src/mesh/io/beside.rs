//! Writing a file so that it is either the old one or the whole new one.
use super::Error;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Removes the file on the way out, unless it has been renamed.
struct Temporary {
    path: PathBuf,
    renamed: bool,
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            let _ = fs::remove_file(&self.path); // the error that led here is the one to report
        }
    }
}

/// Calls `write` on a temporary file in `path`'s folder, then renames it to `path`: whoever looks at `path` sees
/// the file before or the whole file after, also when writing fails or the program is ended. Links are followed;
/// a device or pipe (`/dev/stdout`) is written directly.
///
/// # Errors
/// [`Error::System`] when the folder does not exist, the file is read-only, or writing fails; then `path` is as it was.
pub fn write_beside(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    try_write(path, write).map_err(|e| Error::system(path, e))
}

fn try_write(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let before = match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(refusal("this is a folder; name a file")),
        Ok(metadata) if !metadata.is_file() => {
            let mut file = BufWriter::new(OpenOptions::new().write(true).open(path)?);
            write(&mut file)?;
            return file.flush();
        }
        Ok(metadata) if metadata.permissions().readonly() => {
            return Err(refusal("the file is read-only; name another, or allow writing to it"));
        }
        Ok(metadata) => Some(metadata),
        Err(_) => None, // not there, which opening beside it finds out
    };
    // a link stays, and what it points to is replaced
    let target = if before.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    let (file, mut temporary) = open_beside(&target)?;
    let mut buffered = BufWriter::with_capacity(1 << 18, file);
    write(&mut buffered)?;
    let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(metadata) = before {
        file.set_permissions(metadata.permissions())?;
    }
    file.sync_all()?; // a full disk may show only now
    drop(file);
    fs::rename(&temporary.path, &target)?;
    temporary.renamed = true;
    Ok(())
}

/// A new file in the folder of `target`, with a name that no other run takes.
fn open_beside(target: &Path) -> io::Result<(File, Temporary)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let Some(name) = target.file_name() else { return Err(refusal("this names no file")) };
    let folder = target.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let message = format!("the folder {} does not exist; make it first", folder.display());
        return Err(io::Error::new(ErrorKind::NotFound, message));
    }
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{number}.tmp", std::process::id()));
        let path = folder.join(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, Temporary { path, renamed: false })),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {} // left by a run that was killed
            Err(e) => return Err(e),
        }
    }
}

fn refusal(message: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<OsString> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        write_beside(&path, |w| w.write_all(b"old")).unwrap();
        let error = write_beside(&path, |w| {
            w.write_all(&[b'x'; 1 << 20])?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(error.unwrap_err().to_string(), format!("{}: disk full", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["report.json"]);
        write_beside(&path, |w| w.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["report.json"]);
    }

    #[test]
    fn a_missing_folder_a_folder_and_a_read_only_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let message = |path: &Path| write_beside(path, |w| w.write_all(b"new")).unwrap_err().to_string();
        assert!(message(&folder.path().join("no/where.mesh")).ends_with("no does not exist; make it first"));
        assert!(message(folder.path()).ends_with("this is a folder; name a file"));
        let fixed = folder.path().join("fixed");
        fs::write(&fixed, "old").unwrap();
        let mut permissions = fs::metadata(&fixed).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&fixed, permissions).unwrap();
        assert!(message(&fixed).contains("read-only"));
        assert_eq!(fs::read(&fixed).unwrap(), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_its_target_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_beside(&link, |w| w.write_all(b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
    }
}
