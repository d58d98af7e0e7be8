//! Repair of the worst tetrahedra, as far as they are few.
use super::{Pipeline, shape_limits};
use crate::adapt::core::context::{LONG, Limits};
use crate::adapt::core::ids::TetId;
use crate::adapt::operations::reconnection::criteria::Criterion;
use crate::adapt::operations::repair::{Repair, SPLIT_GAIN};
use crate::adapt::operations::smoothing::worst::BAD;
use crate::adapt::schedule::work::Kind;

/// Tetrahedra below this mean ratio are repaired.
const REPAIR_BELOW: f64 = 0.5;

/// Rounds of repair.
const ROUNDS: usize = 3;

/// Most rounds that may follow while a very bad tetrahedron is repaired: edges are split and vertices moved for these, and one often makes room
/// for another.
const FURTHER_ROUNDS: usize = 20;

/// In a run, repair tries at most this share of the tetrahedra of the mesh, and [`REPAIR_FEW`]. It is dear: one costs as much as to look
/// at some thousand flips. Where a metric can be met, fewer tetrahedra are below the limit; where it cannot, repair would not end.
const REPAIR_SHARE: f64 = 0.25;

/// Vertices of more tetrahedra than this the end-game does not take out: each of the tetrahedra would try it again.
const REPAIR_BALL: usize = 256;

/// Tetrahedra that the end-game tries however small the mesh.
const REPAIR_FEW: f64 = 500.0;

impl Pipeline<'_, '_> {
    /// Repairs the tetrahedra below the limit. Edges may become a little longer than elsewhere.
    pub(super) fn repair(&mut self) {
        let looked = self.looked;
        self.limit(Limits {
            improve_below: REPAIR_BELOW,
            flip_below: REPAIR_BELOW,
            longest_new: 1.3 * LONG,
            shortest_new: 0.0,
            insert_floor: BAD,
            insert_loss: SPLIT_GAIN,
            ball: REPAIR_BALL,
            ..shape_limits()
        });
        let mut since = 0;
        for round in 0..ROUNDS + FURTHER_ROUNDS {
            let limit = if round < ROUNDS { REPAIR_BELOW } else { BAD };
            // What was refused is tried again where something has changed.
            let mut items = self.tets(|store, t| store.quality(t) < limit && store.moved(t) >= since);
            since = self.context.store.clock() + 1;
            let store = &self.context.store;
            self.team().sort_by(&mut items, |x, y| store.quality(*x).total_cmp(&store.quality(*y)).then(x.cmp(y)));
            self.no_more_than_repaired(&mut items);
            let done = if self.observer.stop() { 0 } else { self.sweep(Kind::Repair, &Repair, &items).done };
            if done == 0 {
                break;
            }
            self.reconnect(Criterion::MeanRatio, 2);
            self.smooth();
        }
        // Here flips looked at the worst tetrahedra only.
        self.looked = looked;
    }

    /// Leaves as many items of repair as it may still try, the worst ones.
    fn no_more_than_repaired(&mut self, items: &mut Vec<TetId>) {
        let most = (REPAIR_FEW + REPAIR_SHARE * self.live_tets() as f64) as usize;
        let left = most.saturating_sub(self.repaired);
        self.unrepaired = items.len().saturating_sub(left);
        items.truncate(left);
        self.repaired += items.len();
    }
}
