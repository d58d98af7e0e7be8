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
        let mut best: Result<(f64, VertexId), Refusal> = Err(Refusal::Shape);
        for &w in &ball.link {
            let better = best.map_or(floor, |(quality, _)| quality);
            match self.try_collapse(scratch, v, w, ball, better) {
                Ok(quality) => best = Ok((quality, w)),
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(_) => {}
            }
        }
        let (_, w) = best?;
        self.try_collapse(scratch, v, w, ball, floor)?;
        self.finish_collapse(v, w)
    }
}
