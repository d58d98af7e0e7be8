//! Items by keys, as rows of different lengths one after the other: a counting sort.
use super::team::{GRAIN, Team};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// For each key the entries that have it, ascending.
pub struct Buckets {
    /// Where the entries of each key begin, and the end of the last.
    starts: Vec<u32>,
    /// Written once each, by different tasks.
    entries: Vec<AtomicU32>,
}

/// Keys a task: one takes some nanoseconds.
const KEYS: usize = 4 * GRAIN;

impl Buckets {
    /// A key of what goes into no bucket.
    pub const NOWHERE: u32 = u32::MAX;

    /// Item i brings the entries N·i, N·i + 1, …, each with its key below `keys`; fewer than 2³² in all.
    ///
    /// Each thread counts and deals out one part of the items, with counts of its own: no word is locked, and the entries of a key
    /// come out ascending however many parts there are.
    pub fn of<const N: usize>(
        team: Team<'_>,
        keys: usize,
        items: usize,
        key: impl Fn(usize) -> [u32; N] + Sync,
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
        let entries = zeros(starts[keys] as usize);
        team.fill(1, &mut places, |index, places| {
            for (places, index) in places.iter_mut().zip(index..) {
                for item in index * part..items.min((index + 1) * part) {
                    let keyed = key(item).into_iter().zip((N * item) as u32..);
                    for (key, entry) in keyed.filter(|&(key, _)| key != Self::NOWHERE) {
                        let place = &mut places[key as usize];
                        entries[*place as usize].store(entry, Relaxed);
                        *place += 1;
                    }
                }
            }
        });
        Self { starts, entries }
    }

    /// How many keys there are.
    pub fn keys(&self) -> usize {
        self.starts.len() - 1
    }

    /// The entries of a key.
    pub fn of_key(&self, key: usize) -> impl ExactSizeIterator<Item = u32> + '_ {
        let [start, end] = [key, key + 1].map(|key| self.starts[key] as usize);
        self.entries[start..end].iter().map(|slot| slot.load(Relaxed))
    }

    /// The entries of all keys, in the order of the keys.
    pub fn into_entries(self) -> Vec<u32> {
        self.entries.into_iter().map(AtomicU32::into_inner).collect()
    }
}

/// Room that costs nothing until it is used.
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
