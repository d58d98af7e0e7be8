//! Cutting a loop into tasks. The unit is the chunk: `grain` items, the last one fewer.
//!
//! A task holds a range of chunks. It gives all but one away and runs that one, so it is counted exactly once, and what it gave
//! away cannot end the loop while it still needs it. The first chunks stay with who makes the tasks, the last are put first into the
//! queue: a thread goes upwards through its own, and thieves take the far end.
use super::group::Group;
use super::job::{Job, Lane, Work};
use super::place;
use super::plan::{Plan, Strategy};
use std::ops::Range;

/// What a loop calls for each chunk, with the thread. It is one virtual call a chunk. When loops were compiled anew for each closure, their
/// copies were a fifth of the program.
pub type OfChunk<'f> = &'f (dyn Fn(usize, Range<usize>) + Sync);

/// A loop over items in chunks.
pub struct Loop<'f> {
    f: OfChunk<'f>,
    items: usize,
    grain: usize,
    strategy: Strategy,
    /// Counts the chunks.
    pub group: Group,
}

/// Items of a chunk.
pub fn chunk(index: usize, grain: usize, items: usize) -> Range<usize> {
    let start = index * grain;
    start..items.min(start.saturating_add(grain))
}

impl<'f> Loop<'f> {
    /// A loop by the plan, waited for in this slot.
    pub fn new(plan: Plan, items: usize, f: OfChunk<'f>, waiter: usize) -> Self {
        let grain = plan.grain.max(1);
        Self { f, items, grain, strategy: plan.strategy, group: Group::new(items.div_ceil(grain), waiter) }
    }

    /// The task that makes all others.
    ///
    /// # Safety
    /// The loop stays until its group is done. To be called once.
    pub unsafe fn root(&self) -> Job {
        // SAFETY: the caller's promise.
        unsafe { Job::part(self, &self.group, self.strategy, 0..self.items.div_ceil(self.grain)) }
    }

    /// Puts the range into the queue as a task of its own.
    fn give(&self, strategy: Strategy, range: Range<usize>, lane: &Lane<'_>) {
        // SAFETY: the loop stays by the promise of `root`: a range given has at least one chunk, whose count is that of its own task.
        lane.queue.push(unsafe { Job::part(self, &self.group, strategy, range) });
    }
}

impl Work for Loop<'_> {
    fn run(&self, strategy: Strategy, range: Range<usize>, lane: &Lane<'_>) {
        let Range { start, mut end } = range;
        match strategy {
            Strategy::Flat => (start + 1..end).rev().for_each(|one| self.give(Strategy::Flat, one..one + 1, lane)),
            Strategy::TwoLevel => {
                let shares = (2 * lane.core.threads).min(end - start);
                let first = |share: usize| start + share * (end - start) / shares;
                (1..shares).rev().for_each(|share| self.give(Strategy::Flat, first(share)..first(share + 1), lane));
                return self.run(Strategy::Flat, start..first(1), lane);
            }
            Strategy::Hierarchical => {
                while end - start > 1 {
                    let middle = start + (end - start).div_ceil(2);
                    self.give(Strategy::Hierarchical, middle..end, lane);
                    end = middle;
                }
            }
        }
        let _in_task = place::mark(true);
        (self.f)(lane.thread, chunk(start, self.grain, self.items));
    }
}
