//! Tasks keep their promises with every back-end that is built in, every strategy, grain and number of threads.
//! Further back-ends: `cargo test --features tbb,openmp --test tasks`.
mod gather;
mod loops;
mod nesting;
mod panics;
mod pools;
mod scopes;
mod team;

use geo_adapt::tasks::{Backend, Plan, Pool, Strategy};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const THREADS: [usize; 4] = [1, 2, 3, 8];

/// Those that this program has.
fn backends() -> impl Iterator<Item = Backend> {
    Backend::ALL.into_iter().filter(|backend| backend.is_built())
}

/// Every back-end with every strategy.
fn plans(grain: usize) -> impl Iterator<Item = Plan> {
    backends().flat_map(move |backend| Strategy::ALL.map(|strategy| Plan { backend, strategy, grain }))
}

/// Counts on.
fn add(count: &AtomicUsize, more: usize) {
    count.fetch_add(more, Relaxed);
}

/// A pool and a plan of every kind.
fn each_plan(grain: usize, mut test: impl FnMut(&Pool, Plan)) {
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        plans(grain).for_each(|plan| test(&pool, plan));
    }
}

/// Who is at work under each thread id: tasks by their ancestry, the innermost on top.
struct Watch(Vec<Mutex<Vec<Vec<usize>>>>);

impl Watch {
    fn new(pool: &Pool) -> Self {
        Self((0..pool.threads()).map(|_| Mutex::default()).collect())
    }

    /// Does `work` as a task, known by the numbers of its ancestors and its own, and holds that whoever waits under the same id is
    /// one of its ancestors.
    fn task<T>(&self, thread: usize, ancestry: &[usize], work: impl FnOnce() -> T) -> T {
        let stand = &self.0[thread];
        let mut stack = stand.lock().unwrap();
        if let Some(under) = stack.last() {
            let descends = ancestry.len() > under.len() && ancestry.starts_with(under);
            assert!(descends, "{ancestry:?} runs as {thread} while {under:?} does");
        }
        stack.push(ancestry.to_vec());
        drop(stack);
        let value = work();
        assert_eq!(stand.lock().unwrap().pop().as_deref(), Some(ancestry));
        value
    }

    /// A little work, so that threads meet.
    fn tarry() {
        (0..50).for_each(|_| std::hint::spin_loop());
        std::thread::yield_now();
    }
}
