//! Repair of the worst tetrahedra: what reconnection and smoothing could not improve is tried with larger cavities.
use crate::adapt::core::access::Access;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::{ACROSS, EDGE, TetId, VertexId};
use crate::adapt::core::refusal::{Refusal, first_done};
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::worker::Worker;
use crate::adapt::operations::collapse::onto_end::CollapseScratch;
use crate::adapt::operations::smoothing::patch::SmoothingPatch;
use crate::adapt::operations::smoothing::worst::BAD;
use crate::adapt::schedule::Operation;
use crate::mesh::vector::lerp;
use std::ops::RangeInclusive;

/// The worst mean ratio of a larger cavity must grow by this factor.
const GAIN: f64 = 1.05;

/// By a split for the shape the worst mean ratio must grow by this factor: smoothing gains the rest.
pub const SPLIT_GAIN: f64 = 1.001;

/// Where along an edge it may be split for the shape.
const BETWEEN: RangeInclusive<f64> = 0.1..=0.9;

/// What repair needs at hand. Allocated once.
#[derive(Default)]
pub struct RepairScratch {
    collapse: CollapseScratch,
    patch: SmoothingPatch,
}

/// Repairs the worst tetrahedra.
pub struct Repair;

impl Operation for Repair {
    type Item = TetId;
    type Scratch = RepairScratch;
    const WHOLE_BALLS: bool = true;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        scratch: &mut RepairScratch,
        item: TetId,
    ) -> Result<(), Refusal> {
        worker.repair(scratch, item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Repairs one bad tetrahedron: a larger cavity becomes a star about one of its vertices, or a vertex goes onto any neighbour, if
    /// the worst tetrahedron becomes clearly better by it. Where nothing of that helps a very bad one, an edge is split or a vertex moved. The
    /// move comes last: it gains little by little, and what gains more is often refused after it.
    pub fn repair(&mut self, scratch: &mut RepairScratch, t: TetId) -> Result<(), Refusal> {
        let vertices = self.claim_current_tet(t)?;
        let quality = self.store.quality(t);
        if quality >= self.context.limits.improve_below {
            return Err(Refusal::Stale);
        }
        let floor = (GAIN * quality).max(1e-9);
        let star = first_done(vertices.into_iter().map(|v| self.retetrahedralize_ball(v, floor)));
        let result = star.or_else(|refusal| {
            refusal.or_try(|| first_done(vertices.into_iter().map(|v| self.remove(&mut scratch.collapse, v, floor))))
        });
        if quality >= BAD {
            return result;
        }
        result
            .or_else(|refusal| refusal.or_try(|| self.split_longest_edge(t, vertices)))
            .or_else(|refusal| refusal.or_try(|| self.move_for_worst(&mut scratch.patch, t)))
    }

    /// Splits the longest edge of a tetrahedron that can be split, at the point closest to another of its vertices or in the middle. The
    /// limits of this pass ask of an insertion that the worst tetrahedron becomes better, and nothing about lengths.
    fn split_longest_edge(&mut self, t: TetId, vertices: [VertexId; 4]) -> Result<(), Refusal> {
        let mut edges = EDGE.map(|[i, j]| (self.length(vertices[i], vertices[j]), i, j));
        edges.sort_by(|x, y| y.0.total_cmp(&x.0));
        for (_, i, j) in edges {
            let (a, b) = (vertices[i].min(vertices[j]), vertices[i].max(vertices[j]));
            let middle = lerp(self.store.position(a), self.store.position(b), 0.5);
            let opposite = ACROSS[i][j].map(|x| self.closest_between(vertices[x], a, b));
            let between = opposite.into_iter().filter(|(share, _)| BETWEEN.contains(share)).map(|(_, point)| point);
            for point in between.chain([middle]) {
                let result = self.split_at(EdgeItem { a, b, tet: t }, point);
                if matches!(result, Ok(()) | Err(Refusal::Conflict)) {
                    return result;
                }
            }
        }
        Err(Refusal::Shape)
    }

    /// Makes the ball of a vertex a star over a cavity that grows where tetrahedra would be bad.
    fn retetrahedralize_ball(&mut self, v: VertexId, floor: f64) -> Result<(), Refusal> {
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
}
