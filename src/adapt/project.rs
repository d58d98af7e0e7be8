//! Boundary vertices that could not be put on the model when they were made go there once there is room.
use super::access::Access;
use super::ids::{TetId, VertexId};
use super::outcome::Refusal;
use super::star::{Bounds, Seed};
use super::surface::Placed;
use super::worker::Worker;
use crate::mesh::vector::{Vec3, distance, lerp, norm};

/// Halvings of the way to the model within one attempt.
const HALVINGS: u32 = 5;

/// A vertex this near to its entity, in parts of its distance from the origin, is on it: the rounding of a projection.
const ARRIVED: f64 = 1e-15;

impl<A: Access> Worker<'_, '_, A> {
    /// Moves a waiting vertex to the closest point of its entity, its cavity growing where it must; if that fails, as far
    /// towards it as inverts no tetrahedron, by up to five halvings.
    /// Refused as `Inverted` while it has not arrived: to be tried again after reconnection.
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
            // Smoothing was here before, or the id belongs to another vertex now.
            return Ok(());
        }
        self.carry(v, ball, goal).or_else(|refusal| {
            self.set_point(v, start, hint);
            if refusal == Refusal::Conflict { Err(refusal) } else { self.approach(v, ball, goal) }
        })
    }

    /// Puts the vertex on the goal and makes its ball a star about it there.
    fn carry(&mut self, v: VertexId, ball: &[TetId], goal: Placed) -> Result<(), Refusal> {
        self.set_point(v, goal.point, self.store.hint(v));
        self.build_star(Seed::Vertex(v), v, ball, Bounds::default())?;
        self.state.replacement.keeps_surface = true;
        self.commit()?;
        self.store.set_place(v, goal.entity, goal.parameters);
        Ok(())
    }

    fn approach(&mut self, v: VertexId, ball: &[TetId], goal: Placed) -> Result<(), Refusal> {
        let (start, hint) = (self.store.position(v), self.store.hint(v));
        let mut step = 0.5;
        for _ in 0..HALVINGS {
            self.store.set_position(v, lerp(start, goal.point, step));
            if ball.iter().all(|&t| self.positive(self.store.vertices(t))) {
                self.set_point(v, self.store.position(v), hint);
                break;
            }
            self.store.set_position(v, start);
            step *= 0.5;
        }
        for &t in ball {
            self.store.set_quality(t, self.shape(self.store.vertices(t)));
            self.store.touch(t);
        }
        Err(Refusal::Inverted)
    }
}

fn has_arrived(point: Vec3, goal: Placed) -> bool {
    distance(point, goal.point) <= ARRIVED * norm(point)
}
