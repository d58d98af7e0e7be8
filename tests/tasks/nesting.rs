//! Loops and scopes within tasks: ids stay right, and who waits runs its descendants and nothing else.
use crate::{Watch, add, backends, each_plan, plans};
use geo_adapt::tasks::{Backend, Plan, Pool};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

#[test]
fn loops_within_loops() {
    each_plan(1, |pool, plan| {
        let (watch, count) = (Watch::new(pool), AtomicUsize::new(0));
        pool.task_for(plan, 6, |thread, outer| {
            watch.task(thread, &[outer.start], || {
                pool.task_for(Plan { grain: 2, ..plan }, 5, |thread, middle| {
                    watch.task(thread, &[outer.start, middle.start], || {
                        pool.task_for(plan, 4, |thread, inner| {
                            let ancestry = [outer.start, middle.start, inner.start];
                            watch.task(thread, &ancestry, Watch::tarry);
                            count.fetch_add(1, Relaxed);
                        });
                    });
                });
            });
        });
        assert_eq!(count.into_inner(), 6 * 3 * 4, "{plan:?}");
    });
}

#[test]
fn a_nested_loop_may_name_another_backend() {
    let pool = Pool::new(3).unwrap();
    for outer in plans(1) {
        for inner in plans(1) {
            let (watch, count) = (Watch::new(&pool), AtomicUsize::new(0));
            pool.task_for(outer, 4, |thread, a| {
                watch.task(thread, &[a.start], || {
                    pool.task_for(inner, 4, |thread, b| {
                        watch.task(thread, &[a.start, b.start], || add(&count, 1));
                    });
                });
            });
            assert_eq!(count.into_inner(), 16);
        }
    }
}

#[test]
fn a_lone_task_may_hold_a_loop() {
    // With one chunk no task is made, but what is within may make some.
    each_plan(1, |pool, plan| {
        let (watch, count) = (Watch::new(pool), AtomicUsize::new(0));
        pool.task_for(plan, 1, |thread, _| {
            watch.task(thread, &[0], || {
                pool.scope(plan.backend, |scope| {
                    // The task runs on, so its id is taken.
                    for one in 0..20 {
                        let (watch, count) = (&watch, &count);
                        scope.spawn(move |task| {
                            watch.task(task.thread(), &[0, one], Watch::tarry);
                            count.fetch_add(1, Relaxed);
                        });
                    }
                });
            });
        });
        assert_eq!(count.into_inner(), 20, "{plan:?}");
    });
}

#[test]
fn scopes_within_tasks() {
    each_plan(1, |pool, plan| {
        let (watch, count) = (Watch::new(pool), AtomicUsize::new(0));
        pool.task_for(plan, 7, |thread, outer| {
            watch.task(thread, &[outer.start], || {
                let part = AtomicUsize::new(0);
                pool.scope(plan.backend, |scope| {
                    for one in 0..5 {
                        let (watch, part, outer) = (&watch, &part, outer.start);
                        scope.spawn(move |task| {
                            watch.task(task.thread(), &[outer, one], Watch::tarry);
                            task.spawn(move |task| {
                                watch.task(task.thread(), &[outer, 100 + one], Watch::tarry);
                                part.fetch_add(1, Relaxed);
                            });
                        });
                    }
                });
                count.fetch_add(part.into_inner(), Relaxed);
            });
        });
        assert_eq!(count.into_inner(), 35, "{plan:?}");
    });
}

#[test]
fn a_loop_in_the_body_of_a_scope() {
    for threads in crate::THREADS {
        let pool = Pool::new(threads).unwrap();
        for plan in plans(1) {
            let (watch, count) = (Watch::new(&pool), AtomicUsize::new(0));
            pool.scope(plan.backend, |scope| {
                for one in 0..10 {
                    let (watch, count) = (&watch, &count);
                    scope.spawn(move |task| {
                        watch.task(task.thread(), &[one], Watch::tarry);
                        count.fetch_add(1, Relaxed);
                    });
                }
                pool.task_for(plan, 10, |thread, range| {
                    watch.task(thread, &[100 + range.start], Watch::tarry);
                    count.fetch_add(1, Relaxed);
                });
                assert!(count.load(Relaxed) >= 10, "the loop has ended");
            });
            assert_eq!(count.into_inner(), 20, "{plan:?}");
        }
    }
}

#[test]
fn states_are_free_when_tasks_begin() {
    // Tasks hold the state of their thread and spawn meanwhile: none may run on top of another.
    each_plan(1, |pool, plan| {
        let states: Vec<_> = (0..pool.threads()).map(|_| Mutex::new(0usize)).collect();
        pool.scope(plan.backend, |scope| {
            for _ in 0..300 {
                let states = &states;
                scope.spawn(move |task| {
                    let mut state = states[task.thread()].try_lock().expect("free");
                    for _ in 0..5 {
                        task.spawn(move |task| *states[task.thread()].try_lock().expect("free") += 1);
                    }
                    *state += 1;
                });
            }
        });
        let sum: usize = states.into_iter().map(|state| state.into_inner().unwrap()).sum();
        assert_eq!(sum, 300 * 6, "{plan:?}");
    });
}

#[test]
fn pools_within_pools_and_back() {
    for backend in backends() {
        let (a, b) = (Pool::new(3).unwrap(), Pool::new(2).unwrap());
        let plan = Plan { backend, ..Plan::default() };
        let (watch, count) = (Watch::new(&a), AtomicUsize::new(0));
        let here = std::thread::current().id();
        a.task_for(plan, 6, |thread, outer| {
            watch.task(thread, &[outer.start], || {
                b.task_for(Plan { backend: Backend::Stealing, ..plan }, 4, |_, middle| {
                    count.fetch_add(1, Relaxed);
                    // Only on the thread that came from the first pool may it be used again.
                    if std::thread::current().id() == here && backend == Backend::Stealing {
                        a.task_for(plan, 3, |thread, inner| {
                            watch.task(thread, &[outer.start, middle.start, inner.start], Watch::tarry);
                        });
                    }
                });
            });
        });
        assert_eq!(count.into_inner(), 24, "{backend:?}");
    }
}

#[test]
fn deep_nesting() {
    fn sum(pool: &Pool, plan: Plan, depth: usize) -> usize {
        if depth == 0 {
            return 1;
        }
        let total = AtomicUsize::new(0);
        pool.task_for(plan, 3, |_, _| add(&total, sum(pool, plan, depth - 1)));
        total.into_inner()
    }
    each_plan(1, |pool, plan| assert_eq!(sum(pool, plan, 6), 729, "{plan:?}"));
}
