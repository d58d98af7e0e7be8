//! Who runs what, when: an operation is applied to a list of items by one thread or by several.
mod sequential;
mod speculative;

use super::access::Access;
use super::context::Context;
use super::criteria::Criterion;
use super::ids::{TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::{Counts, Refusal};
use super::worker::{State, Worker};
use crate::tasks::Pool;

/// Something to be done to each item of a list, written once for any way of claiming.
pub trait Operation: Sync {
    /// What it is done to.
    type Item: Copy + Send + Sync;

    /// Tries it on one item.
    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: Self::Item) -> Result<(), Refusal>;
}

/// Called now and then with the number of items that were done since.
pub type Advance<'a> = &'a (dyn Fn(usize) + Sync);

/// Applies the operation to all items, in order on one thread, speculatively on more.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    states: &mut [State<'m>],
    pool: &Pool,
    advance: Advance<'_>,
) -> Counts {
    match states {
        [state] => sequential::run(operation, items, context, state, advance),
        states => speculative::run(operation, items, context, states, pool, advance),
    }
}

/// Splits edges that are too long.
pub struct Split;

impl Operation for Split {
    type Item = EdgeItem;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: EdgeItem) -> Result<(), Refusal> {
        worker.split_edge(item)
    }
}

/// Refines tetrahedra at their centroids.
pub struct Create;

impl Operation for Create {
    type Item = TetId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.refine_tet(item)
    }
}

/// Creates points at unit distance from vertices, along the eigenvectors of their metrics.
pub struct Extend;

impl Operation for Extend {
    type Item = VertexId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.extend_vertex(item)
    }
}

/// Collapses edges that are too short.
pub struct Collapse;

impl Operation for Collapse {
    type Item = EdgeItem;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: EdgeItem) -> Result<(), Refusal> {
        worker.collapse_edge(item)
    }
}

/// Removes vertices with short edges.
pub struct Thin;

impl Operation for Thin {
    type Item = VertexId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.thin(item)
    }
}

/// Reconnects bad tetrahedra.
pub struct Reconnect(pub Criterion);

impl Operation for Reconnect {
    type Item = TetId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.reconnect(item, self.0)
    }
}

/// Smooths vertices.
pub struct Smooth;

impl Operation for Smooth {
    type Item = VertexId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.smooth(item)
    }
}

/// Mends the worst tetrahedra.
pub struct Mend;

impl Operation for Mend {
    type Item = TetId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.mend(item)
    }
}

/// Removes waiting boundary vertices that never arrived: what a sweep of [`Project`] just before has left over, so that no id can
/// stand for another vertex by now.
pub struct Retire;

impl Operation for Retire {
    type Item = VertexId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        let result = worker.claim_live(item).and_then(|()| worker.remove(item, 0.0));
        if result.is_err_and(|refusal| !matches!(refusal, Refusal::Conflict | Refusal::Stale)) {
            worker.state.waiting.push(item);
        }
        result
    }
}

/// Moves waiting boundary vertices to the model.
pub struct Project;

impl Operation for Project {
    type Item = VertexId;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        let result = worker.project(item);
        if result == Err(Refusal::Inverted) {
            worker.state.waiting.push(item);
        }
        result
    }
}
