//! Collapse to the middle: where neither end of a short edge can go onto the other, both meet half-way.
use super::access::Access;
use super::ball::Ball;
use super::ids::{TetId, VertexId};
use super::outcome::Refusal;
use super::star::{Bounds, Seed};
use super::surface::Facing;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::lerp;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes v and moves its neighbour w, on the same entity of the model, to the middle of the edge between them.
    ///
    /// # Errors
    /// As a collapse; the mesh is as it was then.
    pub fn merge(&mut self, v: VertexId, w: VertexId, balls: [&Ball; 2]) -> Result<(), Refusal> {
        if self.store.entity(v) != self.store.entity(w) {
            return Err(Refusal::Geometry);
        }
        self.context.required.check_move(w)?;
        self.check_entities(v, w)?;
        let mut both = std::mem::take(&mut self.state.union);
        both.clear();
        let store = self.store;
        both.extend(&balls[0].tets);
        both.extend(balls[1].tets.iter().filter(|&&t| !store.vertices(t).contains(&v)));
        let result = self.merge_in(v, w, balls, &both);
        self.state.union = both;
        result
    }

    fn merge_in(&mut self, v: VertexId, w: VertexId, balls: [&Ball; 2], both: &[TetId]) -> Result<(), Refusal> {
        let facing = self.facing_of_both(v, w, both);
        let bend = self.spread_at(v).min(self.spread_at(w)).min(self.context.limits.spread);
        let held = self.hold(w);
        let middle = lerp(self.store.position(v), held.placed.point, 0.5);
        let placed = self.place(held.placed.entity, middle, &[v, w]);
        self.set_point(w, placed.point, held.hint);
        self.store.set_place(w, placed.entity, placed.parameters);
        let limit = self.context.limits.longest_new;
        let reach = |worker: &Self| {
            let mut ends = balls.iter().flat_map(|ball| &ball.link);
            match ends.any(|&x| x != v && x != w && worker.is_longer(w, x, limit)) {
                true => Err(Refusal::Length),
                false => Ok(()),
            }
        };
        let result = reach(self).and_then(|()| self.check_merged_bend(v, w, bend));
        let result = result.and_then(|()| self.merge_star(v, w, both, facing));
        result.inspect_err(|_| self.put_back(w, &held))
    }

    /// Neither ridge edge that comes may span more of a bend than `limit`; w has moved.
    fn check_merged_bend(&mut self, v: VertexId, w: VertexId, limit: f64) -> Result<(), Refusal> {
        let Entity::Edge(curve) = self.store.entity(w) else { return Ok(()) };
        let beyond = [(v, w), (w, v)].map(|(x, y)| self.store.ridge(x).into_iter().find(|&end| end != y));
        let bent = beyond.into_iter().flatten().filter(|end| end.is_some());
        let bent = bent.fold(1.0, |least, end| self.ridge_spread(curve, end, w).min(least)) < limit;
        if bent { Err(Refusal::Normal) } else { Ok(()) }
    }

    /// How the surface triangles at both vertices look, before one of them moves.
    fn facing_of_both(&mut self, v: VertexId, w: VertexId, both: &[TetId]) -> Facing {
        let mut triangles = std::mem::take(&mut self.state.star.surface);
        triangles.clear();
        self.list_surface(v, both, &mut triangles);
        self.list_surface(w, both, &mut triangles);
        let facing = self.facing(&triangles);
        self.state.star.surface = triangles;
        facing
    }

    fn merge_star(&mut self, v: VertexId, w: VertexId, both: &[TetId], facing: Facing) -> Result<(), Refusal> {
        let floor = self.context.limits.collapse_floor.min(self.worst_of(both));
        self.build_star(Seed::Pair(v, w), w, both, Bounds { wanted: 0.0, floor })?;
        if !self.state.star.surface.is_empty() {
            self.check_surface_link(v, w)?;
            self.check_star_normals(facing, 0.0)?;
        }
        self.state.replacement.keeps_surface = true;
        self.finish_collapse(v, w)
    }
}
