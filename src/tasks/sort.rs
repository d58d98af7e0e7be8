//! Sorting on all threads: each sorts a run, then the runs are merged in pairs, every pair by many threads.
use super::team::Team;
use std::cmp::Ordering;
use std::ops::Range;

/// Fewer items than this are sorted by one thread.
const FEW: usize = if cfg!(debug_assertions) { 1 << 8 } else { 1 << 13 };

impl Team<'_> {
    /// Sorts by an order in which only equal items are equal: so there is one result.
    pub fn sort_by<T: Copy + Send + Sync>(self, items: &mut Vec<T>, order: impl Fn(&T, &T) -> Ordering + Sync) {
        let count = items.len();
        if self.threads() == 1 || count < 2 * FEW {
            items.sort_unstable_by(order);
            return;
        }
        let mut run = count.div_ceil(self.threads()).max(FEW);
        self.fill(run, items, |_, run| run.sort_unstable_by(&order));
        let piece = count.div_ceil(4 * self.threads());
        while run < count {
            let merged = self.chunks(piece, count, |range| merge_piece(items, run, range, &order));
            *items = self.join(merged);
            run *= 2;
        }
    }

    /// Sorts items by an order in which different items are never equal.
    pub fn sort<T: Copy + Ord + Send + Sync>(self, items: &mut Vec<T>) {
        self.sort_by(items, T::cmp);
    }
}

/// What comes to these places when each two runs that follow one another are merged.
fn merge_piece<T: Copy>(items: &[T], run: usize, places: Range<usize>, order: &impl Fn(&T, &T) -> Ordering) -> Vec<T> {
    let mut merged = Vec::with_capacity(places.len());
    let mut at = places.start;
    while at < places.end {
        let pair = at / (2 * run) * (2 * run);
        let middle = items.len().min(pair + run);
        let end = items.len().min(pair + 2 * run);
        let (left, right) = (&items[pair..middle], &items[middle..end]);
        let upto = places.end.min(end);
        let (i, k) = (split(left, right, at - pair, order), split(left, right, upto - pair, order));
        merge(&left[i..k], &right[at - pair - i..upto - pair - k], order, &mut merged);
        at = upto;
    }
    merged
}

/// How many of the first `count` items of the merged runs are from the left one. Of equal items those of the left one come first.
fn split<T>(left: &[T], right: &[T], count: usize, order: &impl Fn(&T, &T) -> Ordering) -> usize {
    let (mut low, mut high) = (count.saturating_sub(right.len()), count.min(left.len()));
    while low < high {
        let middle = (low + high) / 2;
        // Whether left[middle] is among the first `count`.
        if order(&left[middle], &right[count - middle - 1]).is_le() {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

fn merge<T: Copy>(mut left: &[T], mut right: &[T], order: &impl Fn(&T, &T) -> Ordering, merged: &mut Vec<T>) {
    while let ([first, left_rest @ ..], [second, right_rest @ ..]) = (left, right) {
        if order(first, second).is_le() {
            merged.push(*first);
            left = left_rest;
        } else {
            merged.push(*second);
            right = right_rest;
        }
    }
    merged.extend_from_slice(left);
    merged.extend_from_slice(right);
}
