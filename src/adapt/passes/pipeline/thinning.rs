//! Thinning of what coarsening left of a crowded mesh. It comes before the passes, which would list and measure all edges again and again.
use super::{Pipeline, size_limits};
use crate::adapt::core::context::Limits;
use crate::adapt::operations::collapse::thinning::Thin;
use crate::adapt::schedule::work::Kind;

/// The store is renumbered when it has shrunk by this factor. With 2 that costs as much as it saves.
const SHRUNK: usize = 4;

/// Rounds of thinning, with flips between them.
const THINNINGS: usize = 3;

/// Limits while a crowded mesh is thinned: what gets too long or bad is split and flipped afterwards, when the mesh is small.
fn thin_limits() -> Limits {
    Limits { longest_new: 2.0, collapse_floor: 0.05, flip_below: 0.3, short: 0.7, ..size_limits() }
}

impl Pipeline<'_, '_> {
    /// Removes vertices that are too near to others, with flips between the rounds.
    pub(super) fn thin(&mut self) {
        self.limit(thin_limits());
        for round in 0..THINNINGS {
            if round > 0 {
                self.reconnect(self.criterion, 1);
            }
            self.thin_in_sweeps();
        }
        self.reorder();
        self.limit(size_limits());
    }

    /// Sweeps over the vertices whose neighbourhood changed, until few of them go.
    fn thin_in_sweeps(&mut self) {
        let mut since = 0;
        loop {
            let live = self.live();
            let items = self.vertices(|store, v| store.stamp(store.tet_of(v)) >= since);
            since = self.context.store.clock() + 1;
            let done = if self.observer.stop() { 0 } else { self.sweep(Kind::Collapse, &Thin, &items).done as usize };
            if (done as f64) < self.effort.little * items.len() as f64 {
                break;
            }
            if SHRUNK * (live - done) < self.context.store.vertex_bound() {
                self.reorder();
                // After that a vertex' own tetrahedron need not be the one that changed last.
                since = 0;
            }
        }
    }
}
