//! Loops for those who say only how large a task is: the threads of a pool with the plan of the run, or none but the caller.
//!
//! Chunks depend on the items alone, and what they give is joined in their order: so results do not depend on the threads, not in
//! the last bit.
use super::plan::Plan;
use super::pool::Pool;
use super::strategy::chunk;
use std::mem::MaybeUninit;
use std::ops::Range;

/// Items a task where one takes some tens of nanoseconds.
pub const GRAIN: usize = 1 << 12;

/// Threads, and who runs the tasks on them. See the rules of the module.
#[derive(Clone, Copy)]
pub struct Team<'p> {
    /// None where one thread is enough.
    pool: Option<&'p Pool>,
    plan: Plan,
}

impl<'p> Team<'p> {
    /// The threads of a pool, with the back-end and the strategy of a plan.
    pub fn new(pool: &'p Pool, plan: Plan) -> Self {
        Self { pool: (pool.threads() > 1).then_some(pool), plan }
    }

    /// The caller alone.
    pub fn alone() -> Self {
        Self { pool: None, plan: Plan::default() }
    }

    /// Number of threads.
    pub fn threads(self) -> usize {
        self.pool.map_or(1, Pool::threads)
    }

    /// Calls `f` with each chunk of so many items, the last one shorter.
    pub fn for_each(self, grain: usize, items: usize, f: impl Fn(Range<usize>) + Sync) {
        // Through a reference to any function, here and below, `f` is compiled once for one thread and for several.
        let f: &(dyn Fn(Range<usize>) + Sync) = &f;
        let grain = grain.max(1);
        match self.pool {
            Some(pool) => pool.task_for(Plan { grain, ..self.plan }, items, |_, range| f(range)),
            None => (0..items.div_ceil(grain)).for_each(|index| f(chunk(index, grain, items))),
        }
    }

    /// Calls `f(start, chunk)` with each chunk of the slice, which begins at `start`.
    pub fn fill<T: Send>(self, grain: usize, slice: &mut [T], f: impl Fn(usize, &mut [T]) + Sync) {
        self.each_chunk_mut(grain, slice, &f);
    }

    fn each_chunk_mut<T: Send>(self, grain: usize, slice: &mut [T], f: &(dyn Fn(usize, &mut [T]) + Sync)) {
        let grain = grain.max(1);
        match self.pool {
            Some(pool) => {
                pool.for_each_chunk_mut(Plan { grain, ..self.plan }, slice, |_, start, chunk| f(start, chunk));
            }
            None => slice.chunks_mut(grain).enumerate().for_each(|(index, chunk)| f(index * grain, chunk)),
        }
    }

    /// `f` of each chunk, in the order of the chunks.
    pub fn chunks<T: Send>(self, grain: usize, items: usize, f: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
        self.mapped(grain, items, &f)
    }

    fn mapped<T: Send>(self, grain: usize, items: usize, f: &(dyn Fn(Range<usize>) -> T + Sync)) -> Vec<T> {
        let grain = grain.max(1);
        match self.pool {
            Some(pool) => pool.map_chunks(Plan { grain, ..self.plan }, items, |_, range| f(range)),
            None => (0..items.div_ceil(grain)).map(|index| f(chunk(index, grain, items))).collect(),
        }
    }

    /// The first item that is asked for.
    pub fn first(self, grain: usize, items: usize, is_asked: impl Fn(usize) -> bool + Sync) -> Option<usize> {
        let found = self.chunks(grain, items, |mut range| range.find(|&item| is_asked(item)));
        found.into_iter().flatten().next()
    }

    /// Sum of `f` over the chunks, in their order.
    pub fn sum(self, grain: usize, items: usize, f: impl Fn(Range<usize>) -> f64 + Sync) -> f64 {
        self.chunks(grain, items, f).into_iter().sum()
    }

    /// `f` of each item.
    pub fn map<T: Copy + Send>(self, grain: usize, items: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let mut all = Vec::with_capacity(items);
        self.fill(grain, &mut all.spare_capacity_mut()[..items], |start, chunk| {
            for (slot, item) in chunk.iter_mut().zip(start..) {
                slot.write(f(item));
            }
        });
        // SAFETY: `fill` has gone through all chunks, and each slot was written.
        unsafe { all.set_len(items) };
        all
    }

    /// As [`Team::map`], into a list that is there: no room has to be made where it is as long.
    pub fn remap<T: Copy + Send>(self, grain: usize, list: &mut Vec<T>, items: usize, f: impl Fn(usize) -> T + Sync) {
        if list.len() != items {
            *list = self.map(grain, items, f);
            return;
        }
        self.fill(grain, list, |start, chunk| {
            chunk.iter_mut().zip(start..).for_each(|(slot, item)| *slot = f(item));
        });
    }

    /// `f` of each item, with what `state` makes for each task to work with.
    pub fn map_with<S, T: Send>(
        self,
        grain: usize,
        items: usize,
        state: impl Fn() -> S + Sync,
        f: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let mut all = Vec::with_capacity(items);
        self.fill(grain, &mut all.spare_capacity_mut()[..items], |start, chunk| {
            let mut state = state();
            for (slot, item) in chunk.iter_mut().zip(start..) {
                slot.write(f(&mut state, item));
            }
        });
        // SAFETY: as in `map`.
        unsafe { all.set_len(items) };
        all
    }

    /// What `f(range, found)` pushes to the empty list that it is given, joined in the order of the chunks.
    pub fn collect<T, F>(self, grain: usize, items: usize, f: F) -> Vec<T>
    where
        T: Copy + Send + Sync,
        F: Fn(Range<usize>, &mut Vec<T>) + Sync,
    {
        self.join(self.chunks(grain, items, |range| {
            let mut found = Vec::new();
            f(range, &mut found);
            found
        }))
    }

    /// The parts, one after the other.
    pub fn join<T: Copy + Send + Sync>(self, mut parts: Vec<Vec<T>>) -> Vec<T> {
        if parts.len() == 1 {
            return parts.swap_remove(0);
        }
        self.join_slices(parts.iter().map(Vec::as_slice))
    }

    /// The slices, one after the other.
    pub fn join_slices<'t, T: Copy + Send + Sync + 't>(self, parts: impl Iterator<Item = &'t [T]> + Clone) -> Vec<T> {
        let total = parts.clone().map(<[T]>::len).sum();
        let mut all = Vec::with_capacity(total);
        let mut room: &mut [MaybeUninit<T>] = &mut all.spare_capacity_mut()[..total];
        let mut pairs = Vec::new();
        for part in parts {
            let (here, rest) = room.split_at_mut(part.len());
            pairs.push((here, part));
            room = rest;
        }
        self.fill(1, &mut pairs, |_, pairs| {
            for (to, from) in pairs {
                for (to, from) in to.iter_mut().zip(*from) {
                    to.write(*from);
                }
            }
        });
        // SAFETY: the parts are so long together, and `fill` has copied each.
        unsafe { all.set_len(total) };
        all
    }
}
