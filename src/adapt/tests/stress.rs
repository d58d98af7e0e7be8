//! Many threads on meshes so small that they meet all the time.
use super::bench::{Bench, Shape, Task, sample};
use crate::adapt::outcome::Refusal;
use std::time::{Duration, Instant};

/// Random sweeps for so long, the check after each; returns attempts, successes and conflicts.
fn stress(shape: Shape, n: u32, threads: usize, time: Duration) -> [u64; 3] {
    let sample = sample(shape, n, 0.5);
    let mut bench = Bench::new(&sample, threads, threads as u64);
    let mut sums = [0; 3];
    let begin = Instant::now();
    while begin.elapsed() < time {
        let task = Task::ALL[bench.random.below(Task::ALL.len())];
        // Finer and coarser in turn: there is always something to do.
        bench.context.limits.long = [0.7, 1.4, 2.8][bench.random.below(3)];
        bench.context.limits.short = 0.5 * bench.context.limits.long;
        bench.context.limits.longest_new = bench.context.limits.long;
        bench.context.limits.shortest_new = 0.3 * bench.context.limits.long;
        let counts = bench.sweep(task);
        sums[0] += counts.attempts;
        sums[1] += counts.done;
        sums[2] += counts.refused[Refusal::Conflict as usize];
    }
    eprintln!("{shape:?}, {threads} threads: {sums:?} attempts, done, conflicts");
    sums
}

fn all_shapes(threads: usize) {
    let seconds = std::env::var("GEO_ADAPT_STRESS").ok().and_then(|text| text.parse().ok()).unwrap_or(1.0);
    for (shape, n) in [(Shape::Cube, 2), (Shape::TwoRegions, 2), (Shape::Round, 2)] {
        let [_, done, conflicts] = stress(shape, n, threads, Duration::from_secs_f64(seconds));
        assert!(done > 100 && conflicts > 0, "{shape:?}: {done} done, {conflicts} conflicts");
    }
}

#[test]
fn two_threads_keep_the_mesh_valid() {
    all_shapes(2);
}

#[test]
fn four_threads_keep_the_mesh_valid() {
    all_shapes(4);
}

#[test]
fn eight_threads_keep_the_mesh_valid() {
    all_shapes(8);
}
