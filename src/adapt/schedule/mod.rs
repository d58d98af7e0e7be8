//! The schedulers: an operation is applied to a list of items by one thread or by several.
pub mod deterministic;
mod grains;
mod sequential;
mod speculative;
pub mod work;

use crate::adapt::core::access::Access;
use crate::adapt::core::context::Context;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::{Counts, Refusal};
use crate::adapt::core::store::Store;
use crate::adapt::core::worker::{State, Worker};
use crate::adapt::schedule::work::Kind;
use crate::tasks::{Plan, Pool};
use serde::Serialize;

pub use grains::Grains;

/// How the threads share the items of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheduler {
    /// All threads, in parts of the mesh that do not depend on the threads: the same mesh bit for bit for any number of them.
    #[default]
    Deterministic,
    /// All threads, each where no other is at the moment: another mesh each time, as good.
    Speculative,
    /// One thread, one item after the other.
    Sequential,
}

impl Scheduler {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Deterministic, Self::Speculative, Self::Sequential];

    /// As the command line spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Deterministic => "deterministic",
            Self::Speculative => "speculative",
            Self::Sequential => "sequential",
        }
    }
}

/// The threads and how they share the work.
#[derive(Clone, Copy)]
pub struct Execution<'c> {
    /// The threads.
    pub pool: &'c Pool,
    /// How they share the items.
    pub scheduler: Scheduler,
    /// Who runs the tasks, and how they are made.
    pub plan: Plan,
    /// Items a task, by kind of operation.
    pub grains: Grains,
}

/// Something an operation is done to.
pub trait Item: Copy + Send + Sync {
    /// The vertices that it is known by; some may be repeated. For an item that is gone they may be any. Between sweeps only.
    fn vertices(self, store: &Store) -> [VertexId; 4];

    /// Asks the memory for what [`Item::vertices`] reads.
    fn fetch_known_by(self, store: &Store);

    /// Asks the memory for what its operation will read, one step after the other: each needs what the one before has asked for.
    fn fetch(self, store: &Store, step: usize);
}

/// How many places ahead an item is when each step of its [`Item::fetch`] is taken.
const FETCHED_AHEAD: [usize; 3] = [8, 4, 2];

/// Takes a step of [`Item::fetch`] for some of the items that come next; `ahead(n)` is the n-th after the present one.
#[inline(always)]
fn fetch_ahead<I: Item>(store: &Store, ahead: impl Fn(usize) -> Option<I>) {
    for (step, distance) in FETCHED_AHEAD.into_iter().enumerate() {
        if let Some(item) = ahead(distance) {
            item.fetch(store, step);
        }
    }
}

impl Item for VertexId {
    fn vertices(self, _store: &Store) -> [VertexId; 4] {
        [self; 4]
    }

    #[inline(always)]
    fn fetch_known_by(self, _store: &Store) {}

    #[inline(always)]
    fn fetch(self, store: &Store, step: usize) {
        match step {
            0 => store.fetch_vertex(self),
            1 => store.fetch_tet(store.unlocked_tet_of(self)),
            _ => store.fetch_about(store.unlocked_tet_of(self)),
        }
    }
}

impl Item for EdgeItem {
    fn vertices(self, _store: &Store) -> [VertexId; 4] {
        [self.a, self.b, self.a, self.b]
    }

    #[inline(always)]
    fn fetch_known_by(self, _store: &Store) {}

    #[inline(always)]
    fn fetch(self, store: &Store, step: usize) {
        match step {
            0 => {
                store.fetch_vertex(self.a);
                store.fetch_vertex(self.b);
                store.fetch_tet(self.tet);
            }
            1 => store.fetch_about(self.tet),
            _ => {}
        }
    }
}

impl Item for TetId {
    fn vertices(self, store: &Store) -> [VertexId; 4] {
        store.unlocked_vertices(self)
    }

    #[inline(always)]
    fn fetch_known_by(self, store: &Store) {
        store.fetch_tet(self);
    }

    #[inline(always)]
    fn fetch(self, store: &Store, step: usize) {
        match step {
            0 => store.fetch_tet(self),
            1 => store.fetch_about(self),
            _ => store.fetch_beyond(self),
        }
    }
}

/// An operation on each item of a list, written once for all ways of claiming.
pub trait Operation: Sync {
    /// What it is done to.
    type Item: Item;

    /// The scratch of a thread for it, kept for a sweep.
    type Scratch: Default + Send;

    /// Whether it needs all tetrahedra at the vertices of its item.
    const WHOLE_BALLS: bool;

    /// About how many flips are tried in the time that one try of it takes.
    const EFFORT: usize = 1;

    /// Tries it on one item.
    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut Self::Scratch,
        item: Self::Item,
    ) -> Result<(), Refusal>;
}

/// Called now and then with the number of items that were done since. Where it says no the rest of the items is left undone: each operation
/// leaves a valid mesh.
pub type Advance<'a> = &'a (dyn Fn(usize) -> bool + Sync);

/// Items between two reports of progress.
const STRIDE: usize = 1024;

/// A thread in a sweep: what it keeps from sweep to sweep, and the scratch of the operation.
pub struct ThreadContext<'s, 'm, O: Operation> {
    state: &'s mut State<'m>,
    scratch: O::Scratch,
}

/// Applies the operation to all items. There is one state a thread.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    states: &mut [State<'m>],
    (execution, kind): (Execution<'_>, Kind),
    advance: Advance<'_>,
) -> Counts {
    let new = |state| ThreadContext { state, scratch: O::Scratch::default() };
    let mut threads: Vec<ThreadContext<'_, 'm, O>> = states.iter_mut().map(new).collect();
    let tasks = (execution.pool, Plan { grain: execution.grains.of(kind), ..execution.plan });
    match execution.scheduler {
        Scheduler::Sequential => sequential::run(operation, items, context, &mut threads[0], advance),
        Scheduler::Speculative => speculative::run(operation, items, context, &mut threads, tasks, advance),
        Scheduler::Deterministic => deterministic::run(operation, items, context, &mut threads, tasks, advance),
    }
}
