//! No call is lost on a thread that parks, in any order of threads and for every value that a load may have by the memory
//! model: loom runs through them all. The slots are the pool's own file on loom's locks and atomics; the queue, a counter here, is
//! written and read relaxed, so nothing but the slots order it. A lost call is a deadlock, which loom reports.
use loom::sync;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use loom::thread;

#[allow(dead_code)]
#[path = "../src/tasks/parking.rs"]
mod parking;
use parking::{For, Parking};

/// As many orders as two or three changes of thread at any point give: all of them take too long with three threads.
fn check(preemptions: usize, test: impl Fn() + Sync + Send + 'static) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(preemptions);
    model.check(test);
}

/// Takes a task if there is one.
fn take(tasks: &AtomicUsize) -> bool {
    tasks.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_ok()
}

/// A thread of the pool that is to run one task.
fn run_one(parking: &Parking, slot: usize, tasks: &AtomicUsize) {
    while !take(tasks) {
        parking.park(slot, For::Work, || tasks.load(Relaxed) > 0);
    }
}

#[test]
fn a_task_that_comes_while_a_thread_is_parked_is_found() {
    loom::model(|| {
        let state = Arc::new((Parking::new(1), AtomicUsize::new(0)));
        let other = Arc::clone(&state);
        let sleeper = thread::spawn(move || run_one(&other.0, 0, &other.1));
        state.1.fetch_add(1, Relaxed);
        state.0.unpark_one();
        sleeper.join().unwrap();
    });
}

#[test]
fn two_tasks_unpark_two_threads() {
    check(3, || {
        let state = Arc::new((Parking::new(2), AtomicUsize::new(0)));
        let sleepers = [0, 1].map(|slot| {
            let state = Arc::clone(&state);
            thread::spawn(move || run_one(&state.0, slot, &state.1))
        });
        for _ in 0..2 {
            state.1.fetch_add(1, Relaxed);
            state.0.unpark_one();
        }
        sleepers.into_iter().for_each(|sleeper| sleeper.join().unwrap());
    });
}

#[test]
fn who_waits_for_the_end_is_woken_by_it() {
    loom::model(|| {
        let state = Arc::new((Parking::new(1), AtomicBool::new(false)));
        let other = Arc::clone(&state);
        let last = thread::spawn(move || {
            other.1.store(true, Relaxed);
            other.0.unpark(0);
        });
        while !state.1.load(Relaxed) {
            state.0.park(0, For::Call, || state.1.load(Relaxed));
        }
        last.join().unwrap();
    });
}

#[test]
fn a_task_does_not_wake_who_waits_for_something_else() {
    check(3, || {
        // Were the one who waits for a call woken by the task, the other would sleep for ever.
        let state = Arc::new((Parking::new(2), AtomicUsize::new(0), AtomicBool::new(false)));
        let worker = {
            let state = Arc::clone(&state);
            thread::spawn(move || {
                run_one(&state.0, 0, &state.1);
                state.2.store(true, Relaxed);
                state.0.unpark(1);
            })
        };
        let waiter = {
            let state = Arc::clone(&state);
            thread::spawn(move || {
                while !state.2.load(Relaxed) {
                    state.0.park(1, For::Call, || state.2.load(Relaxed));
                }
            })
        };
        state.1.fetch_add(1, Relaxed);
        state.0.unpark_one();
        worker.join().unwrap();
        waiter.join().unwrap();
    });
}

#[test]
fn the_end_reaches_a_thread_that_sleeps_for_work() {
    loom::model(|| {
        // As when a pool is dropped: the thread may be looking for a task, falling asleep, or asleep.
        let state = Arc::new((Parking::new(1), AtomicBool::new(false)));
        let other = Arc::clone(&state);
        let worker = thread::spawn(move || {
            while !other.1.load(Relaxed) {
                other.0.park(0, For::Work, || other.1.load(Relaxed));
            }
        });
        state.1.store(true, Relaxed);
        state.0.unpark(0);
        worker.join().unwrap();
    });
}
