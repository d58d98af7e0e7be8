//! A small map that an operation needs while it looks at its cavity: cleared by a new stamp, allocated once, as [`crate::mesh::stamped_set`] is.

#[inline(always)]
fn hash(key: u64) -> usize {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize
}

/// A map from triangles (three vertex ids in any order) to a value.
pub struct FaceMap<T> {
    slots: Vec<(u32, [u32; 3], T)>,
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
        Self { slots: vec![(0, [0; 3], T::default()); 512], stamp: 1, len: 0 }
    }
}

impl<T: Copy + Default> FaceMap<T> {
    /// Empties the map.
    #[inline]
    pub fn clear(&mut self) {
        self.len = 0;
        self.stamp = self.stamp.wrapping_add(1);
        if self.stamp == 0 {
            self.slots.fill((0, [0; 3], T::default()));
            self.stamp = 1;
        }
    }

    /// The value of a triangle, entered with its default when new; and whether it is new.
    #[inline]
    pub fn entry(&mut self, face: [u32; 3]) -> (&mut T, bool) {
        if self.len * 2 >= self.slots.len() {
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
        let mask = self.slots.len() - 1;
        let mixed =
            (u64::from(key[0]) << 32 | u64::from(key[1])) ^ (u64::from(key[2]).wrapping_mul(0xD6E8_FEB8_6659_FD93));
        let mut at = hash(mixed) & mask;
        loop {
            let slot = &self.slots[at];
            if slot.0 != self.stamp {
                return (at, false);
            }
            if slot.1 == key {
                return (at, true);
            }
            at = (at + 1) & mask;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let larger = vec![(0, [0; 3], T::default()); self.slots.len() * 2];
        let old = std::mem::replace(&mut self.slots, larger);
        self.len = 0;
        for (stamp, key, value) in old {
            if stamp == self.stamp {
                *self.entry(key).0 = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_face_is_found_in_any_order_of_its_vertices() {
        let mut map = FaceMap::<u32>::default();
        for i in 0..2000 {
            let (value, new) = map.entry([i + 7, i, i + 3]);
            assert!(new);
            *value = i;
        }
        for i in 0..2000 {
            assert_eq!(*map.entry([i, i + 3, i + 7]).0, i);
            assert!(!map.entry([i + 3, i + 7, i]).1);
        }
        assert!(map.entry([1, 2, 3]).1);
        map.clear();
        assert!(map.entry([0, 3, 7]).1);
    }
}
