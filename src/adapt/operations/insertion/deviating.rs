//! Splits surface triangles that deviate from the model by more than the user allows, whatever the lengths of their edges in the metric.
use crate::adapt::core::access::Access;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;

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
    /// Splits one edge of a tetrahedron: of all edges of its surface triangles that deviate, the one whose middle is farthest from the model.
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
            for edge in [[face[0], face[1]], [face[1], face[2]], [face[2], face[0]]] {
                let chord = self.chord_of(edge, tags[i] - 1);
                if chord > 0.0 && farthest.is_none_or(|(known, _)| chord > known) {
                    farthest = Some((chord, edge));
                }
            }
        }
        let (_, [a, b]) = farthest.ok_or(Refusal::Stale)?;
        self.split_edge(EdgeItem { a: a.min(b), b: a.max(b), tet: t })
    }
}
