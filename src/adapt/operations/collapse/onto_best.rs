//! The removal of a vertex: it goes onto the neighbour that leaves the best elements.
use super::onto_end::CollapseScratch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::geometry::Entity;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a vertex onto the neighbour that leaves the best worst tetrahedron, at least `floor`.
    pub fn remove(&mut self, scratch: &mut CollapseScratch, v: VertexId, floor: f64) -> Result<(), Refusal> {
        if matches!(self.store.entity(v), Entity::Vertex(_)) {
            return Err(Refusal::Geometry);
        }
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.remove_ball(scratch, v, &ball, floor));
        self.state.ball = ball;
        result
    }

    fn remove_ball(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        ball: &Ball,
        floor: f64,
    ) -> Result<(), Refusal> {
        if ball.tets.len() > self.context.limits.ball {
            return Err(Refusal::Topology);
        }
        let (mut refused, mut result) = (Vec::new(), Err(Refusal::Shape));
        while let Some(w) = self.best_neighbour(scratch, v, ball, floor, &refused)? {
            self.try_collapse(scratch, v, w, ball, floor)?;
            result = self.finish_collapse(v, w);
            if !matches!(result, Err(Refusal::Topology | Refusal::Crossing)) {
                break;
            }
            refused.push(w);
        }
        result
    }

    /// The neighbour onto which v would go best, but for some that refused it.
    fn best_neighbour(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        ball: &Ball,
        floor: f64,
        refused: &[VertexId],
    ) -> Result<Option<VertexId>, Refusal> {
        let (mut best, mut better) = (None, floor);
        for &w in ball.link.iter().filter(|w| !refused.contains(w)) {
            match self.try_collapse(scratch, v, w, ball, better) {
                Ok(quality) => (best, better) = (Some(w), quality),
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(_) => {}
            }
        }
        Ok(best)
    }
}
