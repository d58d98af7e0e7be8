//! An observer that stops the work is answered within a sweep, and what comes is a valid mesh.
use geo_adapt::mesh::validity;
use geo_adapt::{Adapter, Kind, MeshView, Observer, Options, Scheduler, Settings};
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};

/// Stops after so many items, and counts those that were done all the same: but for those of projection, which are done to the end.
struct Stops {
    after: usize,
    items: AtomicUsize,
    later: AtomicUsize,
    kind: AtomicUsize,
}

impl Observer for Stops {
    fn begin(&self, kind: Kind, _pass: usize, _items: usize) {
        self.kind.store(kind as usize, SeqCst);
    }

    fn advance(&self, items: usize) {
        if self.stop() && self.kind.load(SeqCst) != Kind::Project as usize {
            self.later.fetch_add(items, SeqCst);
        }
        self.items.fetch_add(items, SeqCst);
    }

    fn stop(&self) -> bool {
        self.items.load(SeqCst) >= self.after
    }
}

/// A cube of n³ cells of six tetrahedra about their diagonals.
fn cube(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    let at = |i: u32, j: u32, k: u32| (i * (n + 1) + j) * (n + 1) + k;
    let range = || 0..=n;
    let points = range().flat_map(|i| range().flat_map(move |j| range().map(move |k| [i, j, k])));
    let points = points.map(|p| p.map(|x| f64::from(x) / f64::from(n))).collect();
    let mut tets = Vec::new();
    for cell in 0..n * n * n {
        let (i, j, k) = (cell / (n * n), cell / n % n, cell % n);
        let [a, b] = [at(i, j, k), at(i + 1, j + 1, k + 1)];
        let ring = [
            at(i + 1, j, k),
            at(i + 1, j + 1, k),
            at(i, j + 1, k),
            at(i, j + 1, k + 1),
            at(i, j, k + 1),
            at(i + 1, j, k + 1),
        ];
        tets.extend((0..6).map(|s| [a, ring[s], ring[(s + 1) % 6], b]));
    }
    (points, tets)
}

#[test]
fn a_stop_is_answered_within_a_sweep() {
    let (vertices, tets) = cube(8);
    let metric = vec![[1600.0, 0.0, 1600.0, 0.0, 0.0, 1600.0]; vertices.len()];
    for scheduler in Scheduler::ALL {
        for after in [1, 3000, 20_000, 60_000] {
            let options = Options { scheduler, ..Options::default() };
            let mut adapter = Adapter::discrete(Settings { threads: 2, options, ..Settings::default() }).unwrap();
            let zero = || AtomicUsize::new(0);
            let stops = Stops { after, items: zero(), later: zero(), kind: zero() };
            let view = MeshView { vertices: &vertices, tets: &tets, ..MeshView::default() };
            let adapted = adapter.adapt_observed(&view, &metric, &stops).unwrap();
            assert!(stops.items.into_inner() >= after, "{scheduler:?}: it ended before");
            // A thread notices after 1024 items at most; the speculative one after a task.
            let later = stops.later.into_inner();
            assert!(later <= 4 * 4096, "{scheduler:?}, {after}: {later} items after the stop");
            assert!(validity::check(&adapted.mesh).is_valid(), "{scheduler:?}, {after}");
        }
    }
}
