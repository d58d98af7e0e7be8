//! What one thread has in hand while it works: the store, its access, its pools, its scratch.
use super::access::Access;
use super::ball::Ball;
use super::commit::Replacement;
use super::context::Context;
use super::id_pool::IdPool;
use super::ids::{TetId, VertexId};
use super::refusal::Refusal;
use super::stamped::FaceMap;
use super::star::Star;
use super::store::Store;
use super::timed_evaluator::TimedEvaluator;
use crate::geometry::Geometry;
use crate::mesh::stamped_set::StampedSet;

/// What a thread keeps from sweep to sweep.
pub struct State<'m> {
    /// Its own evaluator of the model.
    pub evaluator: TimedEvaluator<'m>,
    /// Free ids.
    pub id_pool: IdPool,
    /// The replacement that is being prepared.
    pub replacement: Replacement,
    /// The star cavity that is being prepared.
    pub star: Star,
    /// Faces seen while committing.
    pub face_map: FaceMap<super::commit::FaceSlot>,
    /// A set for any use within one function.
    pub set: StampedSet,
    /// A second one: the vertices near another.
    pub near: StampedSet,
    /// The ball of a vertex.
    pub ball: Ball,
    /// A ball for use within one function.
    pub unclaimed_ball: Ball,
    /// The ring about an edge.
    pub shell: super::shell::Shell,
    /// Boundary vertices that are not yet on the model.
    pub unprojected: Vec<VertexId>,
    /// What an operation does to the boundary.
    pub surface_change: super::voids::SurfaceChange,
    /// Tetrahedra to be measured together.
    pub batch: crate::metric::batch::Batch,
}

impl<'m> State<'m> {
    /// The state of a new thread.
    pub fn new(context: &Context<'m>) -> Self {
        Self {
            evaluator: TimedEvaluator::new(context.model.evaluator()),
            id_pool: IdPool::default(),
            replacement: Replacement::default(),
            star: Star::default(),
            face_map: FaceMap::default(),
            set: StampedSet::default(),
            near: StampedSet::default(),
            ball: Ball::default(),
            unclaimed_ball: Ball::default(),
            shell: super::shell::Shell::default(),
            unprojected: Vec::new(),
            surface_change: super::voids::SurfaceChange::default(),
            batch: crate::metric::batch::Batch::default(),
        }
    }
}

/// A thread at work on a sweep.
pub struct Worker<'w, 'm, A: Access> {
    /// What all threads share.
    pub context: &'w Context<'m>,
    /// The mesh.
    pub store: &'w Store,
    /// What belongs to this thread.
    pub state: &'w mut State<'m>,
    /// How it claims vertices.
    pub access: A,
}

impl<'w, 'm, A: Access> Worker<'w, 'm, A> {
    /// A worker on the context's store.
    pub fn new(context: &'w Context<'m>, state: &'w mut State<'m>, access: A) -> Self {
        Self { context, store: &context.store, state, access }
    }

    /// Claims a vertex.
    #[inline(always)]
    pub fn claim(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.access.claim(self.store, v)
    }

    /// Claims the vertices of a tetrahedron that cannot change, since one of its vertices is held.
    #[inline(always)]
    pub fn claim_tet(&mut self, t: TetId) -> Result<[VertexId; 4], Refusal> {
        let vertices = self.store.vertices(t);
        for v in vertices {
            self.claim(v)?;
        }
        Ok(vertices)
    }

    /// Claims a tetrahedron that may be changing: its vertices are read, claimed, and read again.
    pub fn claim_current_tet(&mut self, t: TetId) -> Result<[VertexId; 4], Refusal> {
        let vertices = self.store.unlocked_vertices(t);
        for v in vertices {
            if !v.is_some() || v.index() >= self.store.vertex_bound() {
                return Err(Refusal::Stale);
            }
            self.claim(v)?;
        }
        if self.store.unlocked_vertices(t) == vertices { Ok(vertices) } else { Err(Refusal::Stale) }
    }

    /// Claims a vertex and makes sure that it is alive.
    #[inline]
    pub fn claim_live(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim(v)?;
        if self.store.is_vertex(v) { Ok(()) } else { Err(Refusal::Stale) }
    }

    /// A tetrahedron that holds both claimed vertices; stale when they are not joined by an edge.
    pub fn tet_with_edge(&mut self, a: VertexId, b: VertexId, guess: TetId) -> Result<TetId, Refusal> {
        let holds = |t: TetId| {
            // The guess may be dead or reused by now. Since a and b are held, it is right if both are in it.
            let vertices = self.store.unlocked_vertices(t);
            vertices.contains(&a) && vertices.contains(&b)
        };
        if holds(guess) {
            return Ok(guess);
        }
        self.find_tet_with(a, b).ok_or(Refusal::Stale)
    }

    /// Looks at the ball of a claimed vertex, of which no other is claimed.
    pub fn with_passing_ball<T>(&mut self, v: VertexId, look: impl FnOnce(&Ball) -> T) -> T {
        let mut ball = std::mem::take(&mut self.state.unclaimed_ball);
        self.collect_ball(v, &mut ball);
        let seen = look(&ball);
        self.state.unclaimed_ball = ball;
        seen
    }
}
