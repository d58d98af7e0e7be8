//! Splits surface triangles that deviate from the model by more than the user allows, whatever the lengths of their edges in the metric.
use crate::adapt::core::access::Access;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::mesh::vector::distance;

/// An edge is not split where an end is farther from the model than this share of its middle: the end has found no room there, nor would the
/// new vertex, and the pieces would deviate as much.
const OFF_MODEL: f64 = 0.1;

/// Splits surface triangles that deviate from the model.
pub struct SplitDeviating;

impl Operation for SplitDeviating {
    type Item = TetId;
    type Scratch = ();
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: TetId,
    ) -> Result<(), Refusal> {
        worker.split_deviating(item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Splits one edge of a tetrahedron: of all edges of its surface triangles that deviate, the one whose middle is farthest from the
    /// model. Not of a triangle where an end of that edge is off the model.
    pub fn split_deviating(&mut self, t: TetId) -> Result<(), Refusal> {
        let vertices = self.claim_current_tet(t)?;
        let tags = self.store.tags(t);
        let mut farthest: Option<(f64, [VertexId; 2])> = None;
        for i in (0..4).filter(|&i| tags[i] != 0) {
            let face = FACE[i].map(|k| vertices[k]);
            let deviation = self.surface_deviation(face, tags[i] - 1);
            if !self.deviates(deviation) {
                continue;
            }
            let (chord, edge) = self.farthest_edge(face, tags[i] - 1);
            let has_ends_on_model = edge.iter().all(|&v| self.distance_from_model(v) < OFF_MODEL * chord);
            if has_ends_on_model && farthest.is_none_or(|(known, _)| chord > known) {
                farthest = Some((chord, edge));
            }
        }
        let (_, [a, b]) = farthest.ok_or(Refusal::Stale)?;
        self.split_edge(EdgeItem { a: a.min(b), b: a.max(b), tet: t })
    }

    /// Of a triangle's edges the one whose middle is farthest from the model, and how far that is.
    fn farthest_edge(&mut self, [a, b, c]: [VertexId; 3], face: u32) -> (f64, [VertexId; 2]) {
        let edges = [[a, b], [b, c], [c, a]].map(|edge| (self.chord_of(edge, face), edge));
        edges.into_iter().reduce(|most, next| if next.0 > most.0 { next } else { most }).unwrap()
    }

    fn distance_from_model(&mut self, v: VertexId) -> f64 {
        let point = self.store.position(v);
        distance(point, self.closest(self.store.entity(v), point, &[v]).point)
    }
}
