//! A set of 32-bit numbers that is emptied at no cost, for sets of a few hundred that are made again and again.

/// Slots at first: they fit into the first cache, and hold what is around most vertices.
const ROOM: usize = 256;

/// The set, with open addressing. It grows as needed and keeps its memory. An empty one has none: it stands where another is in use.
pub struct StampedSet {
    /// In each slot the stamp of an emptying in the upper half, the number in the lower half. One comparison tells whether a slot holds a number now.
    slots: Vec<u64>,
    stamp: u64,
    len: usize,
}

#[inline(always)]
fn spread(number: u32) -> usize {
    // Fibonacci hashing: the upper bits of the product.
    (u64::from(number).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize
}

impl Default for StampedSet {
    fn default() -> Self {
        Self { slots: Vec::new(), stamp: 1 << 32, len: 0 }
    }
}

impl StampedSet {
    /// Empties the set.
    #[inline]
    pub fn clear(&mut self) {
        self.len = 0;
        self.stamp = self.stamp.wrapping_add(1 << 32);
        if self.stamp == 0 {
            self.slots.fill(0);
            self.stamp = 1 << 32;
        }
    }

    /// Adds a number. Returns whether it was new.
    #[inline]
    pub fn insert(&mut self, number: u32) -> bool {
        if self.len * 2 >= self.slots.len() {
            self.grow();
        }
        let wanted = self.stamp | u64::from(number);
        let mask = self.slots.len() - 1;
        let mut at = spread(number) & mask;
        loop {
            let slot = self.slots[at];
            if slot < self.stamp || slot == wanted {
                // Whether it was there cannot be foreseen, so there is no branch.
                let is_new = slot != wanted;
                self.slots[at] = wanted;
                self.len += usize::from(is_new);
                return is_new;
            }
            at = (at + 1) & mask;
        }
    }

    /// Whether the number is in the set.
    #[inline]
    pub fn contains(&self, number: u32) -> bool {
        if self.slots.is_empty() {
            return false;
        }
        let wanted = self.stamp | u64::from(number);
        let mask = self.slots.len() - 1;
        let mut at = spread(number) & mask;
        loop {
            let slot = self.slots[at];
            if slot < self.stamp || slot == wanted {
                return slot == wanted;
            }
            at = (at + 1) & mask;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let larger = vec![0; ROOM.max(self.slots.len() * 2)];
        let old = std::mem::replace(&mut self.slots, larger);
        self.len = 0;
        let stamp = self.stamp;
        for slot in old.into_iter().filter(|&slot| slot >= stamp) {
            self.insert(slot as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Past the last stamp too.
    #[test]
    fn it_keeps_what_it_is_given_beyond_its_first_room_and_forgets_it_when_emptied() {
        let mut set = StampedSet { stamp: u64::from(u32::MAX - 2) << 32, ..StampedSet::default() };
        assert!(!set.contains(0) && !set.contains(u32::MAX));
        for _ in 0..5 {
            for step in [1, 7, 64, 1 << 20] {
                set.clear();
                assert!((0..3000).all(|i| !set.contains(i * step)));
                assert!((0..3000).all(|i| set.insert(i * step)));
                assert!((0..3000).all(|i| !set.insert(i * step) && set.contains(i * step)));
                assert!(!set.contains(3000 * step) && set.insert(3000 * step));
            }
        }
    }
}
