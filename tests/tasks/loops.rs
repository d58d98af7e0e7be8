//! `task_for`: each item once, ids that are nobody else's.
use crate::{THREADS, Watch, add, each_plan, plans};
use geo_adapt::tasks::{Backend, Plan, Pool, Strategy};
use proptest::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Runs the loop and holds that it is right.
fn check(pool: &Pool, plan: Plan, items: usize) {
    let watch = Watch::new(pool);
    let times: Vec<_> = (0..items).map(|_| AtomicUsize::new(0)).collect();
    let grain = plan.grain.max(1);
    pool.task_for(plan, items, |thread, range: Range<usize>| {
        assert!(
            range.start.is_multiple_of(grain) && range.end == items.min(range.start + grain),
            "{range:?} is no chunk"
        );
        watch.task(thread, &[range.start], || times[range].iter().for_each(|time| add(time, 1)));
    });
    assert!(times.iter().all(|time| time.load(Relaxed) == 1), "{plan:?}, {items} items, {} threads", pool.threads());
}

#[test]
fn each_item_is_done_once() {
    for grain in [0, 1, 3, 64, 1000, usize::MAX] {
        each_plan(grain, |pool, plan| {
            for items in [0, 1, 2, 7, 63, 64, 65, 1000] {
                check(pool, plan, items);
            }
        });
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn each_item_is_done_once_whatever_the_sizes(items in 0usize..3000, grain in 1usize..200, threads in 2usize..9) {
        let pool = Pool::new(threads).unwrap();
        plans(grain).for_each(|plan| check(&pool, plan, items));
    }
}

#[test]
fn all_threads_take_part() {
    // Each task waits until as many others have begun as there are threads: only so many threads can end this. (oneTBB and OpenMP do
    // not promise it: of two threads of oneTBB one now and then sleeps on while the other has a task to give.)
    for threads in THREADS {
        let pool = Pool::new(threads).unwrap();
        for plan in plans(1).filter(|plan| matches!(plan.backend, Backend::Stealing | Backend::Rayon)) {
            let begun = AtomicUsize::new(0);
            let seen = Mutex::new(vec![false; threads]);
            pool.task_for(plan, threads, |thread, _| {
                seen.lock().unwrap()[thread] = true;
                begun.fetch_add(1, Relaxed);
                while begun.load(Relaxed) < threads {
                    std::thread::yield_now();
                }
            });
            assert!(seen.into_inner().unwrap().iter().all(|&thread| thread), "{plan:?}: a thread had nothing to do");
        }
    }
}

#[test]
fn one_thread_works_in_place_and_in_order() {
    let pool = Pool::new(1).unwrap();
    for plan in plans(10) {
        let (order, here) = (Mutex::new(Vec::new()), std::thread::current().id());
        pool.task_for(plan, 95, |thread, range| {
            assert_eq!((thread, std::thread::current().id()), (0, here));
            order.lock().unwrap().extend(range);
        });
        assert_eq!(order.into_inner().unwrap(), (0..95).collect::<Vec<_>>());
    }
}

#[test]
fn plans_change_from_call_to_call() {
    let pool = Pool::new(4).unwrap();
    for round in 0..20 {
        for plan in plans(1 + round % 5) {
            check(&pool, plan, 10 * round);
        }
    }
}

#[test]
fn what_the_tasks_wrote_is_seen_after_the_loop() {
    // No ordering but that of the tasks themselves: lost or late writes would show.
    let pool = Pool::new(3).unwrap();
    for plan in plans(7) {
        let mut numbers = vec![0usize; 5000];
        for round in 1..20 {
            pool.for_each_chunk_mut(plan, &mut numbers, |_, _, chunk| chunk.iter_mut().for_each(|number| *number += 1));
            assert!(numbers.iter().all(|&number| number == round));
        }
    }
}

#[test]
fn tiny_loops_one_after_another() {
    // Threads fall asleep and are woken all the time.
    let pool = Pool::new(4).unwrap();
    for plan in plans(1) {
        let rounds = if plan.backend == Backend::Stealing { 5000 } else { 500 };
        for round in 0..rounds {
            let sum = AtomicUsize::new(0);
            pool.task_for(plan, 2 + round % 7, |_, range| add(&sum, range.start + 1));
            let items = 2 + round % 7;
            assert_eq!(sum.into_inner(), items * (items + 1) / 2);
            if round % 50 == 0 {
                std::thread::sleep(std::time::Duration::from_micros(200));
            }
        }
    }
}

#[test]
fn many_tasks() {
    let pool = Pool::new(3).unwrap();
    for strategy in Strategy::ALL {
        let sum = AtomicUsize::new(0);
        let items = 200_000;
        pool.task_for(Plan { strategy, ..Plan::default() }, items, |_, range| add(&sum, range.start));
        assert_eq!(sum.into_inner(), items * (items - 1) / 2);
    }
}
