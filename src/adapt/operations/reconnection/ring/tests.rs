//! Estimates in one metric beside what is measured in each tetrahedron's own.
use super::*;
use crate::adapt::core::access::Exclusive;
use crate::adapt::core::ids::{EDGE, TetId};
use crate::adapt::core::shell::Shell;
use crate::adapt::core::worker::Worker;
use crate::adapt::tests::bench::{Bench, Shape, sample};
use crate::metric::{Background, Source};

/// Visits the rings about all edges inside a slanted cube with this metric, that has room for other triangulations; returns how many
/// there are.
fn each_ring(metric: impl Fn(Vec3) -> Sym3, mut visit: impl FnMut(&Store, &mut Ring)) -> usize {
    let mut sample = sample(Shape::Cube, 5, 0.4);
    let logs = sample.mesh.vertices.iter().map(|&p| metric(p).ln()).collect();
    sample.source =
        Source::Background(Background::new(sample.mesh.vertices.clone(), sample.mesh.tets.nodes.clone(), logs));
    let mut bench = Bench::new(&sample, 1, 3);
    let (context, states) = (&bench.context, &mut bench.states);
    let mut worker = Worker::new(context, &mut states[0], Exclusive);
    let tets: Vec<TetId> = worker.store.live_tets().collect();
    let (mut ring, mut count) = (Ring::default(), 0);
    for t in tets {
        let v = worker.store.vertices(t);
        for [i, j] in EDGE {
            if worker.gather_shell(v[i], v[j], t).is_err() {
                continue;
            }
            let Shell { ring: around, closed, .. } = &worker.state.shell;
            if !closed || !(3..=LONGEST_RING).contains(&around.len()) {
                continue;
            }
            ring.fill(worker.store, [v[i], v[j]], around, None);
            if ring.is_feasible() {
                count += 1;
                visit(worker.store, &mut ring);
            }
        }
    }
    count
}

/// Σ (1/Q − 1) of the best triangulation, as estimated and as measured; none where all have a flat tetrahedron.
fn costs(store: &Store, ring: &mut Ring) -> Option<[f64; 2]> {
    ring.is_promising(store, 0.0, 0.0);
    let (first, last) = ring.polygons[0];
    let estimated = -ring.score[first][last];
    (estimated < 1e4).then(|| [estimated, -ring.measure(store)])
}

#[test]
fn where_the_metric_is_constant_the_estimate_is_what_is_measured() {
    // Sizes of any magnitude.
    for scale in [1.0, 1e-120, 1e120] {
        let metric = Sym3([40.0, 7.0, 90.0, -3.0, 5.0, 12.0]).times(scale);
        let mut found = 0;
        each_ring(
            |_| metric,
            |store, ring| {
                assert!(ring.is_even, "{scale}");
                if let Some([estimated, measured]) = costs(store, ring) {
                    found += 1;
                    assert!((estimated - measured).abs() < 1e-6 * (1.0 + measured), "{scale}: {estimated} {measured}");
                }
            },
        );
        assert!(found > 300, "{scale}: {found}");
    }
}

#[test]
fn where_sizes_grow_from_cell_to_cell_estimates_are_near() {
    // Layers that grow by a quarter from one to the next, of cells of 1 : 10.
    let size = |p: Vec3| 0.05 + 0.25 * p[2].max(0.0);
    let metric = |p: Vec3| Sym3::diagonal(4.0, 4.0, size(p).powi(-2));
    let mut off = Vec::new();
    let count = each_ring(metric, |store, ring| {
        if ring.is_even
            && let Some([estimated, measured]) = costs(store, ring)
        {
            off.push((estimated / measured - 1.0).abs());
        }
    });
    off.sort_by(f64::total_cmp);
    assert!(off.len() > 300 && off.len() as f64 > 0.5 * count as f64, "{} of {count}", off.len());
    let [median, most] = [off[off.len() / 2], off[off.len() * 19 / 20]];
    assert!(median < 0.05 && most < 0.25, "{median} {most}");
}

#[test]
fn where_the_thin_direction_turns_nothing_is_estimated() {
    // Layers of 1 : 100 about an axis far below: the normal turns by a fifth from cell to cell.
    let metric = |p: Vec3| {
        let away = crate::mesh::vector::unit([p[0], 0.0, p[2] + 1.0]);
        Sym3::IDENTITY.plus(Sym3::outer(away, 1e4))
    };
    let mut even = 0;
    let count = each_ring(metric, |store, ring| {
        even += usize::from(ring.is_even);
        if !ring.is_even
            && let Some([scored, measured]) = costs(store, ring)
        {
            // All possible triangles are measured: the best is the best of those.
            assert!((scored - measured).abs() < 1e-9 * (1.0 + measured), "{scored} {measured}");
        }
    });
    assert!(count > 300 && (even as f64) < 0.2 * count as f64, "{even} of {count}");
}
