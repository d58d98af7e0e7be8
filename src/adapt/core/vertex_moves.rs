//! The only places where a vertex gets a position: a new one, a tentative move that a commit completes, a move within its ball.
//!
//! A required or frozen vertex does not move, whoever asks.
use super::access::Access;
use super::ids::{TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::predicate::is_positive;
use crate::mesh::vector::{Vec3, sub};
use crate::metric::Sym3;

/// A point with its place on the model.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Position.
    pub point: Vec3,
    /// Entity.
    pub entity: Entity,
    /// Parameters on it.
    pub parameters: [f64; 2],
}

/// All that a vertex has besides its tetrahedra.
#[derive(Clone, Copy)]
pub struct VertexState {
    /// Point and entity.
    pub placed: Placed,
    /// ln M.
    pub log: Sym3,
    /// M.
    pub metric: Sym3,
    /// Background tetrahedron.
    pub hint: u32,
}

/// After a move longer than this, in the metric, flips and collapses look at the tetrahedra again.
const FAR: f64 = 0.05;

impl<A: Access> Worker<'_, '_, A> {
    /// What a claimed vertex is.
    pub fn vertex_state(&self, v: VertexId) -> VertexState {
        VertexState {
            placed: Placed {
                point: self.store.position(v),
                entity: self.store.entity(v),
                parameters: self.store.parameters(v),
            },
            log: self.store.log(v),
            metric: self.store.metric(v),
            hint: self.store.hint(v),
        }
    }

    /// What a vertex would be at a place, with the metric there; the search for it begins at `hint`.
    pub fn state_at(&self, placed: Placed, mut hint: u32) -> VertexState {
        let log = self.context.log_at(placed.point, &mut hint);
        VertexState { placed, log, metric: log.exp(), hint }
    }

    fn write_vertex(&self, v: VertexId, state: &VertexState) {
        self.store.set_position(v, state.placed.point);
        self.store.set_metric(v, &state.log, &state.metric);
        self.store.set_place(v, state.placed.entity, state.placed.parameters);
        self.store.set_hint(v, state.hint);
    }

    /// Makes a vertex, claims it, and calls `join`, which connects it to the mesh. Where that is refused, the id is given back.
    ///
    /// # Errors
    /// `Full` when there is no id left, else the refusal of `join`.
    pub fn with_new_vertex(
        &mut self,
        state: &VertexState,
        join: impl FnOnce(&mut Self, VertexId) -> Result<(), Refusal>,
    ) -> Result<VertexId, Refusal> {
        let v = self.state.id_pool.vertex(self.store)?;
        self.access.adopt(self.store, v).inspect_err(|_| self.state.id_pool.free_vertex(v))?;
        self.write_vertex(v, state);
        match join(self, v) {
            Ok(()) => Ok(v),
            Err(refusal) => {
                self.state.id_pool.free_vertex(v);
                Err(refusal)
            }
        }
    }

    /// Moves a claimed vertex, then calls `make_valid`. Where that is refused, the vertex goes back.
    /// Until then its tetrahedra may be inverted, so `make_valid` has to replace all of them in one commit, which then knows that their
    /// triangles on the boundary have moved.
    ///
    /// # Errors
    /// `Geometry` when the vertex must not move, else the refusal of `make_valid`.
    pub fn with_vertex_at(
        &mut self,
        v: VertexId,
        to: &VertexState,
        make_valid: impl FnOnce(&mut Self) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        self.context.required.check_move(v)?;
        let before = self.vertex_state(v);
        self.write_vertex(v, to);
        self.state.surface_change.moving = Some(v);
        let result = make_valid(self).inspect_err(|_| self.write_vertex(v, &before));
        self.state.surface_change.moving = None;
        result
    }

    /// Moves a vertex whose ball is claimed to a place where all its tetrahedra are positive; `ratios` are their mean ratios there. `is_fair`
    /// judges the mesh with the vertex there; where it says no, the vertex goes back.
    ///
    /// # Errors
    /// `Geometry` when the vertex must not move, `Normal` when it was not fair, `Crossing` when the boundary would pass through itself.
    pub fn move_in_ball(
        &mut self,
        v: VertexId,
        to: &VertexState,
        ball: &[TetId],
        ratios: impl Iterator<Item = f64>,
        is_fair: impl FnOnce(&mut Self) -> bool,
    ) -> Result<(), Refusal> {
        let before = self.vertex_state(v);
        self.move_unmeasured(v, to, ball, is_fair)?;
        let way = sub(to.placed.point, before.placed.point);
        let far = before.metric.quadratic(way) > FAR * FAR;
        for (&t, ratio) in ball.iter().zip(ratios) {
            self.store.set_quality(t, ratio);
            // After a small move only smoothing looks at the tetrahedron again.
            if far { self.store.touch(t) } else { self.store.touch_moved(t) }
        }
        Ok(())
    }

    /// As [`Worker::move_in_ball`], where the mean ratios are not known yet.
    ///
    /// # Errors
    /// Those of [`Worker::move_in_ball`].
    pub fn move_unmeasured(
        &mut self,
        v: VertexId,
        to: &VertexState,
        ball: &[TetId],
        is_fair: impl FnOnce(&mut Self) -> bool,
    ) -> Result<(), Refusal> {
        self.with_vertex_at(
            v,
            to,
            |worker| if is_fair(worker) { worker.keep_apart(v, ball) } else { Err(Refusal::Normal) },
        )
    }

    /// Measures tetrahedra again after their vertices have moved, and stamps them so that all operations look at them.
    pub fn remeasure(&mut self, tets: &[TetId]) {
        for &t in tets {
            self.store.set_quality(t, self.shape(self.store.vertices(t)));
            self.store.touch(t);
        }
    }

    /// Whether all tetrahedra of a vertex' ball would be positive with it at the point: exact.
    pub fn is_positive_at(&self, v: VertexId, point: Vec3, ball: &[TetId]) -> bool {
        ball.iter().all(|&t| {
            let corners = self.store.vertices(t).map(|x| if x == v { point } else { self.store.position(x) });
            is_positive(corners)
        })
    }
}
