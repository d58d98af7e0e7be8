//! What benches/kernel.rs needs of the kernel's inside: a mesh in a store, single sweeps over it on one thread, single cavities.
//! No part of the interface.
use crate::adapt::core::access::{Access, Exclusive};
use crate::adapt::core::ball::Ball;
use crate::adapt::core::context::Context;
use crate::adapt::core::edge_list::{self, EdgeItem, Wanted};
use crate::adapt::core::fill::{self, Filled};
use crate::adapt::core::ids::{EDGE, TetId, VertexId};
use crate::adapt::core::refusal::{Counts, Refusal};
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::worker::{State, Worker};
use crate::adapt::operations::collapse::onto_end::Collapse;
use crate::adapt::operations::insertion::edge_split::Split;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::reconnection::ring::Ring;
use crate::adapt::operations::reconnection::sweep::Reconnect;
use crate::adapt::operations::smoothing::vertex::Smooth;
use crate::adapt::schedule::work::Kind;
use crate::adapt::schedule::{self, Execution, Grains, Operation, Scheduler};
use crate::adapt::{extract, references::References};
use crate::geometry::classify::Classification;
use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
use crate::geometry::{Discrete, Error, Geometry, Model};
use crate::mesh::TetMesh;
use crate::metric::Source;
use crate::tasks::{Plan, Pool, Team};

/// What stays while a mesh is adapted: the surface it began with, and the metric.
pub struct Domain {
    /// The surface of a mesh as a model.
    pub model: Model,
    /// The metric.
    pub source: Source,
}

/// A mesh between two steps, to begin from as often as wanted.
pub struct Snapshot {
    /// The mesh.
    pub mesh: TetMesh,
    /// Its place on the model.
    pub place: Classification,
}

/// A domain and the mesh that it is made of.
///
/// # Errors
/// When the surface of the mesh is no model.
pub fn domain(mesh: TetMesh, source: Source) -> Result<(Domain, Snapshot), Error> {
    let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE)?;
    Ok((Domain { model: Model::Discrete(model), source }, Snapshot { mesh, place }))
}

/// A sweep of one operation, under the limits that the kernel starts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// Splits the long edges.
    Split,
    /// Collapses the short edges.
    Collapse,
    /// Every tetrahedron tries to remove one of its edges.
    RemoveEdges,
    /// Every tetrahedron tries to remove one of its faces.
    RemoveFaces,
    /// Every tetrahedron tries both.
    Reconnect,
    /// Smooths every vertex.
    Smooth,
}

/// The items of a [`Sweep`].
pub enum Items {
    /// Edges in the order of the passes.
    Edges(Vec<EdgeItem>),
    /// Tetrahedra.
    Tets(Vec<TetId>),
    /// Vertices.
    Vertices(Vec<VertexId>),
}

impl Items {
    /// How many items there are.
    pub fn count(&self) -> usize {
        match self {
            Items::Edges(items) => items.len(),
            Items::Tets(items) => items.len(),
            Items::Vertices(items) => items.len(),
        }
    }
}

struct RemoveEdges;

impl Operation for RemoveEdges {
    type Item = TetId;
    type Scratch = Box<Ring>;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        ring: &mut Box<Ring>,
        t: TetId,
    ) -> Result<(), Refusal> {
        let v = worker.claim_current_tet(t)?;
        let mut tried = EDGE.iter().map(|&[i, j]| worker.remove_edge(ring, [v[i], v[j]], t, Criterion::MeanRatio));
        tried.find(Result::is_ok).unwrap_or(Err(Refusal::Shape))
    }
}

struct RemoveFaces;

impl Operation for RemoveFaces {
    type Item = TetId;
    type Scratch = ();
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(&self, worker: &mut Worker<'_, '_, A>, _: &mut (), t: TetId) -> Result<(), Refusal> {
        worker.claim_current_tet(t)?;
        let mut tried = (0..4).map(|i| worker.remove_face(t, i, Criterion::MeanRatio));
        tried.find(Result::is_ok).unwrap_or(Err(Refusal::Shape))
    }
}

/// A vertex that may go onto its neighbour.
pub struct Removal {
    vertex: VertexId,
    onto: VertexId,
    ball: Vec<TetId>,
    /// Mean ratio that its star must have.
    floor: f64,
}

/// A mesh in a store, and one thread at work on it.
pub struct Workbench<'m> {
    context: Context<'m>,
    states: Vec<State<'m>>,
    pool: Pool,
}

impl<'m> Workbench<'m> {
    /// Fills a store. Its first [`crate::adapt::core::store::ROOM`] new vertices need no growth.
    ///
    /// # Errors
    /// When the snapshot is no valid mesh.
    pub fn fill(domain: &'m Domain, from: &Snapshot) -> Result<Self, fill::Error> {
        let Filled { store, .. } = fill::fill(Team::alone(), &from.mesh, &from.place, &domain.source)?;
        let context = Context::new(store, &domain.source, &domain.model);
        let states = vec![State::new(&context)];
        let pool = Pool::new(1).expect("one thread is there already");
        Ok(Self { context, states, pool })
    }

    /// The items of a sweep in the mesh as it is.
    pub fn items(&self, sweep: Sweep) -> Items {
        let store = &self.context.store;
        match sweep {
            Sweep::Split => Items::Edges(self.long_edges()),
            Sweep::Collapse => Items::Edges(self.short_edges()),
            Sweep::Smooth => Items::Vertices(store.live_vertices().collect()),
            _ => Items::Tets(store.live_tets().collect()),
        }
    }

    /// The edges that are too long, long ones first.
    pub fn long_edges(&self) -> Vec<EdgeItem> {
        let limit = self.context.limits.long;
        let found = edge_list::listed(Team::alone(), &self.context.store, 0, Wanted::Longer(limit));
        edge_list::in_order(Team::alone(), &found, |edge| edge_list::CLASSES - 1 - u32::from(edge.class))
    }

    /// The edges that are too short, short ones first.
    pub fn short_edges(&self) -> Vec<EdgeItem> {
        let limit = self.context.limits.short;
        let found = edge_list::listed(Team::alone(), &self.context.store, 0, Wanted::Shorter(limit));
        edge_list::in_order(Team::alone(), &found, |edge| u32::from(edge.class))
    }

    /// Carries out a sweep over items that were listed for it.
    ///
    /// # Panics
    /// When the items are of another kind than the sweep's.
    pub fn sweep(&mut self, sweep: Sweep, items: &Items) -> Counts {
        self.context.store.tick();
        match (sweep, items) {
            (Sweep::Split, Items::Edges(items)) => self.run(&Split, items),
            (Sweep::Collapse, Items::Edges(items)) => self.run(&Collapse, items),
            (Sweep::RemoveEdges, Items::Tets(items)) => self.run(&RemoveEdges, items),
            (Sweep::RemoveFaces, Items::Tets(items)) => self.run(&RemoveFaces, items),
            (Sweep::Reconnect, Items::Tets(items)) => self.run(&Reconnect(Criterion::MeanRatio), items),
            (Sweep::Smooth, Items::Vertices(items)) => self.run(&Smooth, items),
            _ => panic!("{sweep:?} is done to other items"),
        }
    }

    fn run<O: Operation>(&mut self, operation: &O, items: &[O::Item]) -> Counts {
        let execution = Execution {
            pool: &self.pool,
            scheduler: Scheduler::Sequential,
            plan: Plan::default(),
            grains: Grains::default(),
        };
        schedule::run(operation, items, &self.context, &mut self.states, (execution, Kind::Split), &|_| true)
    }

    /// Lists and carries out some sweeps, one after the other.
    pub fn sweep_all(&mut self, sweeps: &[Sweep]) {
        for &sweep in sweeps {
            let items = self.items(sweep);
            self.sweep(sweep, &items);
        }
    }

    /// Renumbers the store; returns how many vertices it has then.
    pub fn reorder(&mut self) -> usize {
        // Else a store that was just renumbered would be left as it is.
        self.context.store.tick();
        self.context.reorder(Team::alone()).expect("the mesh is whole");
        self.states[0].id_pool.clear();
        self.context.store.vertex_bound()
    }

    /// Takes the mesh out of the store.
    pub fn extract(&self, from: &Snapshot) -> Snapshot {
        let topology = self.context.model.topology();
        let (faces, edges) = (topology.faces.len(), topology.edges.len());
        let refs = References { faces: vec![1; faces], inward: vec![false; faces], edges: vec![1; edges] };
        let extracted = extract::extract(Team::alone(), &self.context, &from.mesh, &refs, &[]).expect("it is whole");
        Snapshot { mesh: extracted.mesh, place: extracted.classification }
    }

    /// Vertices and tetrahedra.
    pub fn counts(&self) -> [usize; 2] {
        let store = &self.context.store;
        [store.live_vertices().count(), store.live_tets().count()]
    }

    /// Collects the balls of all vertices; returns how many tetrahedra they have.
    pub fn balls(&mut self) -> usize {
        let mut worker = Worker::new(&self.context, &mut self.states[0], Exclusive);
        let mut ball = Ball::default();
        let mut tets = 0;
        for v in worker.store.live_vertices() {
            worker.collect_ball(v, &mut ball);
            tets += ball.tets.len();
        }
        tets
    }

    /// Removals of interior vertices onto all of their neighbours: those whose star a collapse would take, and those that it would
    /// refuse for its shape or because it stays inverted.
    pub fn removals(&mut self) -> [Vec<Removal>; 2] {
        let mut worker = Worker::new(&self.context, &mut self.states[0], Exclusive);
        let mut ball = Ball::default();
        let mut found = [Vec::new(), Vec::new()];
        for vertex in worker.store.live_vertices().filter(|&v| worker.store.dimension(v) == 3) {
            worker.collect_ball(vertex, &mut ball);
            for &onto in &ball.link {
                let floor = worker.context.limits.collapse_floor.min(worker.worst_of(&ball.tets));
                let removal = Removal { vertex, onto, ball: ball.tets.clone(), floor };
                let taken = star(&mut worker, &removal).is_ok();
                found[usize::from(!taken)].push(removal);
            }
        }
        found
    }

    /// Prepares the star of each removal, without carrying it out; returns how many tetrahedra the stars would have.
    pub fn stars(&mut self, removals: &[Removal]) -> usize {
        let mut worker = Worker::new(&self.context, &mut self.states[0], Exclusive);
        let mut tets = 0;
        for removal in removals {
            if star(&mut worker, removal).is_ok() {
                tets += worker.state.replacement.new.len();
            }
        }
        tets
    }
}

fn star(worker: &mut Worker<'_, '_, Exclusive>, removal: &Removal) -> Result<f64, Refusal> {
    let bounds = Bounds { wanted: 0.0, floor: removal.floor };
    worker.build_star(Seed::Vertex(removal.vertex), removal.onto, &removal.ball, bounds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::check::check;
    use crate::mesh::samples::cube;
    use crate::metric::Analytic;

    /// The sweeps that are timed do something, and leave a valid mesh.
    #[test]
    fn every_sweep_does_something_and_leaves_a_valid_mesh() {
        let source = Source::Analytic { field: Analytic::Polar1, log_scale: -3.0 };
        let (domain, mut snapshot) = domain(cube(3), source).unwrap();
        let steps = [
            Sweep::Split,
            Sweep::Reconnect,
            Sweep::Split,
            Sweep::Collapse,
            Sweep::RemoveEdges,
            Sweep::RemoveFaces,
            Sweep::Smooth,
        ];
        for sweep in steps {
            let mut bench = Workbench::fill(&domain, &snapshot).unwrap();
            let items = bench.items(sweep);
            let counts = bench.sweep(sweep, &items);
            assert!(counts.done > 0 && counts.attempts == items.count() as u64, "{sweep:?}: {counts:?}");
            check(&bench.context).unwrap();
            let before = bench.counts();
            assert_eq!(bench.reorder(), before[0]);
            check(&bench.context).unwrap();
            snapshot = bench.extract(&snapshot);
            assert_eq!([snapshot.mesh.vertices.len(), snapshot.mesh.tets.len()], before);
        }
    }

    #[test]
    fn stars_are_looked_at_without_a_change() {
        let source = Source::Analytic { field: Analytic::Polar1, log_scale: -3.0 };
        let (domain, snapshot) = domain(cube(4), source).unwrap();
        let mut bench = Workbench::fill(&domain, &snapshot).unwrap();
        let counts = bench.counts();
        assert_eq!(bench.balls(), 4 * counts[1]);
        let [taken, refused] = bench.removals();
        assert!(bench.stars(&taken) >= taken.len() && !taken.is_empty());
        assert!(bench.stars(&refused) == 0 && !refused.is_empty());
        assert_eq!(bench.counts(), counts);
        check(&bench.context).unwrap();
    }
}
