//! The deterministic scheduler leaves the same store to the bit, ids included, whatever the number of threads and who runs the tasks.
use super::bench::{Bench, Shape, Task, sample};
use super::random::{Tet, Vertex, picture};
use crate::adapt::schedule::Scheduler;
use crate::tasks::{Backend, Plan, Strategy};

/// What a number of random sweeps leave, and how many items met another part.
fn left(shape: Shape, threads: usize, plan: Plan, seed: u64) -> ((Vec<Tet>, Vec<Vertex>), u64) {
    let sample = sample(shape, 3, 0.4);
    let mut bench = Bench::new(&sample, threads, seed);
    (bench.scheduler, bench.plan) = (Scheduler::Deterministic, plan);
    let mut conflicts = 0;
    for round in 0..30 {
        bench.vary_sizes();
        let task = Task::ALL[(round * 7 + seed as usize) % Task::ALL.len()];
        conflicts += bench.sweep(task).refused[0];
    }
    (picture(&bench.context.store), conflicts)
}

fn is_the_same_for_all(shape: Shape) {
    for seed in [1, 2, 3] {
        let (expected, conflicts) = left(shape, 1, Plan::default(), seed);
        assert!(conflicts > 0 && expected.0.len() > 20);
        for threads in [2, 3, 8] {
            for (backend, strategy) in [
                (Backend::Stealing, Strategy::TwoLevel),
                (Backend::Stealing, Strategy::Hierarchical),
                (Backend::Rayon, Strategy::Flat),
            ] {
                let plan = Plan { backend, strategy, ..Plan::default() };
                let found = left(shape, threads, plan, seed);
                assert!(
                    found.0 == expected && found.1 == conflicts,
                    "{shape:?}, seed {seed}, {threads} threads, {plan:?}"
                );
            }
        }
    }
}

#[test]
fn a_cube_is_the_same_for_all_threads() {
    is_the_same_for_all(Shape::Cube);
}

#[test]
fn two_regions_are_the_same_for_all_threads() {
    is_the_same_for_all(Shape::TwoRegions);
}

#[test]
fn a_round_body_is_the_same_for_all_threads() {
    is_the_same_for_all(Shape::Round);
}
