//! Who runs what, when: an operation is applied to a list of items by one thread or by several.
pub mod deterministic;
mod grains;
mod parts;
mod sequential;
mod speculative;

use super::access::Access;
use super::context::Context;
use super::criteria::Criterion;
use super::ids::{TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::{Counts, Refusal};
use super::store::Store;
use super::work::Kind;
use super::worker::{State, Worker};
use crate::tasks::{Plan, Pool};
use clap::ValueEnum;
use serde::Serialize;

pub use grains::Grains;

/// Who does what, when.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheduler {
    /// All threads, each in parts of the mesh that do not depend on them: the same mesh bit for bit for any number of threads.
    #[default]
    Deterministic,
    /// All threads, each where no other is at the moment: another mesh, as good, each time.
    Speculative,
    /// One thread, one item after the other.
    Sequential,
}

/// The threads and how they share the work.
#[derive(Clone, Copy)]
pub struct Crew<'c> {
    /// The threads.
    pub pool: &'c Pool,
    /// Who does what.
    pub scheduler: Scheduler,
    /// Who runs the tasks, and how they are made.
    pub plan: Plan,
    /// Items a task, by kind of operation.
    pub grains: Grains,
}

/// Something an operation is done to.
pub trait Item: Copy + Send + Sync {
    /// The vertices it is known by, some repeatedly; of one that is gone they may be anything. Between sweeps only.
    fn vertices(self, store: &Store) -> [VertexId; 4];
}

impl Item for VertexId {
    fn vertices(self, _store: &Store) -> [VertexId; 4] {
        [self; 4]
    }
}

impl Item for EdgeItem {
    fn vertices(self, _store: &Store) -> [VertexId; 4] {
        [self.a, self.b, self.a, self.b]
    }
}

impl Item for TetId {
    fn vertices(self, store: &Store) -> [VertexId; 4] {
        store.peek(self)
    }
}

/// Something to be done to each item of a list, written once for any way of claiming.
pub trait Operation: Sync {
    /// What it is done to.
    type Item: Item;

    /// Whether it needs all tetrahedra at the vertices of its item.
    const WHOLE_BALLS: bool;

    /// Tries it on one item.
    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: Self::Item) -> Result<(), Refusal>;
}

/// Called now and then with the number of items that were done since.
pub type Advance<'a> = &'a (dyn Fn(usize) + Sync);

/// Applies the operation to all items; there is a state for each thread.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    states: &mut [State<'m>],
    (crew, kind): (Crew<'_>, Kind),
    advance: Advance<'_>,
) -> Counts {
    let tasks = (crew.pool, Plan { grain: crew.grains.of(kind), ..crew.plan });
    match crew.scheduler {
        Scheduler::Sequential => sequential::run(operation, items, context, &mut states[0], advance),
        Scheduler::Speculative => speculative::run(operation, items, context, states, tasks, advance),
        Scheduler::Deterministic => deterministic::run(operation, items, context, states, tasks, advance),
    }
}

/// Splits edges that are too long.
pub struct Split;

impl Operation for Split {
    type Item = EdgeItem;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: EdgeItem) -> Result<(), Refusal> {
        worker.split_edge(item)
    }
}

/// Splits surface triangles that stray from the model.
pub struct Unbend;

impl Operation for Unbend {
    type Item = TetId;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.unbend(item)
    }
}

/// Refines tetrahedra at their centroids.
pub struct Create;

impl Operation for Create {
    type Item = TetId;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.refine_tet(item)
    }
}

/// Creates points at unit distance from vertices, along the eigenvectors of their metrics.
pub struct Extend;

impl Operation for Extend {
    type Item = VertexId;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.extend_vertex(item)
    }
}

/// Collapses edges that are too short.
pub struct Collapse;

impl Operation for Collapse {
    type Item = EdgeItem;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: EdgeItem) -> Result<(), Refusal> {
        worker.collapse_edge(item)
    }
}

/// Removes vertices with short edges.
pub struct Thin;

impl Operation for Thin {
    type Item = VertexId;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.thin(item)
    }
}

/// Reconnects bad tetrahedra.
pub struct Reconnect(pub Criterion);

impl Operation for Reconnect {
    type Item = TetId;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.reconnect(item, self.0)
    }
}

/// Smooths vertices.
pub struct Smooth;

impl Operation for Smooth {
    type Item = VertexId;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        worker.smooth(item)
    }
}

/// Mends the worst tetrahedra.
pub struct Mend;

impl Operation for Mend {
    type Item = TetId;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: TetId) -> Result<(), Refusal> {
        worker.mend(item)
    }
}

/// Removes waiting boundary vertices that never arrived: what a sweep of [`Project`] just before has left over, so that no id can
/// stand for another vertex by now.
pub struct Retire;

impl Operation for Retire {
    type Item = VertexId;
    const WHOLE_BALLS: bool = true;

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
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, item: VertexId) -> Result<(), Refusal> {
        let result = worker.project(item);
        if result == Err(Refusal::Inverted) {
            worker.state.waiting.push(item);
        }
        result
    }
}
