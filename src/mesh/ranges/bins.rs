//! Items dealt into bins in a scratch folder: those of a bin stay in the order in which they came.
use super::column::{Column, Scratch};
use crate::mesh::io::Error;
use bytemuck::Pod;
use std::ops::Range;

/// Bytes of what waits to be written, of all bins together.
const WAITING: usize = 4_000_000;

/// Least and most items that are written at once.
const CHUNK: Range<usize> = 16..1024;

/// Bins of items. Each has chunks of the file as it needs them, so that how many will come need not be known.
#[derive(Debug)]
pub struct Bins<T> {
    column: Column<T>,
    bins: Vec<Bin<T>>,
    /// Items of a chunk.
    chunk: usize,
    /// Chunks that some bin has.
    used: u32,
}

#[derive(Clone, Debug)]
struct Bin<T> {
    chunks: Vec<u32>,
    /// What is in no chunk yet.
    waiting: Vec<T>,
}

impl<T: Pod> Bins<T> {
    /// So many empty bins.
    ///
    /// # Errors
    /// When no file can be made.
    pub fn new(scratch: &Scratch, count: usize) -> Result<Self, Error> {
        let chunk = Self::chunk(count);
        let bins = vec![Bin { chunks: Vec::new(), waiting: Vec::new() }; count];
        Ok(Self { column: scratch.column()?, bins, chunk, used: 0 })
    }

    fn chunk(count: usize) -> usize {
        (WAITING / (count.max(1) * size_of::<T>())).clamp(CHUNK.start, CHUNK.end)
    }

    /// Bytes of memory that so many items in so many bins take.
    pub fn held(count: usize, items: usize) -> usize {
        let chunk = Self::chunk(count);
        count * (size_of::<Bin<T>>() + chunk * size_of::<T>()) + (items / chunk + count) * size_of::<u32>()
    }

    /// Puts an item behind those of a bin.
    ///
    /// # Errors
    /// When the scratch folder cannot be written.
    pub fn put(&mut self, bin: usize, item: T) -> Result<(), Error> {
        let Self { column, bins, chunk, used } = self;
        let Bin { chunks, waiting } = &mut bins[bin];
        waiting.push(item);
        if waiting.len() == *chunk {
            column.write(*used as usize * *chunk, waiting)?;
            chunks.push(*used);
            *used += 1;
            waiting.clear();
        }
        Ok(())
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        self.bins.len()
    }

    /// Number of items of a bin.
    pub fn count(&self, bin: usize) -> usize {
        let Bin { chunks, waiting } = &self.bins[bin];
        chunks.len() * self.chunk + waiting.len()
    }

    /// Calls `f` with the items of a bin, chunk by chunk in their order, until it says that it is enough (`false`).
    ///
    /// # Errors
    /// When the scratch folder cannot be read, and those of `f`.
    pub fn each_chunk<E: From<Error>>(&self, bin: usize, mut f: impl FnMut(&[T]) -> Result<bool, E>) -> Result<(), E> {
        let (Bin { chunks, waiting }, mut items) = (&self.bins[bin], Vec::new());
        for &chunk in chunks {
            let start = chunk as usize * self.chunk;
            self.column.read_to(start..start + self.chunk, &mut items)?;
            if !f(&items)? {
                return Ok(());
            }
        }
        f(waiting).map(drop)
    }

    /// All items of a bin, shape (n,).
    ///
    /// # Errors
    /// When the scratch folder cannot be read.
    pub fn items(&self, bin: usize) -> Result<Vec<T>, Error> {
        let mut all = Vec::with_capacity(self.count(bin));
        self.each_chunk(bin, |items| -> Result<bool, Error> {
            all.extend_from_slice(items);
            Ok(true)
        })?;
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bin_has_its_items_in_their_order() {
        let folder = tempfile::tempdir().unwrap();
        let scratch = Scratch::within(folder.path());
        let mut bins = Bins::new(&scratch, 3).unwrap();
        let all: Vec<u32> = (0..20_000u32).map(|i| i.wrapping_mul(2_654_435_769)).collect();
        let bin = |item: u32| [0, 2, 2, 2][item as usize % 4];
        all.iter().for_each(|&item| bins.put(bin(item), item).unwrap());
        assert_eq!(bins.bins(), 3);
        assert!(Bins::<u32>::held(3, 20_000) < 20_000 && Bins::<u32>::held(100_000, 20_000_000) > 10_000_000);
        for asked in 0..3 {
            let expected: Vec<u32> = all.iter().copied().filter(|&item| bin(item) == asked).collect();
            assert_eq!((bins.count(asked), bins.items(asked).unwrap()), (expected.len(), expected));
        }
        let mut seen = 0;
        let enough = bins.each_chunk(2, |items| -> Result<bool, Error> {
            seen += items.len();
            Ok(seen < 2000)
        });
        enough.unwrap();
        assert!((2000..5000).contains(&seen), "{seen}");
    }
}
