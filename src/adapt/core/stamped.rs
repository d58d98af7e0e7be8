//! A small map that an operation needs while it looks at its cavity: cleared by a new stamp, allocated once, as [`crate::mesh::stamped_set`] is.

#[inline(always)]
fn hash(key: u64) -> usize {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize
}

/// A map from triangles (three vertex ids in any order) to a value. It uses no more of its slots than it needs, which stay in the nearest cache.
pub struct FaceMap<T> {
    slots: Vec<(u32, [u32; 3], T)>,
    /// One less than the slots in use, a power of two.
    mask: usize,
    stamp: u32,
    len: usize,
}

#[inline(always)]
fn sorted([a, b, c]: [u32; 3]) -> [u32; 3] {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    [low, a ^ b ^ c ^ low ^ high, high]
}

impl<T: Copy + Default> Default for FaceMap<T> {
    fn default() -> Self {
        Self { slots: vec![(0, [0; 3], T::default()); 512], mask: 511, stamp: 1, len: 0 }
    }
}

impl<T: Copy + Default> FaceMap<T> {
    /// Empties the map, for about so many triangles.
    #[inline]
    pub fn clear(&mut self, triangles: usize) {
        self.len = 0;
        self.mask = (2 * triangles).next_power_of_two().clamp(16, self.slots.len()) - 1;
        self.renew();
    }

    /// Nothing that was entered before counts.
    #[inline]
    fn renew(&mut self) {
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill((0, [0; 3], T::default()));
            self.stamp = 1;
        }
    }

    /// The value of a triangle, entered with its default when new; and whether it is new.
    #[inline]
    pub fn entry(&mut self, face: [u32; 3]) -> (&mut T, bool) {
        if self.len * 2 > self.mask {
            self.grow();
        }
        let key = sorted(face);
        let (at, found) = self.find(key);
        if !found {
            self.slots[at] = (self.stamp, key, T::default());
            self.len += 1;
        }
        (&mut self.slots[at].2, !found)
    }

    #[inline]
    fn find(&self, key: [u32; 3]) -> (usize, bool) {
        let mixed =
            (u64::from(key[0]) << 32 | u64::from(key[1])) ^ (u64::from(key[2]).wrapping_mul(0xD6E8_FEB8_6659_FD93));
        let mut at = hash(mixed) & self.mask;
        loop {
            let slot = &self.slots[at];
            if slot.0 != self.stamp {
                return (at, false);
            }
            if slot.1 == key {
                return (at, true);
            }
            at = (at + 1) & self.mask;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let known: Vec<_> = self.slots[..=self.mask].iter().filter(|slot| slot.0 == self.stamp).copied().collect();
        self.len = 0;
        self.mask = 2 * self.mask + 1;
        if self.mask < self.slots.len() {
            self.renew();
        } else {
            self.slots = vec![(0, [0; 3], T::default()); self.mask + 1];
        }
        for (_, key, value) in known {
            *self.entry(key).0 = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_found_in_any_order_of_its_vertices() {
        let mut map = FaceMap::<u32>::default();
        // More than was said, and then more than there is room for.
        for (said, count) in [(3, 200), (1000, 900), (0, 2000)] {
            map.clear(said);
            for i in 0..count {
                let (value, new) = map.entry([i + 7, i, i + 3]);
                assert!(new);
                *value = i;
            }
            for i in 0..count {
                assert_eq!(*map.entry([i, i + 3, i + 7]).0, i);
                assert!(!map.entry([i + 3, i + 7, i]).1);
            }
            assert!(map.entry([1, 2, 3]).1);
        }
        map.clear(0);
        assert!(map.entry([0, 3, 7]).1);
    }
}
