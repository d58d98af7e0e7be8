//! Writing files so that each is either the old one or the whole new one, and those that belong together change together.
use super::Error;
use super::layout::To;
use super::place::{Place, Temporary, create_file, folder_of, follow, new_beside, refusal};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
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
    /// Files that [`Batch::open`] gave away, with their targets.
    open: Vec<(PathBuf, File)>,
}

/// The files that are written already, each with its target.
struct Staged {
    from: Temporary,
    to: PathBuf,
    sync: Option<Syncing>,
}

/// Brings a file to the disk while others are written: what it comes to.
type Syncing = JoinHandle<io::Result<()>>;

/// What writes the bytes of a file, called once.
type Content<'a> = &'a mut dyn FnMut(To<'_>) -> io::Result<()>;

/// Bytes that are gathered for a file before they are written.
const BUFFER: usize = 1 << 18;

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
        self.add_laid_out(path, false, |to| in_order(to, write))
    }

    /// As [`Batch::add`], of the file that the others belong to: it is renamed last.
    ///
    /// # Errors
    /// As there.
    pub fn add_main(&mut self, path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
        self.add_laid_out(path, true, |to| in_order(to, write))
    }

    /// As [`Batch::add`] or [`Batch::add_main`], by what may write the file at any place.
    pub(super) fn add_laid_out(
        &mut self,
        path: &Path,
        is_main: bool,
        write: impl FnOnce(To<'_>) -> io::Result<()>,
    ) -> Result<(), Error> {
        let mut write = Some(write);
        let mut content = |to: To<'_>| write.take().map_or(Ok(()), |write| write(to));
        let staged = self.stage(path, &mut content).map_err(|error| Error::system(path, error))?;
        if is_main { &mut self.main } else { &mut self.files }.extend(staged);
        Ok(())
    }

    /// As [`Batch::add`], or as [`Batch::add_main`] if it `is_main`: an empty file beside the target, for who writes it at any place. It must be
    /// whole before [`Batch::commit`].
    ///
    /// # Errors
    /// As there, and for a device or a pipe, which can only be written from front to back.
    pub fn open(&mut self, path: &Path, is_main: bool) -> Result<File, Error> {
        let stream = || refusal("this is a device or a pipe, which is written in order; name a file");
        let mut files = Err(stream());
        self.add_laid_out(path, is_main, |to| {
            let To::File(file) = to else { return Err(stream()) };
            files = file.try_clone().and_then(|own| Ok((own, file.try_clone()?)));
            Ok(())
        })?;
        let (own, file) = files.map_err(|error| Error::system(path, error))?;
        self.open.push((path.to_owned(), own));
        Ok(file)
    }

    /// Where a file of [`Batch::open`] lies until [`Batch::commit`] gives it its name: other processes find it there.
    pub fn beside(&self, path: &Path) -> Option<&Path> {
        let follow = follow(path).ok()?;
        self.files.iter().chain(&self.main).find(|staged| staged.to == follow).map(|staged| &*staged.from.path)
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
    /// [`Error::System`] when one cannot be brought to the disk, removed or renamed.
    pub fn commit(mut self) -> Result<(), Error> {
        for (to, file) in self.open.drain(..) {
            file.sync_all().map_err(|error| Error::system(&to, error))?;
        }
        for Staged { to, sync, .. } in self.files.iter_mut().chain(&mut self.main) {
            let Some(sync) = sync.take() else { continue };
            let synced = sync.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            synced.map_err(|error| Error::system(to, error))?;
        }
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
        for Staged { from, to, .. } in files.into_iter().chain(main).chain(folders) {
            from.rename(&to).map_err(|error| Error::system(&to, error))?;
        }
        Ok(())
    }

    /// Writes the bytes. Returns what is to be renamed, if anything.
    fn stage(&self, path: &Path, content: Content<'_>) -> io::Result<Option<Staged>> {
        if let Some(inside) = self.inside(path) {
            // Its folder is renamed.
            let file = File::create(inside)?;
            content(To::File(&file))?;
            return file.sync_all().map(|()| None);
        }
        match Place::of(path)? {
            Place::Device => {
                let mut file = BufWriter::new(OpenOptions::new().write(true).open(path)?);
                content(To::Stream(&mut file))?;
                file.flush().map(|()| None)
            }
            Place::Stdout => {
                let mut out = io::stdout().lock();
                content(To::Stream(&mut out))?;
                out.flush().map(|()| None)
            }
            Place::File { path, before } => {
                let (file, from) = new_beside(&path, create_file)?;
                content(To::File(&file))?;
                if let Some(before) = before {
                    file.set_permissions(before.permissions())?;
                }
                Ok(Some(Staged { from, to: path, sync: synced(file)? }))
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
        self.folders.push(Staged { from, to: top.to_owned(), sync: None });
        Ok(())
    }
}

/// Stack of a thread that waits for the disk, bytes.
const STACK: usize = 1 << 16;

/// Syncs a file: a full disk may refuse its bytes only then. A thread waits for that, where one can be had.
fn synced(file: File) -> io::Result<Option<Syncing>> {
    let file = Arc::new(file);
    let own = Arc::clone(&file);
    match Builder::new().stack_size(STACK).spawn(move || own.sync_all()) {
        Ok(sync) => Ok(Some(sync)),
        Err(_) => file.sync_all().map(|()| None),
    }
}

/// Calls what writes from front to back.
fn in_order(to: To<'_>, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    match to {
        To::File(file) => {
            let mut buffered = BufWriter::with_capacity(BUFFER, file);
            write(&mut buffered)?;
            buffered.into_inner().map(drop).map_err(io::IntoInnerError::into_error)
        }
        To::Stream(stream) => write(stream),
    }
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
