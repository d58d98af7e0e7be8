//! Loops whose results come in the order of the items, whatever the threads.
use super::plan::Plan;
use super::pool::Pool;
use super::strategy::chunk;
use std::ops::Range;
use std::sync::{Mutex, PoisonError, TryLockError};

impl Pool {
    /// As [`Pool::task_for`], with one state a thread, which `f` gets while it runs.
    ///
    /// # Panics
    /// As [`Pool::task_for`]; when there are fewer states than threads; and when `f` waits for tasks that come back to these states.
    pub fn task_for_with<S, F>(&self, plan: Plan, items: usize, states: &mut [S], f: F)
    where
        S: Send,
        F: Fn(&mut S, usize, Range<usize>) + Sync,
    {
        assert!(states.len() >= self.threads(), "{} states for {} threads", states.len(), self.threads());
        let slots: Vec<_> = states.iter_mut().map(Mutex::new).collect();
        self.task_for(plan, items, |thread, range| match slots[thread].try_lock() {
            Ok(mut state) => f(&mut state, thread, range),
            Err(TryLockError::Poisoned(state)) => f(&mut state.into_inner(), thread, range),
            Err(TryLockError::WouldBlock) => panic!("a task waits for others while it has its thread's state"),
        });
    }

    /// `f(thread, range)` of each chunk, in the order of the chunks.
    ///
    /// # Panics
    /// As [`Pool::task_for`].
    pub fn map_chunks<T, F>(&self, plan: Plan, items: usize, f: F) -> Vec<T>
    where
        T: Send,
        F: Fn(usize, Range<usize>) -> T + Sync,
    {
        self.mapped(plan, items, &f)
    }

    fn mapped<T: Send>(&self, plan: Plan, items: usize, f: &(dyn Fn(usize, Range<usize>) -> T + Sync)) -> Vec<T> {
        let grain = plan.grain.max(1);
        let mut results: Vec<Option<T>> = Vec::new();
        results.resize_with(items.div_ceil(grain), || None);
        self.for_each_chunk_mut(Plan { grain: 1, ..plan }, &mut results, |thread, index, result| {
            result[0] = Some(f(thread, chunk(index, grain, items)));
        });
        results.into_iter().map(|result| result.expect("each chunk was done")).collect()
    }

    /// What `f(thread, range, found)` pushes, joined in the order of the chunks.
    ///
    /// # Panics
    /// As [`Pool::task_for`].
    pub fn collect<T, F>(&self, plan: Plan, items: usize, f: F) -> Vec<T>
    where
        T: Send,
        F: Fn(usize, Range<usize>, &mut Vec<T>) + Sync,
    {
        let mut parts = self.map_chunks(plan, items, |thread, range| {
            let mut found = Vec::new();
            f(thread, range, &mut found);
            found
        });
        let mut all = if parts.is_empty() { Vec::new() } else { std::mem::take(&mut parts[0]) };
        all.reserve(parts.iter().map(Vec::len).sum());
        parts.iter_mut().for_each(|part| all.append(part));
        all
    }

    /// `f(thread, start, chunk)` for each chunk of the slice, which begins at `start`.
    ///
    /// # Panics
    /// As [`Pool::task_for`].
    pub fn for_each_chunk_mut<T, F>(&self, plan: Plan, slice: &mut [T], f: F)
    where
        T: Send,
        F: Fn(usize, usize, &mut [T]) + Sync,
    {
        self.each_chunk_mut(plan, slice, &f);
    }

    fn each_chunk_mut<T: Send>(&self, plan: Plan, slice: &mut [T], f: &(dyn Fn(usize, usize, &mut [T]) + Sync)) {
        let (grain, items) = (plan.grain.max(1), slice.len());
        let chunks: Vec<_> = slice.chunks_mut(grain).map(Mutex::new).collect();
        self.task_for(plan, items, |thread, range| {
            // One task has this chunk, so the lock is free.
            let mut chunk = chunks[range.start / grain].lock().unwrap_or_else(PoisonError::into_inner);
            f(thread, range.start, &mut chunk);
        });
    }
}
