//! Rows of different lengths, one after the other (compressed rows): items by keys, the neighbours of vertices, the sides of edges.
use super::team::{GRAIN, Team};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Rows of 32-bit numbers, fewer than 2³² in all.
pub struct Rows {
    /// Where each row begins, and the end of the last: shape (n + 1,).
    starts: Vec<u32>,
    entries: Vec<u32>,
}

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
        // The counts of all parts are no longer than the entries.
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
        Self { starts, entries: entries.into_iter().map(AtomicU32::into_inner).collect() }
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

/// Zeroed memory, which costs nothing until it is used.
fn zeros(count: usize) -> Vec<AtomicU32> {
    bytemuck::allocation::zeroed_vec(count)
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
