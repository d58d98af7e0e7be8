//! Which rows have been written.
use std::collections::BTreeMap;
use std::ops::Range;

/// Ranges of rows that do not overlap, by where they begin; those that touch are one.
#[derive(Debug, Default)]
pub(super) struct Covered(BTreeMap<usize, usize>);

impl Covered {
    /// Takes a range in, or tells the first row of it that is there already.
    pub(super) fn add(&mut self, range: Range<usize>) -> Result<(), usize> {
        if range.is_empty() {
            return Ok(());
        }
        let Range { mut start, mut end } = range;
        if let Some((&before, &its_end)) = self.0.range(..=start).next_back() {
            if its_end > start {
                return Err(start);
            }
            if its_end == start {
                start = before;
            }
        }
        if let Some((&after, &its_end)) = self.0.range(range.start..).next() {
            if after < end {
                return Err(after);
            }
            if after == end {
                self.0.remove(&after);
                end = its_end;
            }
        }
        self.0.insert(start, end);
        Ok(())
    }

    /// The ranges, ascending.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.0.iter().map(|(&start, &end)| start..end)
    }

    /// Number of rows, and the first that is missing.
    pub(super) fn rows(&self) -> (usize, usize) {
        let count = self.0.iter().map(|(start, end)| end - start).sum();
        (count, self.0.get(&0).copied().unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_join_and_do_not_overlap() {
        let mut covered = Covered::default();
        assert_eq!(covered.rows(), (0, 0));
        assert_eq!([4..6, 8..9, 0..2, 3..3].map(|range| covered.add(range)), [Ok(()); 4]);
        assert_eq!(covered.rows(), (5, 2));
        assert_eq!(
            [3..5, 5..7, 2..10, 1..2, 0..1].map(|range| covered.add(range)),
            [Err(4), Err(5), Err(4), Err(1), Err(0)]
        );
        assert_eq!(covered.rows(), (5, 2));
        assert_eq!([2..4, 6..8].map(|range| covered.add(range)), [Ok(()); 2]);
        assert_eq!(covered.rows(), (9, 9));
        assert_eq!(covered.0.len(), 1);
    }
}
