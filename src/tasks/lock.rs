//! A lock word, such as one a vertex: 0 when free, else the number of the thread that holds it.
//!
//! No thread waits for a word, so there is no deadlock. The words alone order the threads: all other atomics that they guard may be relaxed.
//! tests/lock_protocol.rs runs this file on loom's atomics, through all orders of two threads and all values that their loads may have.
use super::sync::atomic::{
    AtomicU32,
    Ordering::{Acquire, Relaxed, Release},
};

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Claim {
    /// It was free and is the owner's now, to be given back.
    Taken,
    /// It was the owner's already.
    Held,
    /// Another thread has it.
    Refused,
}

/// Claims a word for `owner`, which is not 0.
#[inline]
pub fn claim(word: &AtomicU32, owner: u32) -> Claim {
    // Acquire pairs with the Release below: what all owners before wrote while they held the word is seen.
    match word.compare_exchange(0, owner, Acquire, Relaxed) {
        Ok(_) => Claim::Taken,
        Err(holder) if holder == owner => Claim::Held,
        Err(_) => Claim::Refused,
    }
}

/// Gives back a word that was taken.
#[inline]
pub fn release(word: &AtomicU32) {
    word.store(0, Release);
}
