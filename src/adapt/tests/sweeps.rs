//! After every sweep of every kind the whole mesh is valid, and there was something to do.
use super::bench::{Bench, Shape, Task, sample};
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::mesh::vector::sub;
use crate::metric::quality::edge_length;
use crate::tasks::Team;
use std::collections::BTreeSet;

/// Rounds of all kinds of sweeps; returns how often each was carried out.
fn rounds(shape: Shape, n: u32, size: f64, rounds: usize) -> [u64; 10] {
    let sample = sample(shape, n, size);
    let mut bench = Bench::new(&sample, 1, 7);
    let mut done = [0; 10];
    for _ in 0..rounds {
        for (task, done) in Task::ALL.into_iter().zip(&mut done) {
            *done += bench.sweep(task).done;
        }
    }
    done
}

fn each_was_done(done: [u64; 10]) {
    for (task, done) in Task::ALL.into_iter().zip(done) {
        assert!(done > 0, "{task:?} was never carried out");
    }
}

#[test]
fn a_cube_stays_valid_while_it_is_refined() {
    each_was_done(rounds(Shape::Cube, 2, 0.4, 3));
}

/// The shortest new edge, and how many edges were split, in one sweep. None is to be shorter than 1.2, where the edge that is split is too long by no
/// more than the power tells.
fn split(power: f64) -> (f64, u64) {
    let sample = sample(Shape::Cube, 4, 0.125);
    let mut bench = Bench::new(&sample, 1, 7);
    (bench.context.limits.shortest_new, bench.context.limits.short_for_long) = (1.2, power);
    let old = bench.context.store.vertex_bound();
    let done = bench.sweep(Task::Split).done;
    let store = &bench.context.store;
    let new = bench.edges().into_iter().filter(|edge| edge.a.index().max(edge.b.index()) >= old);
    let lengths = new.map(|edge| {
        let way = sub(store.position(edge.b), store.position(edge.a));
        edge_length(way, &store.metric(edge.a), &store.metric(edge.b))
    });
    (lengths.fold(f64::INFINITY, f64::min), done)
}

#[test]
fn only_a_long_edge_is_split_into_short_ones() {
    let (shortest, few) = split(0.0);
    assert!(shortest > 1.2 - 1e-9 && few > 0, "{shortest} {few}");
    let (shortest, more) = split(1.0);
    assert!(shortest < 1.1 && more > few, "{shortest} {few} {more}");
}

#[test]
fn a_cube_stays_valid_while_it_is_coarsened() {
    let done = rounds(Shape::Cube, 5, 1.0, 3);
    assert!(done[1] + done[2] > 50, "{done:?}");
}

#[test]
fn thinning_leaves_what_the_model_holds_and_no_two_go_side_by_side() {
    for shape in [Shape::Cube, Shape::TwoRegions, Shape::Round] {
        let sample = sample(shape, 6, 1.0);
        let mut bench = Bench::new(&sample, 1, 5);
        let vertices = |bench: &Bench| bench.context.store.live_vertices().count();
        let before = vertices(&bench);
        let first = bench.sweep(Task::Thin).done as usize;
        // A vertex that goes takes its neighbours out of the sweep: an inner vertex has fourteen, some of which are another's too.
        assert!(20 * first > before && 4 * first < before, "{first} of {before}");
        let later: usize = (0..10).map(|_| bench.sweep(Task::Thin).done as usize).sum();
        // On the boundary a cavity may have grown over more.
        assert!(vertices(&bench) <= before - first - later);
        assert!(vertices(&bench) < before / 4, "{} of {before} are left", vertices(&bench));
    }
}

#[test]
fn an_interface_between_regions_stays_valid() {
    each_was_done(rounds(Shape::TwoRegions, 4, 0.5, 3));
}

/// The triangles of the interface, by their vertices.
fn interface(bench: &Bench) -> BTreeSet<[VertexId; 3]> {
    let store = &bench.context.store;
    let faces = store.live_tets().flat_map(|t| (0..4).map(move |i| (t, i)));
    let between = faces.filter(|&(t, i)| store.tags(t)[i] != 0 && store.neighbour(t, i).is_some());
    let sorted = |(t, i): (TetId, usize)| {
        let mut face = FACE[i].map(|k| store.vertices(t)[k]);
        face.sort();
        face
    };
    between.map(sorted).collect()
}

#[test]
fn flips_change_an_interface_on_both_sides_at_once() {
    let sample = sample(Shape::TwoRegions, 4, 0.5);
    let mut bench = Bench::new(&sample, 1, 11);
    let before = interface(&bench);
    bench.sweep(Task::Reconnect(Criterion::MeanRatio));
    let after = interface(&bench);
    assert_eq!(before.len(), after.len());
    assert!(before.difference(&after).count() >= 2, "no triangle of {} was flipped", before.len());
}

#[test]
fn a_round_body_stays_valid() {
    each_was_done(rounds(Shape::Round, 4, 0.5, 3));
}

#[test]
fn renumbering_leaves_a_valid_mesh_without_dead_records() {
    for shape in [Shape::Cube, Shape::TwoRegions, Shape::Round] {
        let sample = sample(shape, 5, 0.6);
        let mut bench = Bench::new(&sample, 1, 3);
        for task in [Task::Collapse, Task::Split, Task::Collapse] {
            bench.sweep(task);
        }
        let places = |bench: &Bench| {
            let store = &bench.context.store;
            let mut places: Vec<_> =
                store.live_vertices().map(|v| (store.position(v).map(f64::to_bits), store.entity(v))).collect();
            places.sort_unstable();
            places
        };
        let before = places(&bench);
        let number = bench.context.reorder(Team::alone()).unwrap();
        bench.states[0].id_pool.clear();
        bench.check("renumbering");
        let store = &bench.context.store;
        assert!(store.vertex_bound() < number.len() && store.live_vertices().count() == store.vertex_bound());
        assert_eq!(store.live_tets().count(), store.tet_bound());
        assert_eq!(number.iter().filter(|v| v.is_some()).count(), store.vertex_bound());
        assert!(store.live_tets().is_sorted_by_key(|t| store.vertices(t).into_iter().min()));
        assert!(places(&bench) == before);
        // At once again nothing changes, and work can go on.
        assert!(bench.context.reorder(Team::alone()).unwrap().into_iter().zip(0..).all(|(v, old)| v.0 == old));
        bench.context.store.reserve(Team::alone(), [1000, 6000], [0; 2]);
        bench.context.store.trim();
        bench.context.store.reserve(Team::alone(), [1000, 6000], [0; 2]);
        bench.sweep(Task::Split);
        bench.sweep(Task::Smooth);
    }
}
