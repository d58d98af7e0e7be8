//! The passes: what is done, in which order, until the mesh is a unit mesh.
mod curvature;
mod effort;
mod forecast;
mod growth;
mod refinement;
mod repair;
mod stages;
mod surface_bounds;
mod thinning;
mod voids;

pub use effort::Effort;
pub use growth::GrowthEnd;

use crate::adapt::core::context::{Context, Limits};
use crate::adapt::core::edge_list;
use crate::adapt::core::edge_list::{EdgeItem, Wanted};
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::{Counts, Refusal};
use crate::adapt::core::store::Store;
use crate::adapt::core::worker::State;
use crate::adapt::operations::collapse::onto_end::Collapse;
use crate::adapt::operations::insertion::centroid::PointCreation;
use crate::adapt::operations::projection::{Project, RemoveUnprojected};
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::reconnection::sweep::Reconnect;
use crate::adapt::operations::smoothing::vertex::Smooth;
use crate::adapt::schedule::work::{KINDS, Kind, Observer, Work};
use crate::adapt::schedule::{self, Execution, Operation};
use crate::adapt::surface::bounds::SurfaceBounds;
use crate::tasks::{GRAIN, Team, section};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Instant;

/// Most passes for the sizes.
const SIZE_PASSES: usize = 20;

/// With this share of the vertices that are expected a mesh has nearly all.
const NEARLY_ALL: f64 = 0.9;

/// Where less than this share of the insertions was done, most were refused.
const MOSTLY_REFUSED: f64 = 0.25;

/// Most passes for the shapes.
const SHAPE_PASSES: usize = 6;

/// After so many shape passes, vertices that are still unprojected are removed.
const PATIENCE: usize = 1;

/// Most tetrahedra of a cavity from then on: inner vertices that are in the way to the model go.
const LARGE_CAVITY: usize = 4096;

/// After so many shape passes unprojected vertices are removed at any price.
const LAST_RESORT: usize = 3;

/// The store is renumbered before insertions, and after stages, when it has grown by this factor.
const OUT_OF_ORDER: f64 = 2.0;

/// The store is renumbered before the passes for the shapes when it has grown by this factor.
const OUT_OF_PLACE: f64 = 1.2;

/// The power of [`Limits::short_for_long`] in the size passes. With a greater one the short edges are collapsed again at great cost; with a
/// lesser one, very long edges stay beside coarse boundaries.
const SHORT_FOR_LONG: f64 = 0.7;

/// Limits of the size passes: only what is bad is flipped and smoothed.
fn size_limits() -> Limits {
    Limits {
        improve_below: 0.4,
        flip_below: 0.7,
        short: 0.65,
        shortest_new: 0.75,
        short_for_long: SHORT_FOR_LONG,
        long_first: true,
        several_below: 0.0,
        ..Limits::default()
    }
}

/// Limits of the shape passes: nothing may become bad that is not bad already, and no new edge is much farther from unit length than the one
/// that is split.
fn shape_limits() -> Limits {
    Limits {
        improve_below: 0.9,
        flip_below: 0.82,
        short: 0.75,
        shortest_new: 0.65,
        short_for_long: 1.0,
        insert_floor: 0.2,
        insert_loss: 1.0,
        ..Limits::default()
    }
}

/// The passes on one mesh.
pub struct Pipeline<'c, 'm> {
    /// Mesh, metric, model, limits.
    pub context: &'c mut Context<'m>,
    /// One a thread.
    pub states: Vec<State<'m>>,
    /// The threads.
    pub execution: Execution<'c>,
    /// Is told of the progress.
    pub observer: &'c dyn Observer,
    /// Criterion of the flips that follow refinement.
    pub criterion: Criterion,
    /// Where refinement puts new vertices.
    pub points: PointCreation,
    /// Whether the mesh was coarsened, so that it may still have too many vertices.
    pub crowded: bool,
    /// How far surface triangles may deviate from the model.
    pub surface: SurfaceBounds,
    /// Times and counts, by kind of operation.
    pub work: [Work; KINDS],
    /// Boundary vertices that are not on the model yet.
    pub unprojected: Vec<VertexId>,
    /// When each kind of operation last looked at everything, on the store's clock.
    looked: [u32; KINDS],
    pass: usize,
    /// Vertices of the mesh that was given.
    input: usize,
    /// Why nothing is inserted any more, before the metric was met.
    pub growth_end: Option<GrowthEnd>,
    /// Most vertices.
    pub max_vertices: usize,
    /// How much they do.
    pub effort: Effort,
    /// Whether the last sweep that was to add vertices could not add all, since there would be too many.
    is_limited: bool,
    /// Complexity that the metric is known to ask for.
    asked: f64,
    /// Complexity of the source on the mesh that was given.
    complexity_given: f64,
    /// Vertices that the metric asks for, as far as is known.
    expected: f64,
    /// The share of the tetrahedra that repair may try.
    repair_share: f64,
    /// Tetrahedra that it tried.
    repaired: usize,
    /// Tetrahedra that it left untried, since there were too many.
    pub unrepaired: usize,
    /// Whether a tetrahedron was left at a vertex that has gone: nothing is done any more.
    pub torn: bool,
    /// Tetrahedra when the store was last renumbered.
    ordered: usize,
    /// When the narrow voids were last looked for.
    voids: voids::Known,
}

impl<'c, 'm> Pipeline<'c, 'm> {
    /// A pipeline on a filled store.
    pub fn new(
        context: &'c mut Context<'m>,
        execution: Execution<'c>,
        observer: &'c dyn Observer,
        criterion: Criterion,
        unprojected: Vec<VertexId>,
    ) -> Self {
        let (input, ordered) = (context.store.vertex_bound(), context.store.tet_bound());
        let states = (0..execution.pool.threads()).map(|_| State::new(context)).collect();
        Self {
            context,
            states,
            execution,
            observer,
            criterion,
            points: PointCreation::default(),
            crowded: false,
            surface: SurfaceBounds::default(),
            work: [Work::default(); KINDS],
            unprojected,
            looked: [0; KINDS],
            pass: 0,
            input,
            growth_end: None,
            max_vertices: usize::MAX,
            effort: Effort::FULL,
            is_limited: false,
            expected: 0.0,
            complexity_given: 0.0,
            asked: 0.0,
            repair_share: repair::REPAIR_SHARE,
            repaired: 0,
            unrepaired: 0,
            torn: false,
            ordered,
            voids: voids::Known::default(),
        }
    }

    /// Adapts the mesh: first to the sizes, then to the shapes.
    pub fn run(&mut self) {
        self.limit(Limits { waits: self.effort.waits, ..size_limits() });
        self.observer.vertices(self.live());
        self.forecast();
        if self.crowded {
            self.thin();
        }
        if self.effort.stages {
            self.thin_askew();
            self.come_near();
        }
        for _ in 0..SIZE_PASSES {
            if self.size_pass() || self.growth_end.is_some() || self.observer.stop() {
                break;
            }
            self.pass += 1;
            self.tell_share_of_sizes();
        }
        if self.observer.stop() {
            return;
        }
        self.looked = [0; KINDS];
        self.keep_order(OUT_OF_PLACE);
        self.limit(shape_limits());
        self.reconnect(Criterion::MeanRatio, 1);
        self.smooth();
        let mut before = self.cost();
        if !self.effort.shapes {
            self.project();
        }
        for pass in 0..SHAPE_PASSES {
            if !self.effort.shapes && self.unprojected.is_empty() {
                break;
            }
            self.pass += 1;
            self.limit(shape_limits());
            self.shape_pass();
            if self.effort.repairs {
                self.repair();
            }
            let moved = self.settle(pass);
            let after = self.cost();
            // What came onto the model late has not been looked at since.
            let settled = !moved && before - after < self.effort.settled * before;
            if (settled && self.unprojected.is_empty()) || self.observer.stop() {
                break;
            }
            before = after;
            self.tell_share_of_shapes(pass);
        }
        self.note_limit();
    }

    /// The threads, for lists.
    fn team(&self) -> Team<'c> {
        Team::new(self.execution.pool, self.execution.plan)
    }

    /// The tetrahedra that are wanted.
    fn tets(&self, wanted: impl Fn(&Store, TetId) -> bool + Sync) -> Vec<TetId> {
        let store = &self.context.store;
        self.team().collect(GRAIN, store.tet_bound(), |range, found| {
            found.extend(store.live_tets_in(range).filter(|&t| wanted(store, t)));
        })
    }

    /// The vertices that are wanted.
    fn vertices(&self, wanted: impl Fn(&Store, VertexId) -> bool + Sync) -> Vec<VertexId> {
        let store = &self.context.store;
        self.team().collect(GRAIN, store.vertex_bound(), |range, found| {
            found.extend(store.live_vertices_in(range).filter(|&v| wanted(store, v)));
        })
    }

    /// Mean of 1/Q − 1 over the tetrahedra: what is left to improve.
    fn cost(&self) -> f64 {
        let store = &self.context.store;
        let parts = self.team().chunks(GRAIN, store.tet_bound(), |range| {
            let costs = store.live_tets_in(range).map(|t| 1.0 / store.quality(t).max(1e-3) - 1.0);
            costs.fold((0.0, 0.0), |(sum, count), cost| (sum + cost, count + 1.0))
        });
        let (sum, count) = parts.into_iter().fold((0.0, 0.0), |all, part| (all.0 + part.0, all.1 + part.1));
        sum / count
    }

    /// Renumbers the store, if it has grown by more than this factor since it was last renumbered.
    fn keep_order(&mut self, factor: f64) {
        if self.context.store.tet_bound() as f64 > factor * self.ordered as f64 {
            self.reorder();
        }
    }

    /// Renumbers the store, so that what is near in space is near in memory.
    fn reorder(&mut self) {
        self.collect_unprojected();
        let Ok(number) = self.context.reorder(self.team()) else {
            self.torn = true;
            return;
        };
        self.unprojected.iter_mut().for_each(|v| *v = number[v.index()]);
        self.unprojected.retain(|v| v.is_some());
        self.states.iter_mut().for_each(|state| state.id_pool.clear());
        self.ordered = self.context.store.tet_bound();
    }

    /// One pass of insertion and collapse, with the reconnection that they need. Returns whether it changed little.
    fn size_pass(&mut self) -> bool {
        let (before, insertions) = (self.changes(), self.insertions());
        self.refine();
        self.collapse();
        self.reconnect(self.criterion, 1);
        let (changes, live) = (self.changes() - before, self.live() as f64);
        let [tried, done] = [0, 1].map(|i| (self.insertions()[i] - insertions[i]) as f64);
        let is_crowded = live > NEARLY_ALL * self.expected && done < MOSTLY_REFUSED * tried;
        let little = if is_crowded { self.effort.crowded } else { self.effort.little };
        (changes as f64) < little * live
    }

    /// One pass of all operations. Flips come after collapses and splits, where they find most; after smoothing they find next to nothing.
    fn shape_pass(&mut self) {
        self.collapse();
        // Long edges that were refused are tried again: room may have come from farther away.
        self.looked[Kind::Split as usize] = 0;
        self.split();
        self.split_deviating();
        self.reconnect(Criterion::MeanRatio, 1);
        self.smooth();
    }

    /// Brings unprojected vertices to the model; after some passes they are removed instead. Returns whether there are fewer now.
    fn settle(&mut self, pass: usize) -> bool {
        if pass >= PATIENCE {
            self.context.limits.cavity = LARGE_CAVITY;
        }
        self.collect_unprojected();
        let before = self.unprojected.len();
        self.project();
        if !self.unprojected.is_empty() && pass >= PATIENCE {
            self.remove_unprojected(pass >= LAST_RESORT);
        }
        self.unprojected.len() < before
    }

    /// Takes out the vertices that found no room on the model: where the surface becomes no worse, or at any price; where one cannot go, then a
    /// neighbour on the surface does. Those that are left are projected again, since there may be room now. In a part of a larger mesh the
    /// surface does not fold all the same: it may pass through what is beyond the cuts.
    fn remove_unprojected(&mut self, at_any_price: bool) {
        let limits = self.context.limits;
        self.context.limits = Limits { collapse_floor: 0.0, longest_new: f64::INFINITY, ball: usize::MAX, ..limits };
        if at_any_price {
            // A coarse surface can be refined again, one beside the model stays there.
            self.context.limits = Limits {
                cos_deviation: if self.context.required.is_part() { 0.0 } else { -1.0 },
                cos_variation: -1.0,
                chord: f64::INFINITY,
                rise: f64::INFINITY,
                ..self.context.limits
            };
        }
        let items = std::mem::take(&mut self.unprojected);
        self.sweep(Kind::Project, &RemoveUnprojected { or_neighbour: at_any_price }, &items);
        self.context.limits = limits;
        self.project();
    }

    /// Whether so many changes are few for a mesh of this size.
    fn is_little(&self, changes: u64) -> bool {
        (changes as f64) < self.effort.little * self.live() as f64
    }

    /// Insertions that were tried, each once, and that were done.
    fn insertions(&self) -> [u64; 2] {
        let counts = &self.work[Kind::Split as usize].counts;
        [counts.attempts - counts.refused[Refusal::Conflict as usize], counts.done]
    }

    fn changes(&self) -> u64 {
        self.work[Kind::Split as usize].counts.done + self.work[Kind::Collapse as usize].counts.done
    }

    /// Collapses short edges.
    fn collapse(&mut self) {
        let items = self.short_edges();
        if !self.observer.stop() {
            self.sweep(Kind::Collapse, &Collapse, &items);
        }
    }

    /// Flips at the tetrahedra that changed since flips last looked, until little is gained.
    fn reconnect(&mut self, criterion: Criterion, sweeps: usize) {
        for _ in 0..sweeps {
            let since = self.begin(Kind::Reconnect);
            self.context.limits.since = since;
            let limit = self.context.limits.flip_below;
            let items = self.tets(|store, t| store.stamp(t) >= since && store.quality(t) < limit);
            if self.observer.stop() || self.sweep(Kind::Reconnect, &Reconnect(criterion), &items).done == 0 {
                break;
            }
        }
    }

    /// Smooths the vertices of tetrahedra that are to be improved and changed since the last time.
    fn smooth(&mut self) {
        let since = self.begin(Kind::Smooth);
        let limit = self.context.limits.improve_below;
        let changed = self.at_tets(|store, t| store.moved(t) >= since && store.quality(t) < limit);
        let items = self.vertices(|_, v| changed[v.index()].load(Relaxed));
        if !self.observer.stop() {
            self.sweep(Kind::Smooth, &Smooth, &items);
        }
    }

    /// Notes that a kind of operation looks at everything now. Returns when it did so last.
    fn begin(&mut self, kind: Kind) -> u32 {
        std::mem::replace(&mut self.looked[kind as usize], self.context.store.clock() + 1)
    }

    /// For each vertex whether one of its tetrahedra is wanted.
    fn at_tets(&self, wanted: impl Fn(&Store, TetId) -> bool + Sync) -> Vec<AtomicBool> {
        let store = &self.context.store;
        let at: Vec<AtomicBool> = bytemuck::allocation::zeroed_vec(store.vertex_bound());
        self.team().for_each(GRAIN, store.tet_bound(), |range| {
            for t in store.live_tets_in(range).filter(|&t| wanted(store, t)) {
                store.vertices(t).iter().for_each(|v| at[v.index()].store(true, Relaxed));
            }
        });
        at
    }

    /// Tries to bring the unprojected vertices to the model.
    fn project(&mut self) {
        self.collect_unprojected();
        let items = std::mem::take(&mut self.unprojected);
        self.sweep(Kind::Project, &Project, &items);
        self.collect_unprojected();
    }

    fn collect_unprojected(&mut self) {
        for state in &mut self.states {
            self.unprojected.append(&mut state.unprojected);
        }
    }

    /// One sweep of an operation over its items.
    fn sweep<O: Operation>(&mut self, kind: Kind, operation: &O, items: &[O::Item]) -> Counts {
        if items.is_empty() || self.torn {
            return Counts::default();
        }
        self.make_room(if kind == Kind::Split { items.len() } else { 0 });
        self.context.store.tick();
        let start = Instant::now();
        section(Some(kind.name()));
        self.find_voids();
        self.observer.begin(kind, self.pass, items.len());
        let advance = |n: usize| {
            self.observer.advance(n);
            // After a stop, new boundary vertices still go onto the model: that is short, and the mesh is to be used.
            kind == Kind::Project || !self.observer.stop()
        };
        let counts = schedule::run(operation, items, self.context, &mut self.states, (self.execution, kind), &advance);
        section(None);
        self.observer.end(&counts);
        if counts.refused[Refusal::Crossing as usize] > 0 {
            // There may be room once what lies across the void has changed.
            self.looked[kind as usize] = 0;
        }
        let work = &mut self.work[kind as usize];
        work.counts.add(&counts);
        work.sweeps += 1;
        work.time += start.elapsed();
        counts
    }

    /// Edges to be collapsed, short ones first.
    fn short_edges(&mut self) -> Vec<EdgeItem> {
        let since = self.begin(Kind::Collapse);
        let (store, limit) = (&self.context.store, self.context.limits.short);
        let found = edge_list::listed(self.team(), store, since, Wanted::Shorter(limit));
        edge_list::in_order(self.team(), &found, |edge| u32::from(edge.class))
    }
}
