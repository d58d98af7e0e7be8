//! A new vertex in the star over the tetrahedra that hold it.
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::{Bounds, Seed};
use crate::adapt::core::vertex_moves::Placed;
use crate::adapt::core::worker::Worker;
use crate::mesh::vector::{Vec3, sub};

/// Where the greatest length allowed is at least this share of an edge's, the sizes at its ends are nearly met.
const NEARLY_MET: f64 = 0.5;

impl<A: Access> Worker<'_, '_, A> {
    /// Inserts a vertex into the star over `seeds`; returns it. `near` is a vertex beside it; the edge to `facing` may be as short as it is.
    ///
    /// # Errors
    /// Besides those of the star: `Length` when an edge would be too short, `Shape` when a tetrahedron would
    /// be worse than the floor and than what stood there, `Normal` on the surface.
    pub fn insert(
        &mut self,
        seed: Seed,
        seeds: &[TetId],
        placed: Placed,
        (near, facing): (VertexId, VertexId),
    ) -> Result<VertexId, Refusal> {
        let limits = &self.context.limits;
        // The greatest length allowed over that of the edge, where it is too long.
        let share = match seed {
            Seed::Edge(a, b) => (limits.long / self.length(a, b)).min(1.0),
            _ => 1.0,
        };
        let shortest_new = limits.shortest_new * share.powf(limits.short_for_long);
        if let Seed::Edge(a, b) = seed
            && share > NEARLY_MET
            && self.is_near_ring([a, b], placed.point, shortest_new, facing)
        {
            return Err(Refusal::Length);
        }
        let state = self.state_at(placed, self.store.hint(near));
        self.with_new_vertex(&state, |worker, v| {
            worker.try_insert(seed, seeds, (v, facing), (share, shortest_new))?;
            worker.commit()
        })
    }

    /// Whether a point on an edge is too near to a vertex of the edge's ring, in the metrics of that vertex and of both ends. Where sizes are nearly
    /// met, the metric at the point lies between these, and need not be asked.
    fn is_near_ring(&self, ends: [VertexId; 2], point: Vec3, limit: f64, facing: VertexId) -> bool {
        let square = limit * limit;
        let ends = ends.map(|v| self.store.metric(v));
        self.state.shell.ring.iter().any(|&x| {
            let way = sub(self.store.position(x), point);
            x != facing
                && self.store.metric(x).quadratic(way) < square
                && ends.iter().all(|m| m.quadratic(way) < square)
        })
    }

    fn try_insert(
        &mut self,
        seed: Seed,
        seeds: &[TetId],
        (v, facing): (VertexId, VertexId),
        (share, shortest_new): (f64, f64),
    ) -> Result<(), Refusal> {
        let limits = self.context.limits;
        if let Seed::Edge(..) = seed
            && self.state.shell.ring.iter().any(|&x| x != facing && self.is_shorter(v, x, shortest_new))
        {
            // The vertex is joined to the ring in any case.
            return Err(Refusal::Length);
        }
        let of_floor = if limits.long_first { share.powi(3) } else { 1.0 };
        let allowed = |worker: &Self| of_floor * limits.insert_floor.min(limits.insert_loss * worker.worst_old());
        let worst = self.build_star(seed, v, seeds, Bounds::default())?;
        if worst < allowed(self) {
            let larger = Bounds { wanted: limits.insert_floor, floor: 0.0 };
            if self.build_star(seed, v, seeds, larger).map_err(Refusal::or_shape)? < allowed(self) {
                return Err(Refusal::Shape);
            }
        }
        if self.shortest_of_star(v, facing) < shortest_new {
            return Err(Refusal::Length);
        }
        // Where triangles stand across a round edge that the mesh does not resolve, the model's normal near their centroids means little.
        // Pieces that lie as the triangle did are no worse than it.
        self.check_normals(0.3)
            .or_else(|refusal| if self.keeps_normals() && !self.turns_over() { Ok(()) } else { Err(refusal) })
    }
}
