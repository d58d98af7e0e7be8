//! Projection of boundary vertices for which there was no room on the model when they were made.
use super::collapse::onto_end::CollapseScratch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::vertex_moves::{Placed, VertexState};
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::mesh::vector::{Vec3, distance, lerp, norm};

/// Halvings of the way to the model within one attempt.
const HALVINGS: u32 = 5;

/// A vertex nearer to its entity than this share of its distance from the origin is on it: projections round by as much.
const ARRIVED: f64 = 1e-15;

/// Removes boundary vertices that never arrived on the model. The items are what a sweep of [`Project`] just before has left over, so no
/// id stands for another vertex by now.
pub struct RemoveUnprojected;

impl Operation for RemoveUnprojected {
    type Item = VertexId;
    type Scratch = CollapseScratch;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut CollapseScratch,
        item: VertexId,
    ) -> Result<(), Refusal> {
        let result = worker.claim_live(item).and_then(|()| worker.remove(scratch, item, 0.0));
        if result.is_err_and(|refusal| !matches!(refusal, Refusal::Conflict | Refusal::Stale)) {
            worker.state.unprojected.push(item);
        }
        result
    }
}

/// Moves boundary vertices that are not on the model there.
pub struct Project;

impl Operation for Project {
    type Item = VertexId;
    type Scratch = ();
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: VertexId,
    ) -> Result<(), Refusal> {
        let result = worker.project(item);
        if result.is_err_and(|refusal| !matches!(refusal, Refusal::Conflict | Refusal::Stale)) {
            worker.state.unprojected.push(item);
        }
        result
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Moves an unprojected vertex to the closest point of its entity, with a cavity that grows where it must. If that fails, the vertex
    /// goes as far towards that point as no tetrahedron is inverted, by up to five halvings of the way.
    /// Refused as `Inverted` while it has not arrived; then it is tried again after reconnection.
    pub fn project(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        self.context.required.check_move(v)?;
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.project_ball(v, &ball.tets));
        self.state.ball = ball;
        result
    }

    fn project_ball(&mut self, v: VertexId, ball: &[TetId]) -> Result<(), Refusal> {
        let (start, hint) = (self.store.position(v), self.store.hint(v));
        let goal = self.place(self.store.entity(v), start, &[v]);
        if has_arrived(start, goal) {
            // Smoothing has put it on the model already, or the id belongs to another vertex now.
            return Ok(());
        }
        let to = self.state_at(goal, hint);
        let folded = self.folded_at(v, ball);
        let arrived = self.with_vertex_at(v, &to, |worker| {
            worker.build_star(Seed::Vertex(v), v, ball, Bounds::default())?;
            worker.state.replacement.keeps_surface = true;
            if worker.folded_of_star() > folded { Err(Refusal::Normal) } else { worker.commit() }
        });
        match arrived {
            Err(Refusal::Conflict) | Ok(()) => arrived,
            Err(_) => self.approach(v, ball, (goal, folded)),
        }
    }

    /// How many surface triangles at a vertex are folded: 0 unless the mesh is a part of a larger one, where there must never be more. A part
    /// does not see what is beyond its cuts, and surfaces of two parts that share a rim do not cross as long as neither folds.
    fn folded_at(&mut self, v: VertexId, ball: &[TetId]) -> usize {
        if !self.context.required.is_part() {
            return 0;
        }
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, ball, &mut triangles);
        let folded = self.folded(&triangles);
        self.state.star.surface = triangles;
        folded
    }

    /// The same of the triangles that come with `state.replacement`.
    fn folded_of_star(&mut self) -> usize {
        if !self.context.required.is_part() {
            return 0;
        }
        let triangles = std::mem::take(&mut self.state.replacement.faces);
        let folded = self.folded(&triangles);
        self.state.replacement.faces = triangles;
        folded
    }

    fn approach(&mut self, v: VertexId, ball: &[TetId], (goal, folded): (Placed, usize)) -> Result<(), Refusal> {
        let VertexState { placed, hint, .. } = self.vertex_state(v);
        let mut step = 0.5;
        for _ in 0..HALVINGS {
            let point = lerp(placed.point, goal.point, step);
            if self.is_positive_at(v, point, ball) {
                let to = self.state_at(Placed { point, ..placed }, hint);
                match self.move_unmeasured(v, &to, ball, |worker| worker.folded_at(v, ball) <= folded) {
                    Ok(()) => break,
                    // Nearer to where it was it may keep out of what is across a void.
                    Err(Refusal::Crossing | Refusal::Normal) => {}
                    Err(refusal) => return Err(refusal),
                }
            }
            step *= 0.5;
        }
        self.remeasure(ball);
        Err(Refusal::Inverted)
    }
}

fn has_arrived(point: Vec3, goal: Placed) -> bool {
    distance(point, goal.point) <= ARRIVED * norm(point)
}
