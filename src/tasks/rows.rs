//! Rows of different lengths, one after the other (compressed rows): items by keys, the neighbours of vertices, the sides of edges.
use super::team::{GRAIN, Team};
use super::words::{plain, zeros};
use std::sync::atomic::Ordering::Relaxed;

/// Rows of 32-bit numbers, fewer than 2³² in all.
pub struct Rows {
    /// Where each row begins, and the end of the last: shape (n + 1,).
    starts: Vec<u32>,
    entries: Vec<u32>,
}

/// Ranges of the keys, and shares of the items at most, where they are dealt out twice.
const RANGES: usize = 256;
/// See [`RANGES`].
const SHARES: usize = 256;

/// Keys a task: one takes some nanoseconds.
const KEYS: usize = 4 * GRAIN;

impl Rows {
    /// The key of an entry that goes into no row.
    pub const NOWHERE: u32 = u32::MAX;

    /// A row for each key, of the entries that have it, ascending: a counting sort. Item i brings the entries N·i, N·i + 1, …, each with its
    /// key below `keys`.
    pub fn by_key<const N: usize>(
        team: Team<'_>,
        keys: usize,
        items: usize,
        key: impl Fn(usize) -> [u32; N] + Sync,
    ) -> Self {
        Self::deal_out(team, keys, items, key, |item| std::array::from_fn(|k| (N * item + k) as u32))
    }

    /// For each of so many nodes the elements that have it, ascending.
    pub fn at_nodes<const N: usize>(team: Team<'_>, elements: &[[u32; N]], nodes: usize) -> Self {
        Self::deal_out(team, nodes, elements.len(), |element| elements[element], |element| [element as u32; N])
    }

    /// The counting sort: what each item brings, by its keys.
    ///
    /// Each thread counts and deals out one part of the items, with counts of its own: no word is locked, and the entries of a key
    /// come out ascending however many parts there are.
    fn deal_out<const N: usize>(
        team: Team<'_>,
        keys: usize,
        items: usize,
        key: impl Fn(usize) -> [u32; N] + Sync,
        brings: impl Fn(usize) -> [u32; N] + Sync,
    ) -> Self {
        // The counts of all parts are no longer than the entries. Where that makes too few parts, two steps are faster.
        if team.threads() > N * items / keys.max(1) + 1 {
            let keyed = |item| key(item).into_iter().zip(brings(item)).filter(|&(key, _)| key != Self::NOWHERE);
            return Self::deal_out_twice(team, keys, items, keyed);
        }
        let parts = team.threads().min(N * items / keys.max(1)).max(1);
        let part = items.div_ceil(parts).max(1);
        let mut places = team.chunks(part, items, |range| {
            let mut counts = vec![0u32; keys];
            range.flat_map(&key).filter(|&key| key != Self::NOWHERE).for_each(|key| counts[key as usize] += 1);
            counts
        });
        let starts = starts(team, keys, &mut places);
        // Written once each, by different tasks.
        let entries = zeros(starts[keys] as usize);
        team.fill(1, &mut places, |index, places| {
            for (places, index) in places.iter_mut().zip(index..) {
                for item in index * part..items.min((index + 1) * part) {
                    let keyed = key(item).into_iter().zip(brings(item));
                    for (key, entry) in keyed.filter(|&(key, _)| key != Self::NOWHERE) {
                        let place = &mut places[key as usize];
                        entries[*place as usize].store(entry, Relaxed);
                        *place += 1;
                    }
                }
            }
        });
        Self { starts, entries: plain(entries) }
    }

    /// Each task deals a share of the items out to ranges of the keys; then each range is sorted, with counts of its own keys alone.
    fn deal_out_twice<I: Iterator<Item = (u32, u32)>>(
        team: Team<'_>,
        keys: usize,
        items: usize,
        keyed: impl Fn(usize) -> I + Sync,
    ) -> Self {
        let width = keys.div_ceil(RANGES).max(1);
        let shares = team.chunks(items.div_ceil(SHARES).max(GRAIN), items, |range| {
            // Counted two places on: while the entries are dealt out, each start moves to the next one's place.
            let mut starts = [0u32; RANGES + 2];
            range.clone().flat_map(&keyed).for_each(|(key, _)| starts[key as usize / width + 2] += 1);
            (1..starts.len()).for_each(|at| starts[at] += starts[at - 1]);
            let mut dealt = vec![(0, 0); starts[RANGES + 1] as usize];
            for (key, entry) in range.flat_map(&keyed) {
                let place = &mut starts[key as usize / width + 1];
                dealt[*place as usize] = (key, entry);
                *place += 1;
            }
            (starts, dealt)
        });
        let of_range = |range: usize| {
            shares.iter().flat_map(move |(starts, dealt)| &dealt[starts[range] as usize..starts[range + 1] as usize])
        };
        let sorted = team.chunks(1, keys.div_ceil(width), |range| {
            let (first, count) = (range.start * width, width.min(keys - range.start * width));
            let mut ends = vec![0u32; count + 1];
            of_range(range.start).for_each(|&(key, _)| ends[key as usize - first + 1] += 1);
            (1..=count).for_each(|at| ends[at] += ends[at - 1]);
            let mut entries = vec![0; ends[count] as usize];
            // Each start moves to its end.
            for &(key, entry) in of_range(range.start) {
                let place = &mut ends[key as usize - first];
                entries[*place as usize] = entry;
                *place += 1;
            }
            ends.truncate(count);
            (ends, entries)
        });
        Self::of_parts(team, &sorted)
    }

    /// The rows of several parts, one part after the other: of each where its rows end in its entries.
    pub fn of_parts(team: Team<'_>, parts: &[(Vec<u32>, Vec<u32>)]) -> Self {
        let mut starts = Vec::with_capacity(1 + parts.iter().map(|(ends, _)| ends.len()).sum::<usize>());
        starts.push(0);
        let mut before = 0;
        for (ends, entries) in parts {
            starts.extend(ends.iter().map(|end| before + end));
            before += entries.len() as u32;
        }
        Self { starts, entries: team.join_slices(parts.iter().map(|(_, entries)| entries.as_slice())) }
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A row.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[u32] {
        &self.entries[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// The entries of all rows, in the order of the rows.
    pub fn into_entries(self) -> Vec<u32> {
        self.entries
    }
}

/// Where the entries of each key begin, and the end of the last, from the counts of the parts, each shape (keys,); those become where the
/// entries of each part begin.
fn starts(team: Team<'_>, keys: usize, counts: &mut [Vec<u32>]) -> Vec<u32> {
    let sums = team.chunks(KEYS, keys, |range| -> u32 {
        counts.iter().map(|counts| counts[range.clone()].iter().sum::<u32>()).sum()
    });
    let mut starts = vec![0; keys + 1];
    let mut before = 0;
    let mut blocks: Vec<_> = starts[1..]
        .chunks_mut(KEYS)
        .zip(sums)
        .map(|(ends, sum)| {
            before += sum;
            (before - sum, ends, Vec::with_capacity(counts.len()))
        })
        .collect();
    for counts in counts {
        blocks.iter_mut().zip(counts.chunks_mut(KEYS)).for_each(|(block, counts)| block.2.push(counts));
    }
    team.fill(1, &mut blocks, |_, blocks| {
        for (sum, ends, counts) in blocks {
            for (key, end) in ends.iter_mut().enumerate() {
                for counts in counts.iter_mut() {
                    *sum += std::mem::replace(&mut counts[key], *sum);
                }
                *end = *sum;
            }
        }
    });
    starts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tasks::{Plan, Pool};

    /// Two keys an item: a few of many, some of them nowhere.
    fn key(item: usize, keys: usize) -> [u32; 2] {
        let mixed = (item as u32).wrapping_mul(2_654_435_761) >> 7;
        let first = if item.is_multiple_of(7) { Rows::NOWHERE } else { mixed % keys as u32 };
        [first, (item * keys / 20_000) as u32]
    }

    #[test]
    fn entries_of_a_key_are_ascending_however_many_threads_sort_them() {
        let items = 20_000;
        // Many keys for few items are dealt out twice by several threads; few keys never.
        for keys in [1, 5, 300, 7_001, 30_000] {
            let mut expected = vec![Vec::new(); keys];
            for item in 0..items {
                for (k, key) in key(item, keys).into_iter().enumerate().filter(|(_, key)| *key != Rows::NOWHERE) {
                    expected[key as usize].push((2 * item + k) as u32);
                }
            }
            for threads in [1, 2, 5, 16] {
                let pool = Pool::new(threads).unwrap();
                let rows = Rows::by_key(Team::new(&pool, Plan::default()), keys, items, |item| key(item, keys));
                assert_eq!(rows.len(), keys);
                assert!((0..keys).all(|row| rows.row(row) == expected[row]), "{keys} keys, {threads} threads");
            }
        }
        let none = Rows::by_key(Team::alone(), 3, 0, |_| [0]);
        assert_eq!((none.len(), none.row(2).len()), (3, 0));
        let pool = Pool::new(4).unwrap();
        assert!(Rows::by_key(Team::new(&pool, Plan::default()), 0, 0, |_| [0]).is_empty());
    }
}
