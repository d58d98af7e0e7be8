//! Many threads on meshes so small that they meet all the time.
use super::bench::{Bench, Shape, Task, sample};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::schedule::Scheduler;
use std::time::{Duration, Instant};

/// Long enough on the slowest machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Random sweeps for so long, on a busy machine until there were conflicts, with the check after each. Returns attempts, successes and
/// conflicts.
fn stress(shape: Shape, n: u32, threads: usize, scheduler: Scheduler, time: Duration) -> [u64; 3] {
    let sample = sample(shape, n, 0.5);
    let mut bench = Bench::new(&sample, threads, threads as u64);
    bench.scheduler = scheduler;
    let mut sums = [0; 3];
    let begin = Instant::now();
    let enough = |sums: [u64; 3]| (sums[1] > 100 && sums[2] > 0) || begin.elapsed() > PATIENCE;
    while begin.elapsed() < time || !enough(sums) {
        let task = Task::ALL[bench.random.below(Task::ALL.len())];
        // Finer and coarser in turn: there is always something to do.
        bench.vary_sizes();
        let counts = bench.sweep(task);
        sums[0] += counts.attempts;
        sums[1] += counts.done;
        sums[2] += counts.refused[Refusal::Conflict as usize];
    }
    eprintln!("{shape:?}, {threads} threads, {scheduler:?}: {sums:?} attempts, done, conflicts");
    sums
}

fn all_shapes(threads: usize, scheduler: Scheduler) {
    let seconds = std::env::var("GEO_ADAPT_STRESS").ok().and_then(|text| text.parse().ok()).unwrap_or(1.0);
    for (shape, n) in [(Shape::Cube, 2), (Shape::TwoRegions, 2), (Shape::Round, 2)] {
        let [_, done, conflicts] = stress(shape, n, threads, scheduler, Duration::from_secs_f64(seconds));
        assert!(done > 100 && conflicts > 0, "{shape:?}: {done} done, {conflicts} conflicts");
    }
}

#[test]
fn two_threads_keep_the_mesh_valid() {
    all_shapes(2, Scheduler::Speculative);
}

#[test]
fn four_threads_keep_the_mesh_valid() {
    all_shapes(4, Scheduler::Speculative);
}

#[test]
fn eight_threads_keep_the_mesh_valid() {
    all_shapes(8, Scheduler::Speculative);
}

#[test]
fn parts_of_one_thread_each_keep_the_mesh_valid() {
    all_shapes(4, Scheduler::Deterministic);
}
