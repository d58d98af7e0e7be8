//! Thinning before the passes, which would list and measure all edges again and again: of what coarsening left of a crowded mesh, and of what
//! follows another metric.
use super::stages::{COARSER, stage_limits};
use super::{KINDS, Pipeline, size_limits};
use crate::adapt::core::context::Limits;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::store::Store;
use crate::adapt::operations::collapse::thinning::Thin;
use crate::adapt::schedule::work::Kind;
use crate::geometry::Entity;
use std::sync::atomic::Ordering::Relaxed;

/// The store is renumbered when it has shrunk by this factor. With 2 that costs as much as it saves.
const SHRUNK: usize = 4;

/// Rounds of thinning of a crowded mesh, with flips between them.
const THINNINGS: usize = 3;

/// Rounds of thinning of what follows another metric, with flips and smoothing between them.
const ASKEW_THINNINGS: usize = 6;

/// A round that removes a lesser share of the vertices is the last.
const FEW: f64 = 0.02;

/// A vertex without a tetrahedron of this mean ratio follows another metric.
const FITS: f64 = 0.5;

/// Where a lesser share of the vertices does so, the mesh is good enough to be refined as it is.
const MANY: f64 = 0.15;

/// A mesh with a lesser share of the vertices expected is so coarse that refinement makes it anew in any case.
const COARSE: f64 = 0.2;

/// Limits while a crowded mesh is thinned: what gets too long or bad is split and flipped afterwards, when the mesh is small.
fn thin_limits() -> Limits {
    Limits { longest_new: 2.0, collapse_floor: 0.05, flip_below: 0.3, short: 0.7, ..size_limits() }
}

/// Limits while vertices that follow another metric are removed. Nothing is lost in tetrahedra that are bad already.
fn askew_limits() -> Limits {
    Limits { longest_new: 2.0 * COARSER, collapse_floor: 0.0, short: 0.7 * COARSER, ..stage_limits() }
}

impl Pipeline<'_, '_> {
    /// Removes vertices that are too near to others, with flips between the rounds.
    pub(super) fn thin(&mut self) {
        self.limit(thin_limits());
        for round in 0..THINNINGS {
            if round > 0 {
                self.reconnect(self.criterion, 1);
            }
            self.thin_in_sweeps(|pipeline, since| pipeline.vertices(|store, v| store.stamp(store.tet_of(v)) >= since));
        }
        self.reorder();
        self.limit(size_limits());
    }

    /// Removes vertices that follow another metric, down to sizes [`COARSER`] times as large. Between cells that lie askew the new vertices of one
    /// edge would be too near to those of others, and most would be collapsed again. Flips turn the cells towards the metric between the rounds.
    /// Smoothing takes vertices out of rows: there hardly one can go onto a neighbour, which lies in the planes of the faces that are to be joined
    /// to it.
    ///
    /// Not where faces are too curved for the metric: there a boundary has crossed itself in the end.
    pub(super) fn thin_askew(&mut self) {
        let live = self.live() as f64;
        if live < COARSE * self.expected || (self.askew(0).len() as f64) < MANY * live || self.is_too_curved() {
            return;
        }
        self.smooth();
        for _ in 0..ASKEW_THINNINGS {
            self.limit(askew_limits());
            let live = self.live();
            self.thin_in_sweeps(Self::askew);
            self.limit(size_limits());
            self.reconnect(self.criterion, 1);
            self.smooth();
            if self.observer.stop() || ((live - self.live()) as f64) < FEW * live as f64 {
                break;
            }
        }
        // The passes look at everything.
        self.looked = [0; KINDS];
        self.reorder();
    }

    /// Vertices that follow another metric, of those whose neighbourhood changed at this time or later. Those on ridges stay, and those on curved
    /// faces, which a coarser mesh would follow less closely.
    fn askew(&self, since: u32) -> Vec<VertexId> {
        let fits = self.at_tets(|store, t| store.quality(t) >= FITS);
        let may_go = |store: &Store, v| match store.entity(v) {
            Entity::Interior => true,
            Entity::Face(face) => self.context.planes[face as usize].is_some(),
            Entity::Edge(_) | Entity::Vertex(_) => false,
        };
        let is_wanted = |store: &Store, v| may_go(store, v) && store.stamp(store.tet_of(v)) >= since;
        self.vertices(|store, v| !fits[v.index()].load(Relaxed) && is_wanted(store, v))
    }

    /// Sweeps over the vertices that are wanted, of those whose neighbourhood changed since the last sweep, until few of them go.
    fn thin_in_sweeps(&mut self, wanted: impl Fn(&Self, u32) -> Vec<VertexId>) {
        let mut since = 0;
        loop {
            let live = self.live();
            let items = wanted(self, since);
            since = self.context.store.clock() + 1;
            let done = if self.observer.stop() { 0 } else { self.sweep(Kind::Collapse, &Thin, &items).done as usize };
            if items.is_empty() || (done as f64) < self.effort.little * items.len() as f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::passes::pipeline::Effort;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::metric::{Background, Source, Sym3};

    /// Insertions a vertex that is left, of a cube with cells of the same size in all directions and a metric of cells thin in one.
    fn inserted(sizes: [f64; 3], effort: Effort) -> f64 {
        let mut sample = sample(Shape::Cube, 12, 1.0);
        let log = Sym3::diagonal(sizes[0].powi(-2), sizes[1].powi(-2), sizes[2].powi(-2)).ln();
        let logs = sample.mesh.vertices.iter().map(|_| log).collect();
        let background = Background::new(sample.mesh.vertices.clone(), sample.mesh.tets.nodes.clone(), logs);
        sample.source = Source::Background(background);
        let mut bench = Bench::new(&sample, 1, 3);
        let (inserted, left) = bench.with_pipeline(|pipeline| {
            pipeline.effort = effort;
            pipeline.run();
            (pipeline.work[Kind::Split as usize].counts.done as f64, pipeline.live() as f64)
        });
        bench.check("cells that lay askew");
        assert!(left > 500.0, "{left}");
        inserted / left
    }

    #[test]
    fn where_cells_follow_another_metric_few_vertices_are_inserted_in_vain() {
        let of = |effort| inserted([0.01, 0.3, 0.3], effort);
        let [thinned, not] = [Effort::FULL, Effort { stages: false, ..Effort::FULL }].map(of);
        assert!(thinned < 0.6 * not, "{thinned} {not}");
    }
}
