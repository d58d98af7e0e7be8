//! Rows of values of numbered items in a scratch folder.
use super::column::{Column, Scratch};
use super::gathered::runs;
use crate::mesh::io::Error;
use std::ops::Range;

/// So many values for each item, from 0, in a file. Many threads may read and write at once, each other items.
#[derive(Debug)]
pub struct Table {
    width: usize,
    values: Column<f64>,
}

impl Table {
    /// With rows of `width` values, none yet.
    ///
    /// # Errors
    /// When no file can be made.
    pub fn new(scratch: &Scratch, width: usize) -> Result<Self, Error> {
        Ok(Self { width, values: scratch.column()? })
    }

    /// Values of a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The rows of some items, shape (n, width), which have been written.
    ///
    /// # Errors
    /// When the scratch folder cannot be read.
    pub fn read(&self, range: Range<usize>) -> Result<Vec<f64>, Error> {
        self.values.read(range.start * self.width..range.end * self.width)
    }

    /// Puts rows in, from item `start` on.
    ///
    /// # Errors
    /// When the scratch folder cannot be written.
    pub fn write(&self, start: usize, rows: &[f64]) -> Result<(), Error> {
        self.values.write(start * self.width, rows)
    }

    /// The rows of these items, which ascend.
    ///
    /// # Errors
    /// As of [`Table::read`].
    pub fn at(&self, items: &[u32]) -> Result<Vec<f64>, Error> {
        let (width, mut run) = (self.width, Vec::new());
        let mut found = Vec::with_capacity(width * items.len());
        for places in runs(items) {
            let (items, first) = (&items[places.clone()], items[places.start] as usize);
            let end = items[items.len() - 1] as usize + 1;
            self.values.read_to(first * width..end * width, &mut run)?;
            for &item in items {
                found.extend_from_slice(&run[(item as usize - first) * width..][..width]);
            }
        }
        Ok(found)
    }

    /// Puts the rows of these items in, which ascend. What lies between them is not touched.
    ///
    /// # Errors
    /// As of [`Table::write`].
    pub fn put(&self, items: &[u32], rows: &[f64]) -> Result<(), Error> {
        let mut before = 0;
        for run in items.chunk_by(|a, b| a + 1 == *b) {
            self.write(run[0] as usize, &rows[before * self.width..][..run.len() * self.width])?;
            before += run.len();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_wherever_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let table = Table::new(&Scratch::within(folder.path()), 3).unwrap();
        let row = |item: u32| [0, 1, 2].map(|k| f64::from(item * 10 + k));
        let rows = |items: &[u32]| items.iter().flat_map(|&item| row(item)).collect::<Vec<f64>>();
        table.write(0, &vec![-1.0; 300]).unwrap();
        let items = [3, 4, 5, 9, 11, 60, 61, 99];
        table.put(&items, &rows(&items)).unwrap();
        assert_eq!(table.at(&items).unwrap(), rows(&items));
        assert_eq!(table.at(&[2, 3, 10, 98]).unwrap(), [vec![-1.0; 3], rows(&[3]), vec![-1.0; 6]].concat());
        assert_eq!(table.read(60..62).unwrap(), rows(&[60, 61]));
        assert_eq!(table.width(), 3);
        let none = Table::new(&Scratch::within(folder.path()), 0).unwrap();
        none.put(&[1, 2], &[]).unwrap();
        assert!(none.at(&[1, 7]).unwrap().is_empty());
    }
}
