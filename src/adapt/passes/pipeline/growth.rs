//! A bound on growth: a mesh with more vertices than its metric accounts for gets no more.
//!
//! A unit mesh has about two vertices a unit of complexity (METHOD.md §1.5), near walls three. No mesh meets some metrics, and
//! it would grow until memory ends. On a curved wall a metric may ask for cells so flat that the wall rises by many of them within one edge:
//! edges are cut until the wall is flat between their ends, whatever their length, and each cut asks for more. Sizes may differ by many
//! orders within a cell, or be many times the domain in some directions.
use super::Pipeline;
use crate::adapt::core::id_pool::ID_BLOCK;
use crate::adapt::core::ids::{FACE, TetId};
use crate::adapt::core::measure;
use crate::adapt::schedule::deterministic::MOST_PARTS;
use crate::mesh::vector::{area2, norm};
use crate::metric::Sym3;
use crate::tasks::GRAIN;

/// No mesh of a metric that can be met has so many vertices a unit of complexity.
const MOST_A_COMPLEXITY: f64 = 8.0;

/// Nor so many a unit of area in the two greatest sizes, which counts where a domain is thinner than its cells. A surface mesh of unit
/// edges has 1.15.
const MOST_AN_AREA: f64 = 4.0;

/// So many vertices are allowed whatever the metric, and twice those of the input.
const ALWAYS_ALLOWED: f64 = 1_000.0;

/// The surface may bring so many more at most; and so many where the user bounds how far it deviates from the model, since no metric tells
/// how many that takes.
const FOR_THE_SURFACE: f64 = 20_000.0;

/// Room for so many tetrahedra a new vertex. Six are usual.
const TETS_A_VERTEX: usize = 12;

/// A mesh has so many tetrahedra a vertex.
const USUAL_TETS: f64 = 5.6;

/// Room is made for so many times the vertices and tetrahedra that are expected: some ids are those of dead ones.
const SPARE: f64 = 1.3;

/// With this share of the vertices that it may have, a mesh has them all: of the last edges most are refused.
const FULL: f64 = 0.995;

/// A mesh whose metric asks for so many times the vertices that it may have is not met, however many it has in the end.
const FAR: f64 = 1.25;

/// Why a mesh stopped growing before its metric was met.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GrowthEnd {
    /// It has far more vertices than the complexity of the metric accounts for: no mesh meets it.
    NotAccountedFor,
    /// It has as many vertices as were allowed.
    MaxVertices,
    /// There was no memory for more.
    Memory,
}

impl Pipeline<'_, '_> {
    /// Complexity of the metric on the mesh as it is, by each so many-th tetrahedron.
    pub(super) fn complexity(&self, step: usize) -> f64 {
        let store = &self.context.store;
        measure::complexity(self.team(), store, step, |v| store.log(v).trace())
    }

    /// Complexity of the source within the mesh, between its vertices too: those of a coarse mesh may miss a layer.
    pub(super) fn full_complexity(&self) -> f64 {
        let store = &self.context.store;
        let corners = |t: usize| {
            let t = TetId(t as u32);
            store.is_tet(t).then(|| store.vertices(t).map(|v| store.position(v)))
        };
        self.context.source.complexity_within(self.team(), store.tet_bound(), corners)
    }

    /// Area of the boundary and of interfaces in the two greatest sizes, so that the size across does not count.
    pub(super) fn area(&self) -> f64 {
        let store = &self.context.store;
        self.team().sum(GRAIN, store.tet_bound(), |range| {
            let of = |t: TetId, i: usize| {
                let corners = FACE[i].map(|k| store.vertices(t)[k]);
                let [a, b, c] = corners.map(|v| store.position(v));
                let logs = corners.map(|v| store.log(v));
                let mean: Sym3 = Sym3(std::array::from_fn(|k| logs.iter().map(|log| log.0[k]).sum::<f64>() / 3.0));
                let [least, middle, _] = mean.eigen().values;
                let sides = if store.neighbour(t, i).is_some() { 0.5 } else { 1.0 };
                0.5 * sides * norm(area2(a, b, c)) * (0.5 * (least + middle)).exp()
            };
            let tagged = |t: TetId| (0..4).filter(move |&i| store.is_surface(t, i)).map(move |i| (t, i));
            store.live_tets_in(range).flat_map(tagged).map(|(t, i)| of(t, i)).sum()
        })
    }

    /// Live vertices.
    pub(super) fn live(&self) -> usize {
        let store = &self.context.store;
        let parts = self.team().chunks(GRAIN, store.vertex_bound(), |range| store.live_vertices_in(range).count());
        parts.into_iter().sum()
    }

    /// Live tetrahedra.
    pub(super) fn live_tets(&self) -> usize {
        let store = &self.context.store;
        let parts = self.team().chunks(GRAIN, store.tet_bound(), |range| store.live_tets_in(range).count());
        parts.into_iter().sum()
    }

    /// Whether the mesh may grow now. Where its metric does not account for it, or there is no memory, the answer stays no in this run; where it has
    /// as many vertices as it may have, collapses may make room.
    pub(super) fn may_grow(&mut self) -> bool {
        let live = self.live();
        self.is_limited = self.is_full(live);
        if !self.is_limited && self.growth_end.is_none() && !self.is_accounted_for(live) {
            self.growth_end = Some(GrowthEnd::NotAccountedFor);
        }
        !self.is_limited && self.growth_end.is_none()
    }

    /// Whether so many vertices are as many as there may be.
    fn is_full(&self, live: usize) -> bool {
        live as f64 >= FULL * self.max_vertices as f64
    }

    /// Notes at the end of a run whether more vertices were wanted than there may be.
    pub(super) fn note_limit(&mut self) {
        let is_far = self.expected > FAR * self.max_vertices as f64;
        if self.is_limited && (is_far || self.is_full(self.live())) {
            self.growth_end.get_or_insert(GrowthEnd::MaxVertices);
        }
    }

    /// Of the items of a sweep that each add a vertex as many as may be, the first ones: of a metric that can be met all.
    pub(super) fn no_more_than_allowed<T>(&mut self, items: &mut Vec<T>) {
        let live = self.live();
        let room = self.max_vertices.saturating_sub(live);
        self.is_limited = items.len() > room;
        items.truncate(room);
        // Refused items count too, so twice as many are allowed here.
        if !self.is_accounted_for((live + items.len()) / 2) {
            items.truncate(((2.0 * self.allowed()) as usize).saturating_sub(live));
        }
    }

    /// Makes room for so many new vertices, with the tetrahedra about them, and for what flips add.
    pub(super) fn make_room(&mut self, new: usize) {
        let team = self.team();
        let store = &mut self.context.store;
        // Threads and parts take ids in whole blocks, and some take more blocks than others.
        let slack = ID_BLOCK * (self.states.len() + 2 * MOST_PARTS);
        let vertices = 2 * new + slack;
        let tets = TETS_A_VERTEX * new + store.tet_bound() / 4 + slack;
        let room = store.room();
        let most = self.expected.min(self.max_vertices as f64);
        let expected = [most, USUAL_TETS * most].map(|count| (SPARE * count) as usize);
        if (room.0 < vertices || room.1 < tets) && !store.reserve(team, [vertices, tets], expected) {
            // Without memory the mesh stays as large as it is.
            self.growth_end.get_or_insert(GrowthEnd::Memory);
        }
        if new == 0 {
            return;
        }
        // Nearly all insertions are done while the edges are far too long, later so many as the metric asks for.
        let vertices = self.expected.min((self.live() + new) as f64);
        self.context.store.map_pages(self.team(), vertices as usize, (USUAL_TETS * vertices) as usize);
    }

    /// Whether input and metric account for so many vertices: what is quickly known is asked first.
    fn is_accounted_for(&mut self, vertices: usize) -> bool {
        let always = self.always_allowed();
        let most = |asked: f64| always + MOST_A_COMPLEXITY * asked;
        let vertices = vertices as f64;
        if vertices > most(self.asked) {
            self.asked = self.asked.max(self.complexity(1));
        }
        if vertices > most(self.asked) {
            self.asked = self.asked.max(self.full_complexity());
        }
        vertices <= most(self.asked) || vertices <= self.allowed()
    }

    /// Vertices that the mesh may have whatever its metric.
    fn always_allowed(&self) -> f64 {
        let for_the_surface = if self.surface.is_some() { FOR_THE_SURFACE } else { 0.0 };
        ALWAYS_ALLOWED + for_the_surface + 2.0 * self.input as f64
    }

    /// Vertices that the mesh may have, by all that is known of the metric.
    fn allowed(&self) -> f64 {
        self.always_allowed() + MOST_A_COMPLEXITY * self.asked + (MOST_AN_AREA * self.area()).min(FOR_THE_SURFACE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use crate::tasks::Team;
    use std::hint::black_box;

    /// Whether a cube of 22 000 vertices may grow from a mesh of so many, for a metric of this size.
    fn may_grow(size: f64, input: usize) -> bool {
        let sample = sample(Shape::Cube, 27, size);
        let mut bench = Bench::new(&sample, 1, 3);
        bench.with_pipeline(|pipeline| {
            pipeline.input = input;
            assert_eq!(pipeline.live(), 28 * 28 * 28);
            let may = pipeline.may_grow();
            let before = pipeline.live();
            pipeline.split();
            assert_eq!(pipeline.live() > before, may);
            may
        })
    }

    #[test]
    fn a_mesh_that_its_metric_does_not_account_for_stops_growing() {
        assert!(!may_grow(0.5, 100));
        // Twice its input it may have in any case, and as much as the metric asks for.
        assert!(may_grow(0.1, 28 * 28 * 28));
        assert!(may_grow(0.03, 100));
    }

    #[test]
    fn a_mesh_has_no_more_vertices_than_it_may_have() {
        let sample = sample(Shape::Cube, 5, 0.05);
        let mut bench = Bench::new(&sample, 1, 3);
        bench.with_pipeline(|pipeline| {
            pipeline.max_vertices = 2000;
            pipeline.run();
            assert!((1990..=2000).contains(&pipeline.live()), "{}", pipeline.live());
            assert_eq!(pipeline.growth_end, Some(GrowthEnd::MaxVertices));
        });
        bench.check("as many vertices as may be");
    }

    #[test]
    fn a_metric_that_asks_for_far_more_than_may_be_is_not_met() {
        let sample = sample(Shape::Cube, 5, 0.2);
        let mut bench = Bench::new(&sample, 1, 3);
        bench.with_pipeline(|pipeline| {
            // It has 216.
            pipeline.max_vertices = 300;
            let mut ends = |is_limited, expected| {
                (pipeline.is_limited, pipeline.expected, pipeline.growth_end) = (is_limited, expected, None);
                pipeline.note_limit();
                pipeline.growth_end
            };
            assert_eq!(ends(true, 1.2 * 300.0), None);
            assert_eq!(ends(true, 1.3 * 300.0), Some(GrowthEnd::MaxVertices));
            assert_eq!(ends(false, 1.3 * 300.0), None);
        });
    }

    #[test]
    fn without_memory_a_store_stays_as_it_is() {
        let sample = sample(Shape::Cube, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        let room = bench.context.store.room();
        assert!(!bench.context.store.reserve(Team::alone(), [1 << 42, 1000], [0; 2]));
        assert!(!bench.context.store.reserve(Team::alone(), [0, 1 << 42], [0; 2]));
        assert_eq!(bench.context.store.room(), room);
        bench.check("a reserve without memory");
        assert!(bench.context.store.reserve(Team::alone(), [1 << 16, 1 << 16], [0; 2]));
    }

    #[test]
    fn a_store_that_grows_gets_room_for_what_is_expected() {
        let sample = sample(Shape::Cube, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        let store = &mut bench.context.store;
        let expected = [1_000_000, 6_000_000];
        assert!(store.reserve(Team::alone(), [1 << 17, 1 << 20], expected));
        let room = store.room();
        assert!(room.0 + store.vertex_bound() >= expected[0] && room.1 + store.tet_bound() >= expected[1], "{room:?}");
        bench.check("a reserve for what is expected");
    }

    #[test]
    fn where_there_is_no_memory_for_much_a_store_grows_by_what_is_needed() {
        // The largest array of records of a vertex, 128 bytes each, to a power of two.
        let fits = |count: usize| black_box(bytemuck::allocation::try_zeroed_vec::<[u64; 16]>(count)).is_ok();
        let mut most = 1 << 20;
        while fits(2 * most) {
            most *= 2;
        }
        let sample = sample(Shape::Cube, 2, 0.5);
        let mut bench = Bench::new(&sample, 1, 3);
        assert!(bench.context.store.reserve(Team::alone(), [most / 2, 1 << 16], [0; 2]));
        assert!(bench.context.store.room().0 >= most / 2);
        bench.check("a reserve with little memory");
    }
}
