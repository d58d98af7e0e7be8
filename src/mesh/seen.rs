//! A set of vertex numbers that is emptied at no cost, for the few hundred around a vertex: open addressing in the first cache.

/// The set; room grows with what is put in.
pub struct Seen {
    /// The number of the round in the upper half, the vertex in the lower one.
    slots: Vec<u64>,
    round: u32,
    count: usize,
}

impl Default for Seen {
    fn default() -> Self {
        Self { slots: vec![0; 256], round: 1, count: 0 }
    }
}

impl Seen {
    /// Empties the set.
    #[inline]
    pub fn forget(&mut self) {
        self.count = 0;
        match self.round.checked_add(1) {
            Some(round) => self.round = round,
            None => {
                self.slots.fill(0);
                self.round = 1;
            }
        }
    }

    /// Puts a vertex in; whether it is new.
    #[inline]
    pub fn insert(&mut self, vertex: u32) -> bool {
        let mask = self.slots.len() - 1;
        let entry = u64::from(self.round) << 32 | u64::from(vertex);
        // Fibonacci hashing: the upper bits of the product.
        let mut at = (vertex.wrapping_mul(0x9E37_79B9) >> 8) as usize & mask;
        while self.slots[at] >> 32 == u64::from(self.round) {
            if self.slots[at] == entry {
                return false;
            }
            at = (at + 1) & mask;
        }
        self.slots[at] = entry;
        self.count += 1;
        if 2 * self.count > self.slots.len() {
            self.grow();
        }
        true
    }

    #[cold]
    fn grow(&mut self) {
        let room = 4 * self.slots.len();
        let old = std::mem::replace(&mut self.slots, vec![0; room]);
        self.count = 0;
        let round = u64::from(self.round);
        for entry in old.into_iter().filter(|entry| entry >> 32 == round) {
            self.insert(entry as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_new_once_a_round() {
        let mut seen = Seen { round: u32::MAX - 2, ..Seen::default() };
        for _ in 0..5 {
            for step in [1, 7, 1 << 20] {
                seen.forget();
                assert!((0..3000).all(|i| seen.insert(i * step)));
                assert!((0..3000).all(|i| !seen.insert(i * step)));
                assert!(seen.insert(3000 * step));
            }
        }
    }
}
