//! Tasks spawned one by one.
use crate::{THREADS, Watch, add, backends};
use geo_adapt::tasks::{Pool, Task};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

fn each_pool(mut test: impl FnMut(&Pool, geo_adapt::tasks::Backend)) {
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        backends().for_each(|backend| test(&pool, backend));
    }
}

#[test]
fn all_spawned_tasks_run_once() {
    each_pool(|pool, backend| {
        let (watch, times) = (Watch::new(pool), (0..500).map(|_| AtomicUsize::new(0)).collect::<Vec<_>>());
        let answer = pool.scope(backend, |scope| {
            for (one, time) in times.iter().enumerate() {
                let watch = &watch;
                scope.spawn(move |task| watch.task(task.thread(), &[one], || add(time, 1)));
            }
            42
        });
        assert_eq!(answer, 42);
        assert!(times.iter().all(|time| time.load(Relaxed) == 1), "{backend:?}");
    });
}

#[test]
fn tasks_spawn_tasks() {
    /// A binary tree of tasks.
    fn grow<'s>(task: &Task<'_, 's>, depth: usize, watch: &'s Watch, leaves: &'s AtomicUsize, name: usize) {
        watch.task(task.thread(), &[name], || {
            if depth == 0 {
                leaves.fetch_add(1, Relaxed);
            } else {
                for side in 0..2 {
                    task.spawn(move |task| grow(task, depth - 1, watch, leaves, 2 * name + side));
                }
            }
        });
    }
    each_pool(|pool, backend| {
        let (watch, leaves) = (Watch::new(pool), AtomicUsize::new(0));
        let (watch, counted) = (&watch, &leaves);
        pool.scope(backend, |scope| scope.spawn(move |task| grow(task, 10, watch, counted, 1)));
        assert_eq!(leaves.into_inner(), 1024, "{backend:?}");
    });
}

#[test]
fn a_long_chain_needs_no_stack() {
    fn next<'s>(task: &Task<'_, 's>, left: &'s AtomicUsize) {
        if left.fetch_sub(1, Relaxed) > 1 {
            task.spawn(|task| next(task, left));
        }
    }
    each_pool(|pool, backend| {
        let left = AtomicUsize::new(100_000);
        let counter = &left;
        pool.scope(backend, |scope| scope.spawn(|task| next(task, counter)));
        assert_eq!(left.into_inner(), 0, "{backend:?}");
    });
}

#[test]
fn wait_all_waits_for_all_and_the_scope_goes_on() {
    each_pool(|pool, backend| {
        let done = AtomicUsize::new(0);
        pool.scope(backend, |scope| {
            for round in 1..=5 {
                for _ in 0..20 {
                    let done = &done;
                    scope.spawn(move |task| {
                        Watch::tarry();
                        task.spawn(|_| add(done, 1));
                    });
                }
                scope.wait_all();
                assert_eq!(done.load(Relaxed), 20 * round, "{backend:?}");
            }
        });
    });
}

#[test]
fn an_empty_scope_ends() {
    each_pool(|pool, backend| pool.scope(backend, |scope| scope.wait_all()));
}

#[test]
fn one_thread_runs_in_order_and_never_one_task_in_another() {
    let pool = Pool::new(1).unwrap();
    let order = Mutex::new(Vec::new());
    let say = |what: &str| order.lock().unwrap().push(what.to_owned());
    let say = &say;
    pool.scope(Default::default(), |scope| {
        scope.spawn(move |task| {
            say("a begins");
            task.spawn(move |task| {
                say("a.1");
                task.spawn(move |_| say("a.1.1"));
            });
            task.spawn(move |_| say("a.2"));
            say("a ends");
        });
        say("body");
        scope.spawn(move |_| say("b"));
    });
    assert_eq!(order.into_inner().unwrap(), ["a begins", "a ends", "a.1", "a.2", "a.1.1", "body", "b"]);
}
