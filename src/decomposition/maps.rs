//! Maps by ids and node numbers. Nobody chooses these to do harm, so a cheap hash will do; the maps are asked, never walked through, so the order
//! in them does not matter.
use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// A map by numbers.
pub type Map<K, V> = HashMap<K, V, BuildHasherDefault<Mixer>>;

/// A set of numbers.
pub type Set<K> = HashSet<K, BuildHasherDefault<Mixer>>;

/// Mixes words by multiplication.
#[derive(Default)]
pub struct Mixer(u64);

impl Hasher for Mixer {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut whole = [0; 8];
            whole[..word.len()].copy_from_slice(word);
            self.write_u64(u64::from_ne_bytes(whole));
        }
    }

    #[inline]
    fn write_u64(&mut self, word: u64) {
        // Both halves of the product: the upper bits and the lower ones are used.
        let product = u128::from(self.0.rotate_left(29) ^ word) * 0x9E37_79B9_7F4A_7C15;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }

    #[inline]
    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    #[inline]
    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
