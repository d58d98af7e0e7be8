//! Numbers that several threads write into one list.
use std::mem::ManuallyDrop;
use std::sync::atomic::AtomicU32;

/// Zeros, which cost nothing until they are used.
pub fn zeros(count: usize) -> Vec<AtomicU32> {
    bytemuck::allocation::zeroed_vec(count)
}

/// The list when all is written. Nothing is copied.
pub fn plain(words: Vec<AtomicU32>) -> Vec<u32> {
    let mut words = ManuallyDrop::new(words);
    // SAFETY: an `AtomicU32` has the size, the alignment and the bits of a `u32`, and the list is no longer anybody else's.
    unsafe { Vec::from_raw_parts(words.as_mut_ptr().cast(), words.len(), words.capacity()) }
}
