//! Values of numbered items in files of a scratch folder.
use super::gathered::runs;
use crate::mesh::io::Error;
use crate::mesh::io::slices::Positioned;
use bytemuck::Pod;
use std::fs::{self, File};
use std::marker::PhantomData;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A folder for files that go with the process, however it ends: they have no name any more when anything is written to them.
#[derive(Debug)]
pub struct Scratch {
    folder: PathBuf,
    made: AtomicU32,
}

impl Scratch {
    /// In a folder that is there.
    pub fn within(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), made: AtomicU32::new(0) }
    }

    /// An empty column.
    ///
    /// # Errors
    /// [`Error::System`] when no file can be made.
    pub fn column<T: Pod>(&self) -> Result<Column<T>, Error> {
        let name = format!(".geo-adapt-{}-{}", std::process::id(), self.made.fetch_add(1, Relaxed));
        let path = self.folder.join(name);
        let made = File::options().read(true).write(true).create_new(true).open(&path);
        let file = made.and_then(|file| fs::remove_file(&path).map(|()| file));
        let file = file.map_err(|error| Error::system(&self.folder, error))?;
        Ok(Column { file: Positioned::new(file), folder: self.folder.clone(), of: PhantomData })
    }
}

/// A value for each item, from 0, in a file. Many threads may read and write at once, each other items.
#[derive(Debug)]
pub struct Column<T> {
    file: Positioned,
    folder: PathBuf,
    of: PhantomData<T>,
}

impl<T: Pod> Column<T> {
    /// Those of some items, which have been written.
    ///
    /// # Errors
    /// [`Error::System`] when they cannot be read.
    pub fn read(&self, range: Range<usize>) -> Result<Vec<T>, Error> {
        let mut values = Vec::new();
        self.read_to(range, &mut values)?;
        Ok(values)
    }

    /// As [`Column::read`], into a list that is there.
    ///
    /// # Errors
    /// As there.
    pub fn read_to(&self, range: Range<usize>, values: &mut Vec<T>) -> Result<(), Error> {
        values.resize(range.len(), T::zeroed());
        let read = self.file.read(bytemuck::cast_slice_mut(values), Self::place(range.start));
        read.map_err(|error| Error::system(&self.folder, error))
    }

    /// Puts values in, from item `start` on.
    ///
    /// # Errors
    /// [`Error::System`] when they cannot be written: say, on a full disk.
    pub fn write(&self, start: usize, values: &[T]) -> Result<(), Error> {
        let written = self.file.write(bytemuck::cast_slice(values), Self::place(start));
        written.map_err(|error| Error::system(&self.folder, error))
    }

    /// Those of these items, shape (n,), which ascend.
    ///
    /// # Errors
    /// As of [`Column::read`].
    pub fn at(&self, items: &[u32]) -> Result<Vec<T>, Error> {
        let (mut found, mut run) = (Vec::with_capacity(items.len()), Vec::new());
        for places in runs(items) {
            let (items, first) = (&items[places.clone()], items[places.start]);
            self.read_to(first as usize..items[items.len() - 1] as usize + 1, &mut run)?;
            found.extend(items.iter().map(|&item| run[(item - first) as usize]));
        }
        Ok(found)
    }

    /// Replaces those of these items, shape (n,), which ascend. What lies between them is read and written back.
    ///
    /// # Errors
    /// As of [`Column::read`] and [`Column::write`].
    pub fn replace(&self, items: &[u32], values: &[T]) -> Result<(), Error> {
        let mut run = Vec::new();
        for places in runs(items) {
            let (items, first) = (&items[places.clone()], items[places.start]);
            self.read_to(first as usize..items[items.len() - 1] as usize + 1, &mut run)?;
            items.iter().zip(&values[places]).for_each(|(&item, value)| run[(item - first) as usize] = *value);
            self.write(first as usize, &run)?;
        }
        Ok(())
    }

    /// Where an item is in the file.
    fn place(item: usize) -> u64 {
        (item * size_of::<T>()) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_back_wherever_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = Scratch::within(folder.path());
        let (column, other) = (scratch.column::<[f64; 2]>().unwrap(), scratch.column::<u32>().unwrap());
        let all: Vec<[f64; 2]> = (0..500).map(|i| [f64::from(i), f64::from(-i)]).collect();
        column.write(200, &all[200..]).unwrap();
        column.write(0, &all[..200]).unwrap();
        other.write(3, &[7]).unwrap();
        assert_eq!(column.read(190..210).unwrap(), all[190..210]);
        let items = [0, 1, 5, 40, 300, 499];
        column.replace(&items, &[[0.5; 2]; 6]).unwrap();
        assert_eq!(column.at(&items).unwrap(), [[0.5; 2]; 6]);
        assert_eq!(column.at(&[2, 39, 41, 299, 498]).unwrap(), [2, 39, 41, 299, 498].map(|i: usize| all[i]));
        assert_eq!(other.read(3..4).unwrap(), [7]);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "they have no name");
        assert!(column.read(499..501).unwrap_err().to_string().contains(folder.path().to_str().unwrap()));
        let none = Scratch::within(&folder.path().join("none")).column::<u32>();
        assert!(none.unwrap_err().to_string().contains("none"));
    }
}
