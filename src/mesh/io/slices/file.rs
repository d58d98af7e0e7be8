//! A file that is read and written at any place, by several threads.
use super::super::binary::Bytes;
use std::cell::RefCell;
use std::fs::File;
use std::io;

/// A file without a position of its own.
#[derive(Debug)]
pub(in crate::mesh) struct Positioned {
    file: File,
    /// Where the system has no such calls: who moves the file's position.
    #[cfg(not(unix))]
    turn: std::sync::Mutex<()>,
}

impl Positioned {
    pub(in crate::mesh) fn new(file: File) -> Self {
        Self {
            file,
            #[cfg(not(unix))]
            turn: std::sync::Mutex::new(()),
        }
    }

    /// Number of bytes.
    pub(in crate::mesh) fn size(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len())
    }

    /// Brings what was written to the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_all()
    }

    /// Fills the buffer with the bytes from a place on.
    #[cfg(unix)]
    pub(in crate::mesh) fn read(&self, buffer: &mut [u8], place: u64) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, buffer, place)
    }

    /// Writes bytes at a place.
    #[cfg(unix)]
    pub(in crate::mesh) fn write(&self, bytes: &[u8], place: u64) -> io::Result<()> {
        std::os::unix::fs::FileExt::write_all_at(&self.file, bytes, place)
    }

    #[cfg(not(unix))]
    pub(in crate::mesh) fn read(&self, buffer: &mut [u8], place: u64) -> io::Result<()> {
        use std::io::{Read, Seek, SeekFrom};
        let _turn = self.turn.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        (&self.file).seek(SeekFrom::Start(place))?;
        (&self.file).read_exact(buffer)
    }

    #[cfg(not(unix))]
    pub(in crate::mesh) fn write(&self, bytes: &[u8], place: u64) -> io::Result<()> {
        use std::io::{Seek, SeekFrom, Write};
        let _turn = self.turn.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        (&self.file).seek(SeekFrom::Start(place))?;
        (&self.file).write_all(bytes)
    }
}

/// The words of a file's heads, each read when it is asked for.
pub(super) struct Heads<'f> {
    file: &'f Positioned,
    size: usize,
    failed: RefCell<Option<io::Error>>,
}

impl<'f> Heads<'f> {
    pub(super) fn of(file: &'f Positioned) -> io::Result<Self> {
        let size = usize::try_from(file.size()?).map_err(io::Error::other)?;
        Ok(Self { file, size, failed: RefCell::default() })
    }

    /// The error of reading, if there was one: what was found is then not to be trusted.
    pub(super) fn result(self) -> io::Result<()> {
        self.failed.into_inner().map_or(Ok(()), Err)
    }
}

impl Bytes for Heads<'_> {
    fn size(&self) -> usize {
        self.size
    }

    fn word<const N: usize>(&self, at: usize) -> Option<[u8; N]> {
        if at.checked_add(N)? > self.size {
            return None;
        }
        let mut word = [0; N];
        match self.file.read(&mut word, at as u64) {
            Ok(()) => Some(word),
            Err(error) => {
                self.failed.borrow_mut().get_or_insert(error);
                None
            }
        }
    }
}
