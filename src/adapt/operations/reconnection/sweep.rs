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
        // Most edges and faces are another tetrahedron's: that is seen at the neighbours, before a ring is walked.
        let neighbours = self.store.neighbours(t);
        let is_first = neighbours.map(|n| !n.is_some() || self.goes_first(t, n));
        // What needs a neighbour out of reach waits for the next round, but nothing is left to wait for if another edge can be removed now.
        // With two out of reach there is one other edge at most.
        let mut is_in_reach = [true; 4];
        if A::REFUSES_UNTIL_ROUND_ENDS {
            for i in (0..4).filter(|&i| is_first[i] && neighbours[i].is_some()) {
                is_in_reach[i] = self.claim_tet(neighbours[i]).is_ok();
            }
            if is_in_reach.iter().filter(|&&is_in_reach| !is_in_reach).count() > 1 {
                return Err(Refusal::Conflict);
            }
        }
        let mut refusal = if is_in_reach == [true; 4] { Refusal::Shape } else { Refusal::Conflict };
        for [i, j] in EDGE {
            let [k, l] = ACROSS[i][j];
            if ![k, l].iter().all(|&m| is_first[m] && is_in_reach[m]) {
                continue;
            }
            if is_done::<A>(self.remove_edge(ring, [v[i], v[j]], t, criterion), &mut refusal)? {
                return Ok(());
            }
        }
        if refusal == Refusal::Conflict {
            // Faces are tried after all edges, in a round that reaches them.
            return Err(refusal);
        }
        for i in (0..4).filter(|&i| is_first[i]) {
            if is_done::<A>(self.remove_face(t, i, criterion), &mut refusal)? {
                return Ok(());
            }
        }
        Err(refusal)
    }
}

/// Whether the last of several tries was carried out. Else `refusal` becomes that of all: a conflict, if there was one.
///
/// # Errors
/// `Conflict` where another thread holds a vertex for the moment: then nothing else is tried.
fn is_done<A: Access>(result: Result<(), Refusal>, refusal: &mut Refusal) -> Result<bool, Refusal> {
    match result {
        Ok(()) => return Ok(true),
        Err(Refusal::Conflict) if !A::REFUSES_UNTIL_ROUND_ENDS => return Err(Refusal::Conflict),
        Err(other) if *refusal != Refusal::Conflict => *refusal = other,
        Err(_) => {}
    }
    Ok(false)
}
