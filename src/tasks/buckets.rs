//! Items by keys, as rows of different lengths one after the other: a counting sort.
use super::team::{GRAIN, Team};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// For each key the entries that have it, ascending.
pub struct Buckets {
    /// Where the entries of each key begin, and the end of the last.
    starts: Vec<AtomicU32>,
    entries: Vec<AtomicU32>,
}

impl Buckets {
    /// A key of what goes into no bucket.
    pub const NOWHERE: u32 = u32::MAX;

    /// Item i brings the entries N·i, N·i + 1, …, each with its key below `keys`; fewer than 2³² in all.
    pub fn of<const N: usize>(
        team: Team<'_>,
        keys: usize,
        items: usize,
        key: impl Fn(usize) -> [u32; N] + Sync,
    ) -> Self {
        let zeros = |count: usize| (0..count).map(|_| AtomicU32::new(0)).collect::<Vec<_>>();
        let alone = team.threads() == 1;
        // Counted two places on: while the entries are dealt out, each start moves to the next one's place.
        let mut starts = zeros(keys + 2);
        team.for_each(GRAIN, items, |range| {
            range.flat_map(&key).filter(|&key| key != Self::NOWHERE).for_each(|key| {
                count(&starts[key as usize + 2], alone);
            });
        });
        let mut sum = 0;
        for start in &mut starts {
            sum += *start.get_mut();
            *start.get_mut() = sum;
        }
        let entries = zeros(sum as usize);
        team.for_each(GRAIN, items, |range| {
            for item in range {
                let keyed = key(item).into_iter().zip((N * item) as u32..);
                for (key, entry) in keyed.filter(|&(key, _)| key != Self::NOWHERE) {
                    entries[count(&starts[key as usize + 1], alone) as usize].store(entry, Relaxed);
                }
            }
        });
        starts.pop();
        let buckets = Self { starts, entries };
        if !alone {
            team.for_each(GRAIN, keys, |keys| buckets.sort(keys));
        }
        buckets
    }

    /// How many keys there are.
    pub fn keys(&self) -> usize {
        self.starts.len() - 1
    }

    /// The entries of a key.
    pub fn of_key(&self, key: usize) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.slots(key).iter().map(|slot| slot.load(Relaxed))
    }

    /// The entries of all keys, in the order of the keys.
    pub fn into_entries(self) -> Vec<u32> {
        self.entries.into_iter().map(AtomicU32::into_inner).collect()
    }

    fn slots(&self, key: usize) -> &[AtomicU32] {
        let [start, end] = [key, key + 1].map(|key| self.starts[key].load(Relaxed) as usize);
        &self.entries[start..end]
    }

    /// Several threads deal out in any order.
    fn sort(&self, keys: Range<usize>) {
        let mut row = Vec::new();
        for key in keys.filter(|&key| !self.of_key(key).is_sorted()) {
            row.clear();
            row.extend(self.of_key(key));
            row.sort_unstable();
            self.slots(key).iter().zip(&row).for_each(|(slot, &entry)| slot.store(entry, Relaxed));
        }
    }
}

/// Counts one more; returns the count before. One thread alone needs no bus lock for it.
#[inline(always)]
fn count(slot: &AtomicU32, alone: bool) -> u32 {
    if alone {
        let before = slot.load(Relaxed);
        slot.store(before + 1, Relaxed);
        before
    } else {
        slot.fetch_add(1, Relaxed)
    }
}
