//! One thread does the items in their order: the reference for all other schedulers.
use super::{Advance, Operation, STRIDE, ThreadContext, fetch_ahead};
use crate::adapt::core::access::{Access, Exclusive};
use crate::adapt::core::context::Context;
use crate::adapt::core::refusal::Counts;
use crate::adapt::core::worker::Worker;

/// Applies the operation to the items in turn.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    ThreadContext { state, scratch }: &mut ThreadContext<'_, 'm, O>,
    advance: Advance<'_>,
) -> Counts {
    let mut counts = Counts::default();
    let mut worker = Worker::new(context, state, Exclusive);
    for start in (0..items.len()).step_by(STRIDE) {
        let some = &items[start..items.len().min(start + STRIDE)];
        for (at, &item) in (start..).zip(some) {
            fetch_ahead(worker.store, |n| items.get(at + n).copied());
            counts.record(operation.attempt(&mut worker, scratch, item));
            worker.access.release(worker.store);
        }
        if !advance(some.len()) {
            break;
        }
    }
    counts
}
