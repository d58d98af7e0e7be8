//! Boundary vertices that could not be put on the model when they were made go there once there is room.
use super::access::Access;
use super::ids::VertexId;
use super::outcome::Refusal;
use super::worker::Worker;
use crate::mesh::vector::{distance, lerp};

/// Halvings of the way to the model within one attempt.
const HALVINGS: u32 = 5;

impl<A: Access> Worker<'_, '_, A> {
    /// Moves a waiting vertex towards the closest point of its entity: all the way if no tetrahedron inverts, else half of it,
    /// up to five halvings. Refused as `Inverted` while it has not arrived: to be tried again after reconnection.
    pub fn project(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        self.gather_ball(v)?;
        let ball = std::mem::take(&mut self.state.ball);
        let start = self.store.position(v);
        let (entity, hint) = (self.store.entity(v), self.store.hint(v));
        let goal = self.place(entity, start, &[v]);
        let mut step = 1.0;
        let mut arrived = false;
        for _ in 0..=HALVINGS {
            let point = if step == 1.0 { goal.point } else { lerp(start, goal.point, step) };
            self.store.set_position(v, point);
            if ball.iter().all(|&t| self.positive(self.store.vertices(t))) {
                self.set_point(v, point, hint);
                self.store.set_place(v, entity, goal.parameters);
                arrived = step == 1.0;
                break;
            }
            self.store.set_position(v, start);
            step *= 0.5;
        }
        for &t in &ball {
            self.store.set_quality(t, self.shape(self.store.vertices(t)));
            self.store.touch(t);
        }
        self.state.ball = ball;
        if arrived || distance(self.store.position(v), goal.point) == 0.0 { Ok(()) } else { Err(Refusal::Inverted) }
    }
}
