//! Local reconnection: each bad tetrahedron tries to remove its edges and its faces.
use super::criteria::Criterion;
use super::ring::Ring;
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{ACROSS, EDGE, TetId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;

/// Reconnects bad tetrahedra.
pub struct Reconnect(pub Criterion);

impl Operation for Reconnect {
    type Item = TetId;
    type Scratch = Box<Ring>;
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut Box<Ring>,
        item: TetId,
    ) -> Result<(), Refusal> {
        worker.reconnect(scratch, item, self.0)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Whether a tetrahedron tries an edge or face before another one at it: only the worst does, so each is tried once in a sweep.
    #[inline]
    pub fn goes_first(&self, t: TetId, other: TetId) -> bool {
        other == t || self.store.stamp(other) < self.context.limits.since || {
            let (mine, theirs) = (self.store.quality(t), self.store.quality(other));
            mine < theirs || (mine == theirs && t < other)
        }
    }

    /// Removes the first edge of a tetrahedron, else the first face, by whose removal the criterion gains.
    pub fn reconnect(&mut self, ring: &mut Ring, t: TetId, criterion: Criterion) -> Result<(), Refusal> {
        let v = self.claim_current_tet(t)?;
        if self.store.quality(t) >= self.context.limits.flip_below {
            return Err(Refusal::Stale);
        }
        if A::REFUSES_UNTIL_ROUND_ENDS {
            // Its edges and faces need these vertices in any case.
            for n in self.store.neighbours(t).into_iter().filter(|n| n.is_some()) {
                self.claim_tet(n)?;
            }
        }
        // Most edges and faces are another tetrahedron's: that is seen at the neighbours, before a ring is walked.
        let is_first = self.store.neighbours(t).map(|n| !n.is_some() || self.goes_first(t, n));
        let mut refusal = Refusal::Shape;
        for [i, j] in EDGE {
            let [k, l] = ACROSS[i][j];
            if !(is_first[k] && is_first[l]) {
                continue;
            }
            match self.remove_edge(ring, [v[i], v[j]], t, criterion) {
                Ok(()) => return Ok(()),
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(other) => refusal = other,
            }
        }
        for i in (0..4).filter(|&i| is_first[i]) {
            match self.remove_face(t, i, criterion) {
                Ok(()) => return Ok(()),
                Err(Refusal::Conflict) => return Err(Refusal::Conflict),
                Err(other) => refusal = other,
            }
        }
        Err(refusal)
    }
}
