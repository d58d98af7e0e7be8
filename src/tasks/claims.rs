//! The lock words that one thread holds for the work in hand.
use super::lock::{self, Claim};
use std::sync::atomic::AtomicU32;

/// Words that are claimed one by one, never waited for, and given back together. The words themselves lie with what they guard.
pub struct Claims {
    /// Not 0; another one for each thread.
    owner: u32,
    held: Vec<u32>,
}

impl Claims {
    /// Those of thread `thread`, counted from 0.
    pub fn new(thread: usize) -> Self {
        Self { owner: thread as u32 + 1, held: Vec::with_capacity(256) }
    }

    /// What the words say that this thread holds.
    pub fn owner(&self) -> u32 {
        self.owner
    }

    /// Claims the word of number `index`; claiming twice is harmless.
    #[inline]
    pub fn claim(&mut self, index: u32, word: &AtomicU32) -> Claim {
        let claim = lock::claim(word, self.owner);
        if claim == Claim::Taken {
            self.held.push(index);
        }
        claim
    }

    /// Gives all back; `word` finds the word of a number.
    #[inline]
    pub fn release<'w>(&mut self, word: impl Fn(u32) -> &'w AtomicU32) {
        for index in self.held.drain(..) {
            lock::release(word(index));
        }
    }

    /// Whether none is held.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty()
    }
}
