//! Pools: made, shared, asked for what is not there, and dropped.
use crate::{THREADS, Watch, add, backends, plans};
use geo_adapt::tasks::{Backend, Plan, Pool};
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

#[test]
fn a_backend_that_is_not_built_in_is_said_to_be_missing() {
    let pool = Pool::new(2).unwrap();
    for backend in Backend::ALL {
        let prepared = pool.prepare(backend);
        assert_eq!(prepared.is_ok(), backend.is_built());
        if let Err(error) = prepared {
            let name = backend.name();
            let wanted = format!("built without the task back-end {name}; build with --features {name}");
            assert_eq!(error.to_string(), wanted);
            let panic = catch_unwind(AssertUnwindSafe(|| {
                pool.task_for(Plan { backend, ..Plan::default() }, 10, |_, _| ());
            }));
            assert_eq!(panic.unwrap_err().downcast_ref(), Some(&wanted));
        }
        assert_eq!(Pool::new(1).unwrap().prepare(backend).is_ok(), backend.is_built(), "one thread or many");
    }
}

#[test]
fn each_thread_has_its_turn_at_once_with_the_others() {
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        for _ in 0..100 {
            let (ids, begun) = (Mutex::new(HashSet::new()), AtomicUsize::new(0));
            pool.on_each_thread(&|thread| {
                ids.lock().unwrap().insert((thread, std::thread::current().id()));
                begun.fetch_add(1, Relaxed);
                while begun.load(Relaxed) < threads {
                    std::thread::yield_now();
                }
            });
            let ids = ids.into_inner().unwrap();
            assert_eq!(ids.iter().map(|(thread, _)| *thread).collect::<HashSet<_>>(), (0..threads).collect());
            assert_eq!(ids.iter().map(|(_, id)| *id).collect::<HashSet<_>>().len(), threads);
        }
    }
}

#[test]
#[should_panic(expected = "its threads are taken")]
fn each_thread_within_a_task_is_refused() {
    let pool = Pool::new(2).unwrap();
    pool.task_for(Plan::default(), 2, |_, _| pool.on_each_thread(&|_| ()));
}

#[test]
fn several_threads_share_a_pool() {
    let pool = Pool::new(3).unwrap();
    let (watch, count) = (Watch::new(&pool), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for guest in 0..4 {
            let (pool, watch, count) = (&pool, &watch, &count);
            scope.spawn(move || {
                for _ in 0..30 {
                    for plan in plans(1) {
                        pool.task_for(plan, 10, |thread, range| {
                            watch.task(thread, &[guest, range.start], || add(count, 1));
                        });
                    }
                }
            });
        }
    });
    assert_eq!(count.into_inner(), 4 * 30 * 10 * plans(1).count());
}

#[test]
fn pools_are_dropped_cleanly() {
    let before = threads_alive();
    for round in 0..50 {
        let pool = Pool::new(1 + round % 5).unwrap();
        for backend in backends().take(round % 4) {
            // Some are dropped just after a nested loop, calls for help still in the air.
            let plan = Plan { backend, ..Plan::default() };
            pool.task_for(plan, 4, |_, _| pool.task_for(plan, 3, |_, _| ()));
        }
    }
    // Those of TBB and OpenMP stay for the next pool, and other tests run beside this one.
    assert!(threads_alive() <= before + 150, "threads pile up: {} for {before}", threads_alive());
}

/// Threads of this process, where the system tells.
fn threads_alive() -> usize {
    std::fs::read_dir("/proc/self/task").map_or(0, Iterator::count)
}
