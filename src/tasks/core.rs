//! What all back-ends of a pool share.
use super::parking::Parking;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Identity, size and sleeping places of a pool.
pub struct Core {
    pub id: u64,
    pub threads: usize,
    /// Whether the threads are not there: everything runs in place.
    pub is_simulated: bool,
    /// Where a thread, by its id, waits for what is nested in its task; then that of who opened the outermost loop or scope; then those
    /// where our own threads wait for work. They have slots apart, because the threads of several back-ends live beside each other.
    pub parking: Parking,
}

impl Core {
    pub fn new(threads: usize, is_simulated: bool) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self { id: NEXT.fetch_add(1, Relaxed), threads, is_simulated, parking: Parking::new(2 * threads) }
    }

    /// The slot of who opened the outermost loop or scope.
    pub fn opener(&self) -> usize {
        self.threads
    }

    /// The slot where one of our own threads waits for work. The first is who opened the outermost loop or scope.
    pub fn idler(&self, thread: usize) -> usize {
        self.threads + thread
    }
}
