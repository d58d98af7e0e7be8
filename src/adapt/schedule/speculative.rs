//! Several threads, each taking the next bucket of items; what ends in a conflict is tried again in the next round
//! (Tsolakis 2021, 3.4). The last round is one thread's, so no item is lost.
use super::{Advance, Operation};
use crate::adapt::access::{Access, Speculative};
use crate::adapt::context::Context;
use crate::adapt::outcome::{Counts, Refusal};
use crate::adapt::worker::{State, Worker};
use crate::tasks::Pool;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Items in a bucket, at most.
const BUCKET: usize = 150;

/// Buckets a thread, at least: short lists are shared out too.
const SHARES: usize = 8;

/// Rounds that all threads share; then one thread takes what is left.
const ROUNDS: usize = 6;

/// Applies the operation to the items on all threads of the pool, one state each.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    states: &mut [State<'m>],
    pool: &Pool,
    advance: Advance<'_>,
) -> Counts {
    let mut counts = Counts::default();
    let mut left: Option<Vec<O::Item>> = None;
    for round in 0..=ROUNDS {
        let work = left.as_deref().unwrap_or(items);
        if work.is_empty() {
            break;
        }
        let threads = if round == ROUNDS { 1 } else { states.len() };
        let (next, size) = (AtomicUsize::new(0), (work.len() / (SHARES * threads)).clamp(1, BUCKET));
        let slots: Vec<_> = states[..threads].iter_mut().map(|state| Mutex::new((state, Outcome::default()))).collect();
        let turn = |thread: usize| {
            if let Some(slot) = slots.get(thread) {
                let (state, outcome) = &mut *slot.lock().expect("each slot belongs to one thread");
                take_buckets(operation, work, (&next, size), context, state, thread, outcome, advance);
            }
        };
        pool.on_each_thread(&turn);
        let mut again = Vec::new();
        for slot in slots {
            let (_, outcome) = slot.into_inner().expect("each slot belongs to one thread");
            counts.add(&outcome.counts);
            again.extend(outcome.again);
        }
        left = Some(again);
    }
    counts
}

struct Outcome<I> {
    counts: Counts,
    again: Vec<I>,
}

impl<I> Default for Outcome<I> {
    fn default() -> Self {
        Self { counts: Counts::default(), again: Vec::new() }
    }
}

#[allow(clippy::too_many_arguments)]
fn take_buckets<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    (next, size): (&AtomicUsize, usize),
    context: &Context<'m>,
    state: &mut State<'m>,
    thread: usize,
    outcome: &mut Outcome<O::Item>,
    advance: Advance<'_>,
) {
    let mut worker = Worker::new(context, state, Speculative::new(thread));
    loop {
        let start = next.fetch_add(size, Relaxed);
        let Some(bucket) = items.get(start..items.len().min(start + size)).filter(|bucket| !bucket.is_empty()) else {
            return;
        };
        for &item in bucket {
            let result = operation.attempt(&mut worker, item);
            worker.access.release(worker.store);
            outcome.counts.record(result);
            if result == Err(Refusal::Conflict) {
                outcome.again.push(item);
            }
        }
        advance(bucket.len());
    }
}
