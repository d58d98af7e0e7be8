//! The same mesh bit for bit, whatever the number of threads.
//!
//! In each round the mesh is cut into parts that depend on nothing but the mesh and the items. One thread has a part until the round
//! ends. It does the part's items in their order, with ids of the part's own. An item that would touch another part waits for the next
//! round, which is cut elsewhere. A tetrahedron with vertices in two parts stands still, and so does everything that a part can see of
//! another. So it makes no difference which part is done first. No lock is taken: a claim reads a byte that does not change.
use super::{Advance, Item, Operation, STRIDE, ThreadContext, fetch_ahead, sequential};
use crate::adapt::core::access::Owned;
use crate::adapt::core::context::Context;
use crate::adapt::core::id_pool::IdPool;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::parts::{Parts, Sample};
use crate::adapt::core::refusal::{Counts, Refusal};
use crate::adapt::core::store::Store;
use crate::adapt::core::worker::Worker;
use crate::tasks::{Plan, Pool, Team};
use std::cmp::Reverse;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Most parts: enough for many threads, but no more, since what lies between parts waits.
/// Their numbers fit in a byte.
pub const MOST_PARTS: usize = 128;

/// Least flips a part in the first round, where that leaves more than [`FEW`] parts; of items that take longer fewer are enough
/// ([`Operation::EFFORT`]). In larger parts fewer items meet another part.
/// Few in the unit tests, whose meshes are small.
const ITEMS: usize = if cfg!(test) { 12 } else { 4096 };

/// Short lists have so many parts, if each gets [`FEWEST_ITEMS`].
const FEW: usize = 32;

/// Least items a part, however long they take.
const FEWEST_ITEMS: usize = if cfg!(test) { 6 } else { 512 };

/// When less than this share of all items is left, one thread does the rest.
const LITTLE: f64 = 0.001;

/// Vertices or tetrahedra that are looked at in one task.
const GRAIN: usize = 1 << 13;

/// Items that a task sorts by their parts.
const SHARE: usize = 1 << 14;

/// The parts of so many vertices are found together.
const AT_ONCE: usize = 8;

/// To look at so many tetrahedra is cheaper than to begin an item that meets another part.
const TETS_AN_ITEM: usize = if cfg!(test) { 12 } else { 64 };

/// Items are asked for so many places ahead when their parts are found.
const KNOWN_AHEAD: usize = 16;

/// Instead of the part of an item: it waits for another round, or is gone.
const WAITS: u32 = u32::MAX;
const GONE: u32 = u32::MAX - 1;

/// An item and its number.
type Numbered<O> = (u32, <O as Operation>::Item);

/// What a part has of its own in a round, and its results.
struct Part {
    id_pool: IdPool,
    unprojected: Vec<VertexId>,
    counts: Counts,
    /// Numbers of items that met another part.
    again: Vec<u32>,
}

/// Applies the operation to all items on all threads of the pool.
pub fn run<'m, O: Operation>(
    operation: &O,
    items: &[O::Item],
    context: &Context<'m>,
    threads: &mut [ThreadContext<'_, 'm, O>],
    (pool, plan): (&Pool, Plan),
    advance: Advance<'_>,
) -> Counts {
    let mut counts = Counts::default();
    let mut left = Team::new(pool, plan).map(GRAIN, items.len(), |item| item as u32);
    let (mut parts, mut shared) = (first_parts(items.len(), O::EFFORT), false);
    loop {
        if parts < 2 || (left.len() as f64) < LITTLE * items.len() as f64 {
            let rest: Vec<_> = left.iter().map(|&i| items[i as usize]).collect();
            counts.add(&sequential::run(operation, &rest, context, &mut threads[0], advance));
            if shared {
                clear_owners(&context.store, (pool, plan));
            }
            return counts;
        }
        let before = left.len();
        let mut round = Round { operation, items, context, pool, plan, left, parts };
        left = round.run(threads, &mut counts, advance);
        if !advance(0) {
            clear_owners(&context.store, (pool, plan));
            return counts;
        }
        // What is left lies between the parts of this round, and is cut elsewhere in the next. Fewer and larger parts have less between them.
        let most = if 2 * left.len() > before { parts / 2 } else { parts };
        parts = most.min(power(left.len() / FEWEST_ITEMS));
        shared = true;
    }
}

/// Clears the owners of all vertices.
fn clear_owners(store: &Store, (pool, plan): (&Pool, Plan)) {
    pool.task_for(Plan { grain: GRAIN, ..plan }, store.vertex_bound(), |_, range| {
        range.for_each(|i| store.owner(VertexId(i as u32)).store(0, Relaxed));
    });
}

/// The owner of a vertex, 0 for none.
#[inline(always)]
fn owner(store: &Store, v: VertexId) -> u8 {
    store.owner(v).load(Relaxed)
}

/// How many parts the first round has: large ones, but a few even for short lists.
fn first_parts(items: usize, effort: usize) -> usize {
    power(effort * items / ITEMS).max(FEW.min(power(items / FEWEST_ITEMS))).min(MOST_PARTS)
}

/// The greatest power of two that is no more than n, and no less than 1.
fn power(n: usize) -> usize {
    1 << n.max(1).ilog2()
}

struct Round<'r, 'm, O: Operation> {
    operation: &'r O,
    items: &'r [O::Item],
    context: &'r Context<'m>,
    pool: &'r Pool,
    plan: Plan,
    /// Numbers of the items to be done, ascending.
    left: Vec<u32>,
    parts: usize,
}

impl<'m, O: Operation> Round<'_, 'm, O> {
    fn item(&self, number: u32) -> O::Item {
        self.items[number as usize]
    }

    /// Does what can be done; returns what is left.
    fn run(&mut self, threads: &mut [ThreadContext<'_, 'm, O>], counts: &mut Counts, advance: Advance<'_>) -> Vec<u32> {
        let store = &self.context.store;
        let team = Team::new(self.pool, self.plan);
        self.assign_owners(&Parts::of(team, self.left.len(), self.parts, |at| self.sample(self.item(self.left[at]))));
        let parts_of = self.parts_of_items();
        let (sorted, starts, waiting) = self.sorted(&parts_of, counts);
        let id_pools = threads[0].state.id_pool.split(store, self.parts);
        let part = |id_pool| Part { id_pool, unprojected: Vec::new(), counts: Counts::default(), again: Vec::new() };
        let parts: Vec<_> = id_pools.into_iter().map(|id_pool| Mutex::new(part(id_pool))).collect();
        // The largest first: a thread that began one at the end would keep the others waiting.
        let mut order: Vec<usize> = (0..self.parts).collect();
        order.sort_by_key(|&part| Reverse(starts[part + 1] - starts[part]));
        let plan = Plan { grain: 1, ..self.plan };
        self.pool.task_for_with(plan, self.parts, threads, |thread, _, range| {
            // After a stop no further part begins.
            for &index in order[range].iter().take_while(|_| advance(0)) {
                let mut part = parts[index].lock().expect("each part is one task's");
                self.work(&sorted[starts[index]..starts[index + 1]], index, &mut part, thread, advance);
            }
        });
        let parts: Vec<_> = parts.into_iter().map(|part| part.into_inner().expect("no part failed")).collect();
        let mut again = team.map(GRAIN, waiting.len(), |at| waiting[at].0);
        let mut id_pools = Vec::with_capacity(parts.len());
        for part in parts {
            counts.add(&part.counts);
            again.extend(part.again);
            threads[0].state.unprojected.extend(part.unprojected);
            id_pools.push(part.id_pool);
        }
        threads[0].state.id_pool.merge(team, store, id_pools);
        team.sort(&mut again);
        again
    }

    /// Where an item is, by its first vertex.
    fn sample(&self, item: O::Item) -> Option<Sample> {
        let store = &self.context.store;
        let v = item.vertices(store)[0];
        let position = |v| store.position(v);
        let is_live = v.is_some() && store.is_vertex(v);
        is_live.then(|| Sample::of(position(v), store.vertices(store.tet_of(v)).map(position)))
    }

    /// Writes the owners of the vertices. Dead ids have none: any part may get them.
    fn assign_owners(&self, parts: &Parts) {
        let store = &self.context.store;
        self.pool.task_for(Plan { grain: GRAIN, ..self.plan }, store.vertex_bound(), |_, range| {
            for start in range.clone().step_by(AT_ONCE) {
                let vertices = std::array::from_fn(|i| VertexId((start + i).min(range.end - 1) as u32));
                let held = parts.hold::<AT_ONCE>(vertices.map(|v| store.position(v)));
                for (v, part) in vertices.into_iter().zip(held) {
                    store.owner(v).store(if store.is_vertex(v) { Owned::word(part) } else { 0 }, Relaxed);
                }
            }
        });
    }

    /// For each item the part in which it can be done.
    fn parts_of_items(&self) -> Vec<u32> {
        let store = &self.context.store;
        // Where few items are left, they find out by themselves.
        let is_worth = O::WHOLE_BALLS && self.left.len() * TETS_AN_ITEM > store.tet_bound();
        let between = if is_worth { self.between() } else { Vec::new() };
        let part_of = |at: usize| {
            if let Some(&ahead) = self.left.get(at + KNOWN_AHEAD) {
                self.item(ahead).fetch_known_by(store);
            }
            let vertices = self.item(self.left[at]).vertices(store);
            if vertices.iter().any(|&v| !v.is_some() || owner(store, v) == 0) {
                return GONE;
            }
            let part = owner(store, vertices[0]);
            let is_between = |v: &VertexId| between.get(v.index()).is_some_and(|flag| flag.load(Relaxed));
            let waits = vertices.iter().any(|v| owner(store, *v) != part || is_between(v));
            if waits { WAITS } else { u32::from(part - Owned::word(0)) }
        };
        self.pool.collect(Plan { grain: GRAIN, ..self.plan }, self.left.len(), |_, range, found| {
            found.extend(range.map(part_of));
        })
    }

    /// For each vertex whether it has a neighbour in another part.
    fn between(&self) -> Vec<AtomicBool> {
        let store = &self.context.store;
        let between: Vec<AtomicBool> = bytemuck::allocation::zeroed_vec(store.vertex_bound());
        self.pool.task_for(Plan { grain: GRAIN, ..self.plan }, store.tet_bound(), |_, range| {
            for t in store.live_tets_in(range) {
                let vertices = store.vertices(t);
                let [a, b, c, d] = vertices.map(|v| owner(store, v));
                if (a ^ b) | (a ^ c) | (a ^ d) != 0 {
                    vertices.iter().for_each(|v| between[v.index()].store(true, Relaxed));
                }
            }
        });
        between
    }

    /// The items with their numbers, sorted by part, where each part begins, and those that wait. Items that are gone are counted as `Stale`.
    fn sorted(&self, parts_of: &[u32], counts: &mut Counts) -> (Vec<Numbered<O>>, Vec<usize>, Vec<Numbered<O>>) {
        // Each task deals a share out, by places: the parts', then that of those that wait, then that of those that are gone.
        let place = |part: u32| (part as usize).min(self.parts) + usize::from(part == GONE);
        let places = self.parts + 2;
        let team = Team::new(self.pool, self.plan);
        let shares = team.chunks(SHARE, self.left.len(), |range| {
            let mut starts = vec![0u32; places + 2];
            // Counted two places on: while the items are dealt out, each start moves to the next one's place.
            parts_of[range.clone()].iter().for_each(|&part| starts[place(part) + 2] += 1);
            (1..starts.len()).for_each(|at| starts[at] += starts[at - 1]);
            let mut dealt = vec![(0, self.items[0]); range.len()];
            for (&number, &part) in self.left[range.clone()].iter().zip(&parts_of[range]) {
                let at = &mut starts[place(part) + 1];
                dealt[*at as usize] = (number, self.item(number));
                *at += 1;
            }
            (starts, dealt)
        });
        let slices = |place: usize| {
            shares.iter().map(move |(starts, dealt)| &dealt[starts[place] as usize..starts[place + 1] as usize])
        };
        let count = |place: usize| slices(place).map(<[Numbered<O>]>::len).sum::<usize>();
        let mut starts = vec![0; self.parts + 1];
        (0..self.parts).for_each(|part| starts[part + 1] = starts[part] + count(part));
        (0..count(self.parts + 1)).for_each(|_| counts.record(Err(Refusal::Stale)));
        let sorted = team.join_slices((0..self.parts).flat_map(slices));
        (sorted, starts, team.join_slices(slices(self.parts)))
    }

    /// Does the items of one part.
    fn work(
        &self,
        items: &[Numbered<O>],
        index: usize,
        part: &mut Part,
        thread: &mut ThreadContext<'_, 'm, O>,
        advance: Advance<'_>,
    ) {
        let ThreadContext { state, scratch } = thread;
        let own = std::mem::take(&mut state.unprojected);
        std::mem::swap(&mut state.id_pool, &mut part.id_pool);
        let mut worker = Worker::new(self.context, state, Owned::new(index));
        for start in (0..items.len()).step_by(STRIDE) {
            let some = &items[start..items.len().min(start + STRIDE)];
            let waiting = part.again.len();
            for (at, &(number, item)) in (start..).zip(some) {
                fetch_ahead(&self.context.store, |n| items.get(at + n).map(|&(_, item)| item));
                let result = self.operation.attempt(&mut worker, scratch, item);
                part.counts.record(result);
                if result == Err(Refusal::Conflict) {
                    part.again.push(number);
                }
            }
            if !advance(some.len() - (part.again.len() - waiting)) {
                break;
            }
        }
        drop(worker);
        std::mem::swap(&mut state.id_pool, &mut part.id_pool);
        part.unprojected = std::mem::replace(&mut state.unprojected, own);
    }
}
