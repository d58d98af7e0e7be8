//! Point creation along eigenvectors: a vertex with an edge that is too long proposes the points at unit distance from it, both ways along
//! each eigenvector of its metric (Loseille 2014, Metric-orthogonal anisotropic mesh generation; Marcum & Weatherill 1995 place points
//! from the faces of a front in this way).
//!
//! A candidate must lie in the ball of its vertex: beyond the ball there are nearer vertices in that direction. It is dropped when it is
//! too near to others, as in [`super::centroid`]. So of two vertices that propose the same place the first gets it.
use super::centroid::{Candidate, better, encroaches_face};
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::context::Context;
use crate::adapt::core::edge_list;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::Seed;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, add, scale, volume6};
use crate::metric::quality::edge_length;
use crate::tasks::Team;

/// Edges longer than this times the limit are split in the middle instead: a point at unit distance from one end would be far from the other.
pub const FAR: f64 = 2.0;

/// The vertices of edges that are too long: those on the model first.
pub fn active_vertices(team: Team<'_>, context: &Context<'_>) -> Vec<VertexId> {
    let (store, limit) = (&context.store, context.limits.long);
    let found = edge_list::listed(team, store, 0, edge_list::Wanted::Longer(limit));
    let mut vertices: Vec<VertexId> = found.iter().flat_map(|edge| [edge.item.a, edge.item.b]).collect();
    vertices.sort_unstable_by_key(|&v| (store.dimension(v), v));
    vertices.dedup();
    vertices
}

/// Creates points at unit distance from vertices, along the eigenvectors of their metrics.
pub struct InsertMetricOrthogonal;

impl Operation for InsertMetricOrthogonal {
    type Item = VertexId;
    type Scratch = ();
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: VertexId,
    ) -> Result<(), Refusal> {
        worker.insert_about(item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Creates points at unit distance from a vertex, both ways along each eigenvector of its metric.
    ///
    /// # Errors
    /// `Length` when no candidate lies in the vertex' ball or all are too near to other vertices, else the last candidate's refusal.
    pub fn insert_about(&mut self, v: VertexId) -> Result<(), Refusal> {
        self.claim_live(v)?;
        let mut ball = std::mem::take(&mut self.state.ball);
        let axes = self.store.log(v).eigen();
        let mut gathered = false;
        let mut result = None;
        for (value, axis) in axes.values.into_iter().zip(axes.vectors) {
            for along in [1.0, -1.0] {
                let one = self.insert_along(v, scale(axis, along * (-0.5 * value).exp()), &mut ball, &mut gathered);
                // An insertion changes the ball.
                gathered &= one.is_err();
                result = better(result, Some(one));
            }
        }
        self.state.ball = ball;
        result.unwrap_or(Err(Refusal::Stale))
    }

    /// Creates the point at unit distance from v in the direction of the step, which has about unit length.
    fn insert_along(&mut self, v: VertexId, step: Vec3, ball: &mut Ball, gathered: &mut bool) -> Result<(), Refusal> {
        if !*gathered {
            if !self.store.is_vertex(v) {
                // The cavity of the last insertion has grown over the vertex.
                return Err(Refusal::Stale);
            }
            self.gather_ball(v, ball)?;
            *gathered = true;
        }
        let (from, metric) = (self.store.position(v), self.store.metric(v));
        let mut hint = self.store.hint(v);
        let metric_at = |p: Vec3, hint: &mut u32| self.context.log_at(p, hint).exp();
        // The metric changes on the way.
        let there = metric_at(add(from, step), &mut hint);
        let point = add(from, scale(step, 1.0 / edge_length(step, &metric, &there)));
        let t = ball.tets.iter().copied().find(|&t| self.holds(t, point)).ok_or(Refusal::Length)?;
        let metric = metric_at(point, &mut hint);
        let around = [v];
        let candidate = Candidate { seed: Seed::Inside, entity: Entity::Interior, point, metric, around: &around };
        let vertices = self.store.vertices(t);
        let (points, tags) = (vertices.map(|x| self.store.position(x)), self.store.tags(t));
        let encroaches = |i: usize| tags[i] != 0 && encroaches_face(&metric, FACE[i].map(|k| points[k]), point);
        if (0..4).any(encroaches) || self.is_near_any(&candidate, &ball.link) {
            return Err(Refusal::Length);
        }
        self.insert_if_spaced(&candidate, &[t])
    }

    /// Whether the point lies in a tetrahedron, or on its boundary. All its vertices are held; the cavity grows from it.
    fn holds(&self, t: TetId, point: Vec3) -> bool {
        let corners = self.store.vertices(t).map(|x| self.store.position(x));
        FACE.iter().all(|face| {
            let [a, b, c] = face.map(|k| corners[k]);
            volume6(a, b, c, point) >= 0.0
        })
    }
}
