//! What several threads do with pieces.
use super::Error;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// A list that several threads add to.
pub type Shared<T> = Mutex<Vec<T>>;

/// Adds to it.
pub fn add<T>(list: &Shared<T>, item: T) {
    list.lock().unwrap_or_else(PoisonError::into_inner).push(item);
}

/// The list, sorted.
pub fn sorted<T, K: Ord>(list: Shared<T>, key: impl Fn(&T) -> K) -> Vec<T> {
    let mut list = list.into_inner().unwrap_or_else(PoisonError::into_inner);
    list.sort_by_key(key);
    list
}

/// Calls f with 0, 1, … on so many threads. Ends at the first error.
pub fn on_threads(threads: usize, items: usize, f: impl Fn(usize) -> Result<(), Error> + Sync) -> Result<(), Error> {
    let next = AtomicUsize::new(0);
    let failed = Mutex::new(None);
    let work = || {
        while let Some(at) = Some(next.fetch_add(1, Relaxed)).filter(|&at| at < items) {
            if let Err(error) = f(at) {
                next.store(items, Relaxed);
                failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            }
        }
    };
    if threads <= 1 || items <= 1 {
        work();
    } else {
        std::thread::scope(|scope| (0..threads.min(items)).for_each(|_| drop(scope.spawn(work))));
    }
    failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}
