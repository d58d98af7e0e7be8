//! A vertex moves for the worst of its tetrahedra alone (optimization-based smoothing; Freitag & Ollivier-Gooch 1997, Tetrahedral mesh
//! improvement using swapping and smoothing). The energy of [`super::patch`] gives up one tetrahedron for many.
use super::patch::SmoothingPatch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::{Refusal, first_done};
use crate::adapt::core::worker::Worker;
use crate::mesh::vector::{Vec3, add, cross, dot, lerp, scale, sub};

/// Below this mean ratio a tetrahedron is very bad: a vertex may be moved for it alone, or an edge split. Where the worst ratio at a vertex is below
/// it, smoothing must not lower that. Where two edges of the model run side by side, nearer than the metric's sizes (a blunt trailing edge), their
/// vertices must face each other, and a vertex may be missing for that.
pub const BAD: f64 = 0.35;

/// By a move the worst mean ratio must grow by this factor: many small ones are needed.
const GAIN: f64 = 1.01;

/// Parts of the way to the best place that are tried.
const STEPS: [f64; 5] = [1.0, 0.5, 0.25, 0.12, 0.06];

impl<A: Access> Worker<'_, '_, A> {
    /// Moves a vertex of a claimed tetrahedron, within its entity, towards the place where the tetrahedron would be best. Of the four the first
    /// whose worst tetrahedron becomes better by it, and is this one.
    ///
    /// # Errors
    /// The refusal of the last vertex.
    pub fn move_for_worst(&mut self, patch: &mut SmoothingPatch, t: TetId) -> Result<(), Refusal> {
        let vertices = self.store.vertices(t);
        first_done(vertices.into_iter().enumerate().map(|(i, v)| {
            let best = self.best_apex(vertices, i);
            self.with_patch(patch, v, |worker, patch, ball| worker.move_towards(patch, v, ball, best, t))
        }))
    }

    /// The place of local vertex i where the mean ratio would be greatest, with its metric held: over the centroid of the opposite triangle, at
    /// the height √(2/9 Σ L²) over its edges. For a triangle with edges of length one that is the height of the regular tetrahedron.
    fn best_apex(&self, vertices: [VertexId; 4], i: usize) -> Vec3 {
        let [a, b, c] = FACE[i].map(|k| self.store.position(vertices[k]));
        let metric = self.store.metric(vertices[i]);
        let (e, f, g) = (sub(b, a), sub(c, a), sub(c, b));
        let squares = metric.quadratic(e) + metric.quadratic(f) + metric.quadratic(g);
        let centroid = scale(add(add(a, b), c), 1.0 / 3.0);
        let (across, above) = (cross(e, f), sub(self.store.position(vertices[i]), centroid));
        // Normal to the triangle in the metric.
        let normal = scale(metric.solve(across), dot(across, above).signum());
        add(centroid, scale(normal, (2.0 / 9.0 * squares / metric.quadratic(normal)).sqrt()))
    }

    /// Moves v towards a place, if t is the worst tetrahedron of its ball and the worst becomes better.
    fn move_towards(
        &mut self,
        patch: &mut SmoothingPatch,
        v: VertexId,
        ball: &Ball,
        place: Vec3,
        t: TetId,
    ) -> Result<(), Refusal> {
        let worst = patch.worst;
        if worst < self.store.quality(t) {
            return Err(Refusal::Shape);
        }
        let held = self.vertex_state(v);
        first_done(STEPS.into_iter().map(|step| {
            let placed = self.place(held.placed.entity, lerp(held.placed.point, place, step), &[v]);
            let to = self.state_at(placed, held.hint);
            let is_better = patch.falls_below(f64::MAX, placed.point, &to.log)
                && patch.mean_ratios().all(|ratio| ratio >= GAIN * worst);
            if is_better { self.move_fairly(v, &to, ball, patch) } else { Err(Refusal::Shape) }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::GAIN;
    use crate::adapt::core::access::{Access, Speculative};
    use crate::adapt::core::ids::TetId;
    use crate::adapt::core::refusal::Refusal;
    use crate::adapt::core::store::Store;
    use crate::adapt::core::worker::Worker;
    use crate::adapt::operations::smoothing::patch::SmoothingPatch;
    use crate::adapt::tests::bench::{Bench, Shape, sample};

    /// The worst tetrahedra with their mean ratios, the worst first.
    fn worst(store: &Store) -> Vec<(f64, TetId)> {
        let mut ratios: Vec<_> = store.live_tets().map(|t| (store.quality(t), t)).collect();
        ratios.sort_by(|x, y| x.0.total_cmp(&y.0));
        ratios.truncate(20);
        ratios
    }

    fn move_for_worst(bench: &mut Bench<'_>, t: TetId) -> Result<(), Refusal> {
        let mut worker = Worker::new(&bench.context, &mut bench.states[0], Speculative::new(0));
        let moved = worker.claim_current_tet(t).and_then(|_| worker.move_for_worst(&mut SmoothingPatch::default(), t));
        worker.access.release(worker.store);
        moved
    }

    #[test]
    fn the_worst_tetrahedra_of_a_mesh_become_better_move_by_move() {
        for shape in [Shape::Cube, Shape::TwoRegions, Shape::Round] {
            let sample = sample(shape, 3, 0.8);
            let mut bench = Bench::new(&sample, 1, 1);
            for moves in 0..12 {
                let worst = worst(&bench.context.store);
                // Some have vertices that cannot move.
                let moved = worst.into_iter().find(|&(_, t)| move_for_worst(&mut bench, t).is_ok());
                let (before, t) =
                    moved.unwrap_or_else(|| panic!("{shape:?}: nothing can be moved after {moves} moves"));
                assert!(bench.context.store.quality(t) >= GAIN * before, "{shape:?}, tetrahedron {t:?}");
                bench.check(&format!("{shape:?}, move {moves}"));
            }
        }
    }
}
