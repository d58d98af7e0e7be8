//! Collapse to the middle: where neither end of a short edge can go onto the other, both meet half-way.
use super::onto_end::CollapseScratch;
use crate::adapt::core::access::Access;
use crate::adapt::core::ball::Ball;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::worker::Worker;
use crate::adapt::surface::deviation::WorstDeviation;
use crate::geometry::Entity;
use crate::mesh::vector::lerp;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes v and moves its neighbour w, on the same entity of the model, to the middle of the edge between them.
    ///
    /// # Errors
    /// As a collapse. The mesh is unchanged then.
    pub fn merge(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        w: VertexId,
        balls: [&Ball; 2],
    ) -> Result<(), Refusal> {
        if self.store.entity(v) != self.store.entity(w) || self.context.is_frozen(w) {
            return Err(Refusal::Geometry);
        }
        self.check_entities(v, w)?;
        let mut both = std::mem::take(&mut scratch.union);
        both.clear();
        let store = self.store;
        both.extend(&balls[0].tets);
        both.extend(balls[1].tets.iter().filter(|&&t| !store.vertices(t).contains(&v)));
        let result = self.merge_in(scratch, v, w, balls, &both);
        scratch.union = both;
        result
    }

    fn merge_in(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        w: VertexId,
        balls: [&Ball; 2],
        both: &[TetId],
    ) -> Result<(), Refusal> {
        let before = self.deviation_of_both(v, w, both);
        let variation =
            self.ridge_variation_at(v).min(self.ridge_variation_at(w)).min(self.context.limits.cos_variation);
        let held = self.vertex_state(w);
        let middle = lerp(self.store.position(v), held.placed.point, 0.5);
        let placed = self.place(held.placed.entity, middle, &[v, w]);
        let to = self.state_at(placed, held.hint);
        let limit = self.context.limits.longest_new;
        self.with_vertex_at(w, &to, |worker| {
            let mut ends = balls.iter().flat_map(|ball| &ball.link);
            if ends.any(|&x| x != v && x != w && worker.is_longer(w, x, limit)) {
                return Err(Refusal::Length);
            }
            worker.check_merged_variation(v, w, variation)?;
            worker.merge_star(scratch, v, w, both, before)
        })
    }

    /// Along neither new ridge edge may the model's tangent vary more than `limit` (a cosine). w has moved already.
    fn check_merged_variation(&mut self, v: VertexId, w: VertexId, limit: f64) -> Result<(), Refusal> {
        let Entity::Edge(curve) = self.store.entity(w) else { return Ok(()) };
        let beyond = [(v, w), (w, v)].map(|(x, y)| self.store.ridge(x).into_iter().find(|&end| end != y));
        let ends = beyond.into_iter().flatten().filter(|end| end.is_some());
        let least = ends.fold(1.0, |least, end| self.ridge_variation(curve, end, w).min(least));
        if least < limit { Err(Refusal::Normal) } else { Ok(()) }
    }

    /// The worst deviation of the surface triangles at both vertices, before one of them moves.
    fn deviation_of_both(&mut self, v: VertexId, w: VertexId, both: &[TetId]) -> WorstDeviation {
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, both, &mut triangles);
        self.list_surface(w, both, &mut triangles);
        let before = self.worst_deviation(&triangles);
        self.state.star.surface = triangles;
        before
    }

    fn merge_star(
        &mut self,
        scratch: &mut CollapseScratch,
        v: VertexId,
        w: VertexId,
        both: &[TetId],
        before: WorstDeviation,
    ) -> Result<(), Refusal> {
        let floor = self.context.limits.collapse_floor.min(self.worst_of(both));
        self.build_star(Seed::Pair(v, w), w, both, Bounds { wanted: 0.0, floor })?;
        if !self.state.star.surface.is_empty() {
            self.check_surface_link(scratch, v, w)?;
            self.check_star_normals(before, 0.0)?;
        }
        self.state.replacement.keeps_surface = true;
        self.finish_collapse(v, w)
    }
}
