//! A panic goes to who waits when all others have ended, and the pool lives on.
use crate::{THREADS, add, backends, each_plan};
use geo_adapt::tasks::Pool;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The message that the work panics with.
fn message(work: impl FnOnce()) -> String {
    let panic = catch_unwind(AssertUnwindSafe(work)).expect_err("it panics");
    panic.downcast_ref::<String>().cloned().or(panic.downcast_ref::<&str>().map(ToString::to_string)).expect("words")
}

#[test]
fn of_a_loop() {
    each_plan(2, |pool, plan| {
        let others = AtomicUsize::new(0);
        let work = || {
            pool.task_for(plan, 100, |_, range| {
                assert!(range.start != 98, "number {}", range.start);
                others.fetch_add(range.len(), Relaxed);
            });
        };
        assert_eq!(message(work), "number 98");
        assert_eq!(others.into_inner(), 98, "{plan:?}: all others have ended");
        let again = AtomicUsize::new(0);
        pool.task_for(plan, 100, |_, range| add(&again, range.len()));
        assert_eq!(again.into_inner(), 100);
    });
}

#[test]
fn of_all_tasks() {
    each_plan(1, |pool, plan| {
        assert_eq!(message(|| pool.task_for(plan, 50, |_, _| panic!("all of them"))), "all of them");
    });
}

#[test]
fn of_a_nested_loop() {
    each_plan(1, |pool, plan| {
        let caught = AtomicUsize::new(0);
        pool.task_for(plan, 8, |_, outer| {
            let inner = || pool.task_for(plan, 8, |_, inner| assert!(inner.start != 5, "five of {}", outer.start));
            assert_eq!(message(inner), format!("five of {}", outer.start));
            caught.fetch_add(1, Relaxed);
        });
        assert_eq!(caught.into_inner(), 8, "{plan:?}");
    });
}

#[test]
fn of_scopes() {
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        for backend in backends() {
            let ended = AtomicUsize::new(0);
            let ended = &ended;
            // A task panics: told by wait_all, and once only.
            pool.scope(backend, |scope| {
                for one in 0..20 {
                    scope.spawn(move |_| {
                        assert!(one != 3, "three");
                        ended.fetch_add(1, Relaxed);
                    });
                }
                assert_eq!(message(|| scope.wait_all()), "three");
                assert_eq!(ended.load(Relaxed), 19);
                scope.wait_all();
            });
            // Told by the scope's end.
            let work = || pool.scope(backend, |scope| scope.spawn(|task| task.spawn(|_| panic!("late"))));
            assert_eq!(message(work), "late");
            // The body panics: its tasks end first.
            ended.store(0, Relaxed);
            let work = || {
                pool.scope(backend, |scope| {
                    (0..20).for_each(|_| scope.spawn(move |_| add(ended, 1)));
                    panic!("body");
                });
            };
            assert_eq!(message(work), "body");
            assert_eq!(ended.load(Relaxed), 20, "{backend:?}");
        }
    }
}

#[test]
fn of_each_thread() {
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        assert_eq!(message(|| pool.on_each_thread(&|thread| assert!(thread != 0, "first"))), "first");
        let count = AtomicUsize::new(0);
        pool.on_each_thread(&|_| add(&count, 1));
        assert_eq!(count.into_inner(), threads);
    }
}
