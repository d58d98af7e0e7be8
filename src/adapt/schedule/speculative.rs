//! Several threads take tasks of some items each. An item that ends in a conflict is tried again at the end of its task, when the other
//! thread has most likely moved on, and then in the next round (Tsolakis 2021, 3.4). One thread does the last round, so no item is lost.
//!
//! One thread alone has no conflicts and claims nothing: that is the sequential scheduler.
use super::{Advance, Operation, ThreadContext, fetch_ahead, sequential};
use crate::adapt::core::access::{Access, Speculative};
use crate::adapt::core::context::Context;
use crate::adapt::core::refusal::{Counts, Refusal};
use crate::adapt::core::worker::Worker;
use crate::tasks::{Plan, Pool};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// Least tasks a thread, so that short lists are shared too.
const SHARES: usize = 8;

/// Rounds on all threads; then one thread does what is left.
const ROUNDS: usize = 6;

/// What a thread has in a round, and its results.
struct RoundOf<'s, 't, 'm, O: Operation> {
    thread: &'s mut ThreadContext<'t, 'm, O>,
    counts: Counts,
    again: Vec<O::Item>,
}

/// Applies the operation to all items on all threads of the pool, one state each; a task has `plan.grain` items at most.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    threads: &mut [ThreadContext<'_, 'm, O>],
    (pool, plan): (&Pool, Plan),
    advance: Advance<'_>,
) -> Counts {
    if pool.threads() == 1 {
        return sequential::run(operation, items, context, &mut threads[0], advance);
    }
    let mut counts = Counts::default();
    let mut left: Option<Vec<O::Item>> = None;
    for _ in 0..ROUNDS {
        let work = left.as_deref().unwrap_or(items);
        if work.is_empty() {
            return counts;
        }
        let grain = plan.grain.min(work.len() / (SHARES * pool.threads())).max(1);
        let begin = |thread| RoundOf { thread, counts: Counts::default(), again: Vec::new() };
        let mut rounds: Vec<_> = threads.iter_mut().map(begin).collect();
        // Each task takes the next items of the list, in whatever order tasks are run, since lists have their most urgent items first.
        let (next, is_stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
        pool.task_for_with(
            Plan { grain: 1, ..plan },
            work.len().div_ceil(grain),
            &mut rounds,
            |round, thread, range| {
                for _ in range {
                    if is_stopped.load(Relaxed) {
                        return;
                    }
                    let start = next.fetch_add(grain, Relaxed);
                    let bucket = &work[start..work.len().min(start + grain)];
                    round.work(operation, context, thread, bucket);
                    if !advance(bucket.len()) {
                        is_stopped.store(true, Relaxed);
                    }
                }
            },
        );
        let mut again = Vec::new();
        for round in rounds {
            counts.add(&round.counts);
            again.extend(round.again);
        }
        if is_stopped.into_inner() {
            return counts;
        }
        left = Some(again);
    }
    let rest = left.unwrap_or_default();
    counts.add(&sequential::run(operation, &rest, context, &mut threads[0], advance));
    counts
}

impl<'m, O: Operation> RoundOf<'_, '_, 'm, O> {
    /// Does the items of one task.
    fn work(&mut self, operation: &O, context: &Context<'m>, thread: usize, items: &[O::Item]) {
        let mut worker = Worker::new(context, &mut *self.thread.state, Speculative::new(thread));
        let first = self.again.len();
        let mut attempt = |item| {
            let result = operation.attempt(&mut worker, &mut self.thread.scratch, item);
            worker.access.release(worker.store);
            self.counts.record(result);
            result == Err(Refusal::Conflict)
        };
        for (at, &item) in items.iter().enumerate() {
            fetch_ahead(&context.store, |n| items.get(at + n).copied());
            if attempt(item) {
                self.again.push(item);
            }
        }
        let mut kept = first;
        for index in first..self.again.len() {
            let item = self.again[index];
            if attempt(item) {
                self.again[kept] = item;
                kept += 1;
            }
        }
        self.again.truncate(kept);
    }
}
