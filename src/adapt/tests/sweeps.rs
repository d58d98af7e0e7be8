//! After every sweep of every kind the whole mesh is valid, and there was something to do.
use super::bench::{Bench, Shape, Task, sample};

/// Rounds of all kinds of sweeps; returns how often each was carried out.
fn rounds(shape: Shape, n: u32, size: f64, rounds: usize) -> [u64; 8] {
    let sample = sample(shape, n, size);
    let mut bench = Bench::new(&sample, 1, 7);
    let mut done = [0; 8];
    for _ in 0..rounds {
        for (task, done) in Task::ALL.into_iter().zip(&mut done) {
            *done += bench.sweep(task).done;
        }
    }
    done
}

fn each_was_done(done: [u64; 8]) {
    for (task, done) in Task::ALL.into_iter().zip(done) {
        assert!(done > 0, "{task:?} was never carried out");
    }
}

#[test]
fn a_cube_stays_valid_while_it_is_refined() {
    each_was_done(rounds(Shape::Cube, 2, 0.4, 3));
}

#[test]
fn a_cube_stays_valid_while_it_is_coarsened() {
    let done = rounds(Shape::Cube, 5, 1.0, 3);
    assert!(done[1] > 50, "{done:?}");
}

#[test]
fn an_interface_between_regions_stays_valid() {
    each_was_done(rounds(Shape::TwoRegions, 4, 0.5, 3));
}

#[test]
fn a_round_body_stays_valid() {
    each_was_done(rounds(Shape::Round, 4, 0.5, 3));
}
