//! Some rows of a file, wherever they are.
use std::ops::Range;

/// Rows that are read though nobody asks for them, where those on both sides are asked for: to read them takes less than a call.
const GAP: u32 = 32;

/// Most rows that are read at once.
const MOST: u32 = 1 << 13;

/// The ranges to be read for these rows, in ascending order, each with the rows that are asked for in it.
pub fn runs(rows: &[u32]) -> impl Iterator<Item = (Range<usize>, &[u32])> {
    let first = |run: &[u32]| run[0];
    let mut begin = rows.first().copied().unwrap_or_default();
    let together = move |a: &u32, b: &u32| {
        let is_one = *b - *a <= GAP && *b - begin < MOST;
        if !is_one {
            begin = *b;
        }
        is_one
    };
    rows.chunk_by(together).map(move |run| (first(run) as usize..run[run.len() - 1] as usize + 1, run))
}

/// What `read` gives for each of these rows, in ascending order.
///
/// # Errors
/// The first of `read`.
pub fn gathered<T: Copy, E>(rows: &[u32], read: impl Fn(Range<usize>) -> Result<Vec<T>, E>) -> Result<Vec<T>, E> {
    let mut found = Vec::with_capacity(rows.len());
    for (range, rows) in runs(rows) {
        let start = range.start;
        let values = read(range)?;
        found.extend(rows.iter().map(|&row| values[row as usize - start]));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_in_few_ranges_and_found_again() {
        let rows: Vec<u32> = [3, 4, 30].into_iter().chain((100..30_000).step_by(7)).chain([1_000_000]).collect();
        let found: Vec<_> = runs(&rows).collect();
        assert!(found.len() < 10 && found[0].0 == (3..31) && found.last().unwrap().0 == (1_000_000..1_000_001));
        assert!(found.iter().all(|(range, _)| range.len() <= MOST as usize));
        assert_eq!(found.iter().flat_map(|(_, rows)| rows.iter()).copied().collect::<Vec<_>>(), rows);
        let values = gathered(&rows, |range| Ok::<_, ()>(range.map(|row| row as u32).collect()));
        assert_eq!(values, Ok(rows));
        assert_eq!(gathered(&[0], |_| Err::<Vec<u32>, _>("no")), Err("no"));
        assert_eq!(runs(&[]).count(), 0);
    }
}
