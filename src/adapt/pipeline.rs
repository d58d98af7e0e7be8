//! The passes: what is done, in which order, until the mesh is a unit mesh.
use super::context::{Context, LONG, Limits};
use super::create::{self, PointCreation};
use super::criteria::Criterion;
use super::edges;
use super::ids::{EDGE, TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::Counts;
use super::schedule::{self, Collapse, Create, Mend, Operation, Project, Reconnect, Retire, Smooth, Split};
use super::shape::{is_longer, is_shorter};
use super::store::Store;
use super::worker::{ID_BLOCK, State};
use crate::mesh::vector::sub;
use crate::metric::quality::edge_length;
use crate::tasks::Pool;
use std::time::{Duration, Instant};

/// Passes at most that bring the edges to their length.
const SIZE_PASSES: usize = 20;

/// A size pass that changes less than this part of the vertices is the last.
const LITTLE: f64 = 0.05;

/// The shapes are done when a pass changes fewer than this part of the vertices.
const SETTLED: f64 = 0.01;

/// Passes at most that improve the shapes.
const SHAPE_PASSES: usize = 6;

/// Passes of the shapes after which vertices that wait for room on the model are taken out.
const PATIENCE: usize = 1;

/// Tetrahedra below this mean ratio go through the end-game.
const MEND_BELOW: f64 = 0.3;

/// Tetrahedra that an insertion adds, with much to spare: six is usual.
const TETS_A_VERTEX: usize = 12;

/// Number of kinds of operations.
pub const KINDS: usize = 6;

/// A kind of operation, for progress and report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Insertion.
    Split,
    /// Collapse.
    Collapse,
    /// Reconnection.
    Reconnect,
    /// Smoothing.
    Smooth,
    /// Projection on the model.
    Project,
    /// The end-game on the worst tetrahedra.
    Mend,
}

impl Kind {
    /// All kinds, in the order of their counters.
    pub const ALL: [Kind; KINDS] =
        [Kind::Split, Kind::Collapse, Kind::Reconnect, Kind::Smooth, Kind::Project, Kind::Mend];

    /// The name in progress and reports.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Split => "insertion",
            Kind::Collapse => "collapse",
            Kind::Reconnect => "reconnection",
            Kind::Smooth => "smoothing",
            Kind::Project => "projection",
            Kind::Mend => "mending",
        }
    }
}

/// Time and counts of one kind of operation.
#[derive(Clone, Copy, Debug, Default, serde::Serialize)]
pub struct Work {
    /// Counts over all sweeps.
    pub counts: Counts,
    /// Sweeps.
    pub sweeps: u32,
    /// Wall time.
    pub time: Duration,
}

/// Is told what happens; called from several threads.
pub trait Observer: Sync {
    /// A sweep begins.
    fn begin(&self, kind: Kind, pass: usize, items: usize);
    /// So many more items are done.
    fn advance(&self, items: usize);
    /// The sweep is over.
    fn end(&self, counts: &Counts);
    /// Whether to stop after this sweep.
    fn stop(&self) -> bool;
}

/// Limits while shapes are improved: nothing may become bad that is not.
fn shape_limits() -> Limits {
    Limits { improve_below: crate::adapt::context::env("IB", 0.9), insert_floor: 0.2, insert_loss: 1.0, ..Limits::default() }
}

/// The passes on one mesh.
pub struct Pipeline<'c, 'm> {
    /// Mesh, metric, model, limits.
    pub context: &'c mut Context<'m>,
    /// One a thread.
    pub states: Vec<State<'m>>,
    /// The threads.
    pub pool: &'c Pool,
    /// Who is told.
    pub observer: &'c dyn Observer,
    /// Criterion of the flips that follow refinement.
    pub criterion: Criterion,
    /// Where refinement puts new vertices.
    pub points: PointCreation,
    /// By kind of operation.
    pub work: [Work; KINDS],
    /// Boundary vertices that are not on the model yet.
    pub waiting: Vec<VertexId>,
    /// When each kind of operation last looked at everything, on the store's clock.
    looked: [u32; KINDS],
    pass: usize,
}

impl<'c, 'm> Pipeline<'c, 'm> {
    /// A pipeline on a filled store.
    pub fn new(
        context: &'c mut Context<'m>,
        pool: &'c Pool,
        observer: &'c dyn Observer,
        criterion: Criterion,
        waiting: Vec<VertexId>,
    ) -> Self {
        let states = (0..pool.threads()).map(|_| State::new(context)).collect();
        Self {
            context,
            states,
            pool,
            observer,
            criterion,
            points: PointCreation::default(),
            work: [Work::default(); KINDS],
            waiting,
            looked: [0; KINDS],
            pass: 0,
        }
    }

    /// Adapts the mesh: first to the sizes, then to the shapes.
    pub fn run(&mut self) {
        self.reorder();
        self.context.limits = Limits { improve_below: crate::adapt::context::env("RS", 0.4), shortest_new: crate::adapt::context::env("SN", 0.5), ..Limits::default() };
        for _ in 0..SIZE_PASSES {
            if self.size_pass() || self.observer.stop() {
                break;
            }
            self.pass += 1;
        }
        self.looked = [0; KINDS];
        self.reorder();
        for pass in 0..crate::adapt::context::env("SP", SHAPE_PASSES as f64) as usize {
            self.pass += 1;
            self.context.limits = shape_limits();
            let quiet = self.shape_pass();
            self.mend();
            self.settle(pass);
            if (quiet && self.waiting.is_empty()) || self.observer.stop() {
                break;
            }
        }
    }

    /// Puts near in memory what is near in space.
    fn reorder(&mut self) {
        self.gather_waiting();
        let number = self.context.reorder();
        self.waiting.iter_mut().for_each(|v| *v = number[v.index()]);
        self.waiting.retain(|v| v.is_some());
        self.states.iter_mut().for_each(|state| state.pool.clear());
    }

    /// One pass of insertion and collapse, with as much reconnection as they need; whether it changed little.
    fn size_pass(&mut self) -> bool {
        let before = self.changes();
        self.looked[Kind::Split as usize] = 0;
        self.refine(1);
        self.collapse(1);
        self.reconnect(self.criterion, 1);
        let b = self.context.limits.improve_below;
        self.context.limits.improve_below = crate::adapt::context::env("SS", 0.4);
        self.smooth(1);
        self.context.limits.improve_below = b;
        ((self.changes() - before) as f64) < crate::adapt::context::env("LITTLE", 0.05) * self.context.store.vertex_bound() as f64
    }

    /// One pass of all operations; whether it changed little.
    fn shape_pass(&mut self) -> bool {
        let before = self.changes();
        if let Ok(seq) = std::env::var("SEQ") {
            self.looked[Kind::Split as usize] = 0;
            for c in seq.chars() {
                match c {
                    'r' => {
                        let b = self.context.limits.improve_below;
                        self.context.limits.improve_below = crate::adapt::context::env("RR", 0.9);
                        self.reconnect(Criterion::MeanRatio, 1);
                        self.context.limits.improve_below = b;
                    }
                    's' => self.smooth(1),
                    'c' => self.collapse(1),
                    'i' => {
                        let items = self.long_edges();
                        self.sweep(Kind::Split, &Split, &items);
                        self.project();
                    }
                    _ => panic!(),
                }
            }
            return ((self.changes() - before) as f64) < crate::adapt::context::env("SETTLED", 0.01) * self.context.store.vertex_bound() as f64;
        }
        self.reconnect(Criterion::MeanRatio, 2);
        self.smooth(1);
        self.collapse(2);
        // Long edges that were refused are tried again: room may have come from farther away.
        self.looked[Kind::Split as usize] = 0;
        self.refine(2);
        self.reconnect(Criterion::MeanRatio, 1);
        self.smooth(1);
        ((self.changes() - before) as f64) < SETTLED * self.context.store.vertex_bound() as f64
    }

    /// The end-game on the tetrahedra below the limit, with edges a little longer than elsewhere allowed.
    fn mend(&mut self) {
        self.context.limits = Limits { improve_below: MEND_BELOW, longest_new: 1.3 * LONG, ..shape_limits() };
        for _ in 0..3 {
            let store = &self.context.store;
            let mut items: Vec<TetId> = store.live_tets().filter(|&t| store.quality(t) < MEND_BELOW).collect();
            items.sort_by(|&x, &y| store.quality(x).total_cmp(&store.quality(y)));
            if self.observer.stop() || self.sweep(Kind::Mend, &Mend, &items).done == 0 {
                break;
            }
            self.reconnect(Criterion::MeanRatio, 2);
        }
    }

    /// Brings waiting vertices to the model; after some passes they are taken out instead.
    fn settle(&mut self, pass: usize) {
        self.project();
        if self.waiting.is_empty() || pass < PATIENCE {
            return;
        }
        self.context.limits.collapse_floor = 0.0;
        self.context.limits.longest_new = f64::INFINITY;
        let items = std::mem::take(&mut self.waiting);
        self.sweep(Kind::Project, &Retire, &items);
        self.gather_waiting();
    }

    fn changes(&self) -> u64 {
        self.work[Kind::Split as usize].counts.done + self.work[Kind::Collapse as usize].counts.done
    }

    /// Splits long edges in so many sweeps, or until few are split.
    fn refine(&mut self, sweeps: usize) {
        if self.points == PointCreation::Centroid && self.create() {
            return;
        }
        for _ in 0..sweeps {
            let items = self.long_edges();
            if self.observer.stop() || self.sweep(Kind::Split, &Split, &items).done * 50 <= items.len() as u64 {
                break;
            }
            self.project();
            self.reconnect(self.criterion, 1);
        }
    }

    /// Refines at centroids; whether that went well, so that edges need not be split yet.
    fn create(&mut self) -> bool {
        if self.observer.stop() {
            return false;
        }
        let items = create::active_tets(self.context);
        let done = self.sweep(Kind::Split, &Create, &items).done;
        self.project();
        self.reconnect(self.criterion, 1);
        done as f64 >= LITTLE * self.context.store.vertex_bound() as f64
    }

    /// Collapses short edges in so many sweeps, or until none is collapsed.
    fn collapse(&mut self, sweeps: usize) {
        for _ in 0..sweeps {
            let items = self.short_edges();
            if self.observer.stop() || self.sweep(Kind::Collapse, &Collapse, &items).done == 0 {
                break;
            }
        }
    }

    /// Flips at the tetrahedra that changed since the last time, until little is gained.
    fn reconnect(&mut self, criterion: Criterion, sweeps: usize) {
        for _ in 0..sweeps {
            let since = self.begin(Kind::Reconnect);
            self.context.limits.since = since;
            let store = &self.context.store;
            let limit = self.context.limits.improve_below;
            let items: Vec<TetId> =
                store.live_tets().filter(|&t| store.stamp(t) >= since && store.quality(t) < limit).collect();
            if self.observer.stop() || self.sweep(Kind::Reconnect, &Reconnect(criterion), &items).done == 0 {
                break;
            }
        }
    }

    /// Smooths the vertices whose tetrahedra changed since the last time.
    fn smooth(&mut self, sweeps: usize) {
        for _ in 0..sweeps {
            let since = self.begin(Kind::Smooth);
            let limit = self.context.limits.improve_below;
            let store = &self.context.store;
            let mut changed = vec![false; store.vertex_bound()];
            for t in store.live_tets().filter(|&t| store.moved(t) >= since && store.quality(t) < limit) {
                store.vertices(t).iter().for_each(|v| changed[v.index()] = true);
            }
            let live = self.context.store.live_vertices();
            let items: Vec<VertexId> = live.filter(|v| changed[v.index()]).collect();
            if self.observer.stop() || self.sweep(Kind::Smooth, &Smooth, &items).done == 0 {
                break;
            }
        }
    }

    /// Notes that an operation looks at everything now; returns when it did so last.
    fn begin(&mut self, kind: Kind) -> u32 {
        std::mem::replace(&mut self.looked[kind as usize], self.context.store.clock() + 1)
    }

    /// For each vertex whether one of its tetrahedra changed at or after the time.
    fn changed(&self, since: u32, stamp: impl Fn(&Store, TetId) -> u32) -> Vec<bool> {
        let store = &self.context.store;
        let mut changed = vec![false; store.vertex_bound()];
        for t in store.live_tets().filter(|&t| stamp(store, t) >= since) {
            store.vertices(t).iter().for_each(|v| changed[v.index()] = true);
        }
        changed
    }

    /// Tries to bring the waiting vertices to the model.
    fn project(&mut self) {
        self.gather_waiting();
        let items = std::mem::take(&mut self.waiting);
        self.sweep(Kind::Project, &Project, &items);
        self.gather_waiting();
    }

    fn gather_waiting(&mut self) {
        for state in &mut self.states {
            self.waiting.append(&mut state.waiting);
        }
    }

    /// Makes room for so many new vertices, with the tetrahedra about them, and for what flips add.
    fn make_room(&mut self, new: usize) {
        let store = &mut self.context.store;
        let slack = ID_BLOCK * self.states.len();
        let vertices = new + slack;
        let tets = TETS_A_VERTEX * new + store.tet_bound() / 4 + slack;
        let room = store.room();
        if room.0 < vertices || room.1 < tets {
            // More than is needed, so that it is not needed again soon: untouched pages cost no memory.
            store.reserve(vertices + store.vertex_bound(), tets + store.tet_bound());
        }
    }

    /// One sweep of an operation over its items.
    fn sweep<O: Operation>(&mut self, kind: Kind, operation: &O, items: &[O::Item]) -> Counts {
        if items.is_empty() {
            return Counts::default();
        }
        self.make_room(if kind == Kind::Split { items.len() } else { 0 });
        self.context.store.tick();
        let start = Instant::now();
        self.observer.begin(kind, self.pass, items.len());
        let advance = |n: usize| self.observer.advance(n);
        let counts = schedule::run(operation, items, self.context, &mut self.states, self.pool, &advance);
        self.observer.end(&counts);
        if std::env::var_os("GEO_ADAPT_TRACE").is_some() {
            let store = &self.context.store;
            let (mut n, mut sum, mut min) = (0.0, 0.0, 1.0f64);
            for t in store.live_tets() {
                let q = store.quality(t);
                n += 1.0;
                sum += q;
                min = min.min(q);
            }
            let (mut edges, mut unit) = (0.0, 0.0);
            for t in store.live_tets() {
                let v = store.vertices(t);
                for [i, j] in EDGE {
                    let d = sub(store.position(v[j]), store.position(v[i]));
                    let l = edge_length(d, &store.metric(v[i]), &store.metric(v[j]));
                    edges += 1.0;
                    if l > 0.7071 && l < 1.41421 {
                        unit += 1.0;
                    }
                }
            }
            eprintln!("      tets {n} mean {:.4} least {min:.4} unit {:.2}", sum / n, 100.0 * unit / edges);
        }
        let work = &mut self.work[kind as usize];
        work.counts.add(&counts);
        work.sweeps += 1;
        work.time += start.elapsed();
        counts
    }

    /// Edges to be split: those of the model's edges first, then of its faces, then inside; long ones first.
    fn long_edges(&mut self) -> Vec<EdgeItem> {
        let since = self.begin(Kind::Split);
        let (store, limit) = (&self.context.store, self.context.limits.long);
        let found = edges::listed(store, &self.changed(since, Store::stamp), |a, b| is_longer(a, b, limit));
        let dimension = |item: &EdgeItem| store.dimension(item.a).max(store.dimension(item.b));
        edges::in_order(&found, |edge| (dimension(&edge.item) + 1) * edges::CLASSES - 1 - u32::from(edge.class))
    }

    /// Edges to be collapsed, short ones first.
    fn short_edges(&mut self) -> Vec<EdgeItem> {
        let since = self.begin(Kind::Collapse);
        let (store, limit) = (&self.context.store, self.context.limits.short);
        let found = edges::listed(store, &self.changed(since, Store::stamp), |a, b| is_shorter(a, b, limit));
        edges::in_order(&found, |edge| u32::from(edge.class))
    }
}
