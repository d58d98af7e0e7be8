//! One thread, the items in their order: the reference for all other schedulers.
use super::{Advance, Operation};
use crate::adapt::access::{Access, Exclusive};
use crate::adapt::context::Context;
use crate::adapt::outcome::Counts;
use crate::adapt::worker::{State, Worker};

/// Items between two reports of progress.
const STRIDE: usize = 1024;

/// Applies the operation to the items in turn.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    state: &mut State<'m>,
    advance: Advance<'_>,
) -> Counts {
    let mut counts = Counts::default();
    let mut worker = Worker::new(context, state, Exclusive);
    for some in items.chunks(STRIDE) {
        for &item in some {
            counts.record(operation.attempt(&mut worker, item));
            worker.access.release(worker.store);
        }
        advance(some.len());
    }
    counts
}
