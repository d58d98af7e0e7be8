//! Writing files so that each is either the old one or the whole new one, and those that belong together change together.
use super::Error;
use super::place::{Place, Temporary, create_file, folder_of, new_beside, refusal};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, Instant};

/// How long to wait for another run that renames files in the same folder, which takes it microseconds.
const PATIENCE: Duration = Duration::from_secs(1);

/// Files that belong together, such as a mesh, its solution and its names.
///
/// Each is written beside its target, under a hidden name. [`Batch::commit`] renames them one after the other, the main file last:
/// whoever looks sees whole files at any time, and a run that is killed while it writes changes nothing. One that is killed between two
/// renames has not changed the main file yet. A batch that is dropped leaves nothing.
#[derive(Default)]
pub struct Batch {
    /// Removed first.
    old: Vec<PathBuf>,
    files: Vec<Staged>,
    /// Renamed last.
    main: Vec<Staged>,
    folders: Vec<Staged>,
}

/// The files that are written already, each with its target.
struct Staged {
    from: Temporary,
    to: PathBuf,
}

/// What writes the bytes of a file.
type Content<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

impl Batch {
    /// An empty batch.
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes a file beside its target. Links are followed; a device or pipe (`/dev/stdout`) is written directly.
    ///
    /// # Errors
    /// [`Error::System`] when the folder does not exist, the file is read-only, or writing fails.
    pub fn add(&mut self, path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        let staged = self.stage(path, write).map_err(|error| Error::system(path, error))?;
        self.files.extend(staged);
        Ok(())
    }

    /// As [`Batch::add`], of the file that the others belong to: it is renamed last.
    ///
    /// # Errors
    /// As there.
    pub fn add_main(&mut self, path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        let staged = self.stage(path, write).map_err(|error| Error::system(path, error))?;
        self.main.extend(staged);
        Ok(())
    }

    /// Removes a file of an older result, which would be taken for one of this result, before the new files come.
    pub fn remove(&mut self, path: &Path) {
        self.old.push(path.to_owned());
    }

    /// Makes a folder to add files in. Where it does not exist, it is made beside its place, with the folders above it, and renamed together
    /// with its files.
    ///
    /// # Errors
    /// [`Error::System`] when something else has the name, or it cannot be made.
    pub fn folder(&mut self, path: &Path) -> Result<(), Error> {
        self.make_folder(path).map_err(|error| Error::system(path, error))
    }

    /// Gives the files their names.
    ///
    /// # Errors
    /// [`Error::System`] when one cannot be removed or renamed.
    pub fn commit(mut self) -> Result<(), Error> {
        let (files, main) = (std::mem::take(&mut self.files), std::mem::take(&mut self.main));
        let folders = std::mem::take(&mut self.folders);
        let all = files.len() + main.len() + folders.len() + self.old.len();
        let last = main.last().or(files.last());
        // Two runs that write the same files take turns, so that all files come from one of them.
        let _turn = last.filter(|_| all > 1).and_then(|staged| turn(folder_of(&staged.to)));
        for path in &self.old {
            match fs::remove_file(path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(Error::system(path, error)),
                _ => {}
            }
        }
        for Staged { from, to } in files.into_iter().chain(main).chain(folders) {
            from.rename(&to).map_err(|error| Error::system(&to, error))?;
        }
        Ok(())
    }

    /// Writes the bytes. Returns what is to be renamed, if anything.
    fn stage(&self, path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<Option<Staged>> {
        let mut write = Some(write);
        let mut content = |to: &mut dyn Write| write.take().map_or(Ok(()), |write| write(to));
        if let Some(inside) = self.inside(path) {
            // Its folder is renamed.
            return fill(File::create(inside)?, &mut content).map(|_| None);
        }
        match Place::of(path)? {
            Place::Device => {
                let mut file = BufWriter::new(OpenOptions::new().write(true).open(path)?);
                content(&mut file)?;
                file.flush().map(|()| None)
            }
            Place::Stdout => {
                let mut out = io::stdout().lock();
                content(&mut out)?;
                out.flush().map(|()| None)
            }
            Place::File { path, before } => {
                let (file, from) = new_beside(&path, create_file)?;
                let file = fill(file, &mut content)?;
                if let Some(before) = before {
                    file.set_permissions(before.permissions())?;
                }
                Ok(Some(Staged { from, to: path }))
            }
        }
    }

    /// Where a file in a new folder is written.
    fn inside(&self, path: &Path) -> Option<PathBuf> {
        self.folders.iter().find_map(|folder| Some(folder.from.path.join(path.strip_prefix(&folder.to).ok()?)))
    }

    fn make_folder(&mut self, path: &Path) -> io::Result<()> {
        if path.is_dir() {
            return Ok(());
        }
        if let Some(inside) = self.inside(path) {
            return fs::create_dir_all(inside);
        }
        let is_new = |folder: &&Path| !folder.as_os_str().is_empty() && fs::symlink_metadata(folder).is_err();
        let Some(top) = path.ancestors().take_while(is_new).last() else {
            return Err(io::Error::new(ErrorKind::AlreadyExists, "there is a file of this name; name another folder"));
        };
        let below = path.strip_prefix(top).unwrap_or(Path::new(""));
        let is_plain = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
        if top.file_name().is_none() || !below.components().all(is_plain) {
            return Err(refusal("'..' follows a folder that is not there; write the path without it"));
        }
        let ((), from) = new_beside(top, |path| fs::create_dir(path))?;
        fs::create_dir_all(from.path.join(below))?;
        self.folders.push(Staged { from, to: top.to_owned() });
        Ok(())
    }
}

/// Writes the bytes and syncs them: a full disk may refuse them only then.
fn fill(file: File, write: Content<'_>) -> io::Result<File> {
    let mut buffered = BufWriter::with_capacity(1 << 18, file);
    write(&mut buffered)?;
    let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.sync_all()?;
    Ok(file)
}

/// The right to rename files in a folder. Where the system has no such lock, or another process holds it all the time, we do without.
fn turn(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let began = Instant::now();
    while let Err(error) = folder.try_lock() {
        if !matches!(error, fs::TryLockError::WouldBlock) || began.elapsed() > PATIENCE {
            return None;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    Some(folder)
}

/// Calls `write` on a temporary file in `path`'s folder, then renames it to `path`: a [`Batch`] of one file.
///
/// # Errors
/// [`Error::System`] when the folder does not exist, the file is read-only, or writing fails; then `path` is as it was.
pub fn write_beside(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    let mut batch = Batch::new();
    batch.add(path, write)?;
    batch.commit()
}

#[cfg(test)]
mod tests;
