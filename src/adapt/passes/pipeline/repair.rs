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
/// at some thousand flips.
pub(super) const REPAIR_SHARE: f64 = 0.25;

/// Of a list longer than this share of the tetrahedra, and [`REPAIR_FEW`], so many are tried first: the worst. Lists are so long only where
/// no mesh meets the metric.
const TRIAL_SHARE: f64 = 0.05;

/// Where a smaller share of these becomes better, repair ends for the run: of the rest still fewer would.
const USEFUL: f64 = 0.3;

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
            if self.repair_worst(&items) == 0 {
                break;
            }
            self.reconnect(Criterion::MeanRatio, 2);
            self.smooth();
        }
        // Here flips looked at the worst tetrahedra only.
        self.looked = looked;
    }

    /// Repairs as many of these as may still be tried, the first ones. Returns how many became better.
    fn repair_worst(&mut self, items: &[TetId]) -> u64 {
        let live = self.live_tets() as f64;
        let most = |share: f64| (REPAIR_FEW + share * live) as usize;
        let (trial, mut tried, mut done) = (most(TRIAL_SHARE), 0, 0);
        loop {
            let left = most(self.repair_share).saturating_sub(self.repaired).min(items.len() - tried);
            let some = if tried == 0 { left.min(trial) } else { left };
            self.unrepaired = items.len() - tried - some;
            if some == 0 || self.observer.stop() {
                return done;
            }
            self.repaired += some;
            done += self.sweep(Kind::Repair, &Repair, &items[tried..tried + some]).done;
            tried += some;
            if tried == trial && (done as f64) < USEFUL * trial as f64 {
                self.repair_share = TRIAL_SHARE;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::required::{Freeze, Required};
    use crate::adapt::tests::bench::{Bench, Shape, sample};

    /// Tetrahedra that are to be repaired, those that repair tries, and those that it leaves, of a mesh that may change or is frozen.
    fn repaired(is_frozen: bool) -> (usize, usize, usize) {
        let sample = sample(Shape::Cube, 10, 0.2);
        let mut bench = Bench::new(&sample, 1, 3);
        if is_frozen {
            let regions = vec![sample.mesh.tets.refs[0]];
            bench.context.required = Required::of(&sample.mesh, &Freeze { regions, ..Freeze::default() });
        }
        let found = bench.with_pipeline(|pipeline| {
            let bad = pipeline.tets(|store, t| store.quality(t) < REPAIR_BELOW).len();
            pipeline.repair();
            (bad, pipeline.repaired, pipeline.unrepaired)
        });
        bench.check("repair");
        found
    }

    #[test]
    fn where_repair_is_of_no_use_to_the_worst_the_others_are_left() {
        // 500 and a twentieth of 6000.
        let trial = 800;
        let (bad, tried, left) = repaired(true);
        assert!(bad > 2 * trial, "{bad}");
        assert_eq!((tried, left), (trial, bad - trial));
        let (bad, tried, _) = repaired(false);
        assert!(tried > 2 * trial, "{bad} {tried}");
    }
}
