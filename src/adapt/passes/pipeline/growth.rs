//! A bound on growth: a mesh with far more vertices than its metric accounts for gets no more.
//!
//! A unit mesh has about two vertices a unit of complexity (METHOD.md §1), near walls three. A metric may ask on a curved wall for cells
//! so flat that the wall rises by many of them within one edge. Triangles of that shape would stand across the wall, so edges are cut
//! until the wall is flat between their ends, and each cut asks for more. Such a mesh would grow until memory ends.
use super::Pipeline;
use crate::adapt::core::ids::VertexId;
use crate::mesh::vector::volume6;
use crate::tasks::GRAIN;

/// No mesh of a metric that can be met has so many vertices a unit of complexity.
const MOST_A_COMPLEXITY: f64 = 8.0;

/// So many vertices, and twice those of the input, are allowed whatever the complexity.
const ALWAYS_ALLOWED: f64 = 20_000.0;

impl Pipeline<'_, '_> {
    /// Complexity of the metric on the mesh as it is: Σ √det M̄ |k| over the tetrahedra, M̄ the mean of their vertices.
    fn complexity(&self) -> f64 {
        let store = &self.context.store;
        self.team().sum(GRAIN, store.tet_bound(), |range| {
            let of = |vertices: [VertexId; 4]| {
                let [a, b, c, d] = vertices.map(|v| store.position(v));
                let trace: f64 = vertices.iter().map(|&v| store.log(v).trace()).sum();
                (0.125 * trace).exp() * volume6(a, b, c, d) / 6.0
            };
            store.live_tets_in(range).map(|t| of(store.vertices(t))).sum()
        })
    }

    /// Live vertices.
    pub(super) fn live(&self) -> usize {
        let store = &self.context.store;
        let parts = self.team().chunks(GRAIN, store.vertex_bound(), |range| store.live_vertices_in(range).count());
        parts.into_iter().sum()
    }

    /// Whether the mesh may still grow. Once the answer is no, it stays no in this run.
    pub(super) fn may_grow(&mut self) -> bool {
        let allowed = ALWAYS_ALLOWED + 2.0 * self.input as f64;
        let live = self.live() as f64;
        if !self.overgrown && live > allowed {
            self.overgrown = live > allowed + MOST_A_COMPLEXITY * self.complexity();
        }
        !self.overgrown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::operations::reconnection::criteria::Criterion;
    use crate::adapt::schedule::work::Silent;
    use crate::adapt::schedule::{Execution, Grains, Scheduler};
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::tasks::{Plan, Pool, Team};

    /// Whether a cube of 22 000 vertices may grow from a mesh of so many, for a metric of this size.
    fn may_grow(size: f64, input: usize) -> bool {
        let sample = sample(Shape::Cube, 27, size);
        let mut bench = Bench::new(&sample, 1, 3);
        let pool = Pool::new(1).unwrap();
        let (scheduler, plan, grains) = (Scheduler::Sequential, Plan::default(), Grains::default());
        let execution = Execution { pool: &pool, scheduler, plan, grains };
        let mut pipeline = Pipeline::new(&mut bench.context, execution, &Silent, Criterion::MeanRatio, Vec::new());
        pipeline.input = input;
        assert_eq!(pipeline.live(), 28 * 28 * 28);
        let may = pipeline.may_grow();
        let before = pipeline.live();
        pipeline.split();
        assert_eq!(pipeline.live() > before, may);
        may
    }

    #[test]
    fn a_mesh_that_its_metric_does_not_account_for_stops_growing() {
        assert!(!may_grow(0.5, 100));
        // Twice its input it may have in any case, and as much as the metric asks for.
        assert!(may_grow(0.1, 28 * 28 * 28));
        assert!(may_grow(0.03, 100));
    }

    #[test]
    fn without_memory_a_store_stays_as_it_is() {
        let sample = sample(Shape::Cube, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        let room = bench.context.store.room();
        assert!(!bench.context.store.reserve(Team::alone(), 1 << 42, 1000));
        assert!(!bench.context.store.reserve(Team::alone(), 0, 1 << 42));
        assert_eq!(bench.context.store.room(), room);
        bench.check("a reserve without memory");
        assert!(bench.context.store.reserve(Team::alone(), 1 << 16, 1 << 16));
    }
}
