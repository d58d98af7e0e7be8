//! The end-game on the worst tetrahedra: what reconnection and smoothing left is tried with larger cavities.
use super::access::Access;
use super::ball::Ball;
use super::ids::{EDGE, TetId, VertexId};
use super::insert::EdgeItem;
use super::outcome::Refusal;
use super::star::{Bounds, Seed};
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, dot, lerp, sub};
use std::ops::RangeInclusive;

/// How much better, in part, the worst tetrahedron of a larger cavity must become.
pub const GAIN: f64 = 1.05;

/// Below this mean ratio an edge may be split for the shape alone. Where two edges of the model run side by side, nearer than the metric's
/// sizes (a blunt trailing edge), their vertices must face each other, and a vertex may be missing for that.
const SPLIT_BELOW: f64 = 0.25;

/// Where along an edge it may be split for the shape.
const BETWEEN: RangeInclusive<f64> = 0.1..=0.9;

impl<A: Access> Worker<'_, '_, A> {
    /// Mends one bad tetrahedron: one of its vertices is joined anew to a larger cavity, or removed onto any neighbour, if the
    /// worst tetrahedron becomes clearly better by it.
    pub fn mend(&mut self, t: TetId) -> Result<(), Refusal> {
        let vertices = self.claim_moving_tet(t)?;
        let quality = self.store.quality(t);
        if quality >= self.context.limits.improve_below {
            return Err(Refusal::Stale);
        }
        let floor = (GAIN * quality).max(1e-9);
        for v in vertices {
            match self.rejoin(v, floor) {
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(_) => {}
                Ok(()) => return Ok(()),
            }
        }
        for v in vertices {
            match self.remove(v, floor) {
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(_) => {}
                Ok(()) => return Ok(()),
            }
        }
        if quality < SPLIT_BELOW { self.split_facing(t, vertices) } else { Err(Refusal::Shape) }
    }

    /// Splits an edge of a tetrahedron where another of its vertices faces it, the longest for which that is possible. The limits of the
    /// end-game ask of insertion that the worst tetrahedron becomes better, and nothing of lengths.
    fn split_facing(&mut self, t: TetId, vertices: [VertexId; 4]) -> Result<(), Refusal> {
        let mut edges = EDGE.map(|[i, j]| (self.length(vertices[i], vertices[j]), i, j));
        edges.sort_by(|x, y| y.0.total_cmp(&x.0));
        for (_, i, j) in edges {
            for x in (0..4).filter(|&x| x != i && x != j) {
                let (a, b) = (vertices[i].min(vertices[j]), vertices[i].max(vertices[j]));
                let Some(facing) = self.facing_point(vertices[x], a, b) else { continue };
                match self.split_at(EdgeItem { a, b, tet: t }, facing) {
                    Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                    Err(_) => {}
                    Ok(()) => return Ok(()),
                }
            }
        }
        Err(Refusal::Shape)
    }

    /// The point of the line a–b closest to x in the metric, where it is well between them.
    fn facing_point(&self, x: VertexId, a: VertexId, b: VertexId) -> Option<Vec3> {
        let [p, q, r] = [a, b, x].map(|v| self.store.position(v));
        let (along, off) = (sub(q, p), sub(r, p));
        let metric = self.store.metric(x);
        let share = dot(metric.apply(off), along) / metric.quadratic(along);
        BETWEEN.contains(&share).then(|| lerp(p, q, share))
    }

    /// Makes the ball of a vertex a star over a cavity that grows where tetrahedra would be bad.
    fn rejoin(&mut self, v: VertexId, floor: f64) -> Result<(), Refusal> {
        let mut ball = std::mem::take(&mut self.state.ball);
        let bounds = Bounds { wanted: self.context.limits.improve_below, floor };
        let gathered = self.gather_ball(v, &mut ball);
        let result = gathered.and_then(|()| self.build_star(Seed::Vertex(v), v, &ball.tets, bounds));
        self.state.ball = ball;
        let worst = result?;
        if worst < GAIN * self.worst_old() {
            return Err(Refusal::Shape);
        }
        self.check_normals(0.0)?;
        self.state.replacement.keeps_surface = true;
        self.commit()
    }

    /// Removes a vertex onto the neighbour that leaves the best worst tetrahedron, at least `floor`.
    pub fn remove(&mut self, v: VertexId, floor: f64) -> Result<(), Refusal> {
        if matches!(self.store.entity(v), Entity::Vertex(_)) {
            return Err(Refusal::Geometry);
        }
        let mut ball = std::mem::take(&mut self.state.ball);
        let result = self.gather_ball(v, &mut ball).and_then(|()| self.remove_ball(v, &ball, floor));
        self.state.ball = ball;
        result
    }

    fn remove_ball(&mut self, v: VertexId, ball: &Ball, floor: f64) -> Result<(), Refusal> {
        let mut best: Result<(f64, VertexId), Refusal> = Err(Refusal::Shape);
        for &w in &ball.link {
            let better = best.map_or(floor, |(quality, _)| quality);
            match self.try_collapse(v, w, ball, better) {
                Ok(quality) => best = Ok((quality, w)),
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(_) => {}
            }
        }
        let (_, w) = best?;
        self.try_collapse(v, w, ball, floor)?;
        self.finish_collapse(v, w)
    }
}
