//! Insertion of new vertices: a star about the new point over the tetrahedra that hold it.
use super::access::Access;
use super::ids::{TetId, VertexId};
use super::outcome::Refusal;
use super::star::{Bounds, Seed};
use super::surface::Placed;
use super::worker::Worker;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, lerp, sub};
use crate::metric::quality::mean_length;

/// An edge to be looked at, and a tetrahedron that held it when it was listed.
#[derive(Clone, Copy, Debug)]
pub struct EdgeItem {
    /// One end.
    pub a: VertexId,
    /// The other end.
    pub b: VertexId,
    /// Where to find the edge.
    pub tet: TetId,
}

/// What is taken from the least length of a new edge where a much too long one is split: a power of how much too long it is. With more
/// the short edges are collapsed again at great cost, with less edges of many unit lengths stay beside coarse boundaries.
const SHORT_FOR_LONG: f64 = 0.7;

/// Where along a–b the metric length from a is this share of the whole, for sizes that change geometrically: la, lb are the lengths of
/// the whole edge in the metrics of its ends.
fn at_share(share: f64, la: f64, lb: f64) -> f64 {
    let growth = lb / la - 1.0;
    if growth.abs() < 1e-3 { share } else { ((share * growth).ln_1p() / growth.ln_1p()).clamp(0.1, 0.9) }
}

/// The share of an edge that is cut off: a third from √6, where three pieces come nearer to unit length than two, up to √18, where three
/// would be too long; else half. Halves of edges of length three would be halved again, and be too short then.
fn cut_off(length: f64) -> f64 {
    if length * length > 6.0 && length * length < 18.0 { 1.0 / 3.0 } else { 0.5 }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Splits an edge that is too long, at its middle or its third in the metric, on its entity of the model.
    pub fn split_edge(&mut self, item: EdgeItem) -> Result<(), Refusal> {
        let EdgeItem { a, b, tet } = item;
        self.claim_live(a)?;
        self.claim_live(b)?;
        let tet = self.tet_with_edge(a, b, tet)?;
        let length = self.length(a, b);
        if length <= self.context.limits.long {
            return Err(Refusal::Stale);
        }
        self.split_at(EdgeItem { a, b, tet }, self.cut(a, b))
    }

    /// Splits an edge whose vertices are claimed, at a point of its straight line, on its entity of the model.
    pub fn split_at(&mut self, EdgeItem { a, b, tet }: EdgeItem, straight: Vec3) -> Result<(), Refusal> {
        self.gather_shell(a, b, tet)?;
        let entity = self.entity_of_edge(a, b);
        let placed = self.place(entity, straight, &[a, b]);
        let seeds = std::mem::take(&mut self.state.shell.tets);
        let mut result = self.insert(Seed::Edge(a, b), &seeds, placed, a);
        if matches!(result, Err(Refusal::Inverted | Refusal::Topology)) && placed.point != straight {
            // No room on the model: the point waits on the straight edge until there is (project.rs).
            result = self.insert(Seed::Edge(a, b), &seeds, Placed { point: straight, ..placed }, a);
            if let Ok(v) = result {
                self.state.waiting.push(v);
            }
        }
        self.state.shell.tets = seeds;
        let v = result?;
        if let Entity::Edge(_) = entity {
            self.store.set_ridge(v, [a, b]);
            self.store.redirect_ridge(a, b, v);
            self.store.redirect_ridge(b, a, v);
        }
        Ok(())
    }

    /// The point of the straight edge where it is cut.
    fn cut(&self, a: VertexId, b: VertexId) -> Vec3 {
        let (p, q) = (self.store.position(a), self.store.position(b));
        let v = sub(q, p);
        let la = self.store.metric(a).quadratic(v).sqrt();
        let lb = self.store.metric(b).quadratic(v).sqrt();
        lerp(p, q, at_share(cut_off(mean_length(la, lb)), la, lb))
    }

    /// Inserts a vertex into the star over `seeds`; returns it.
    ///
    /// # Errors
    /// Besides those of the star: `Length` when an edge would be too short, `Shape` when a tetrahedron would
    /// be worse than the floor and than what stood there, `Normal` on the surface.
    pub fn insert(&mut self, seed: Seed, seeds: &[TetId], placed: Placed, near: VertexId) -> Result<VertexId, Refusal> {
        let v = self.new_vertex()?;
        self.set_point(v, placed.point, self.store.hint(near));
        self.store.set_place(v, placed.entity, placed.parameters);
        let result = self.try_insert(seed, seeds, v).and_then(|()| self.commit());
        match result {
            Ok(()) => Ok(v),
            Err(refusal) => {
                self.state.supply.free_vertex(v);
                Err(refusal)
            }
        }
    }

    fn try_insert(&mut self, seed: Seed, seeds: &[TetId], v: VertexId) -> Result<(), Refusal> {
        let limits = self.context.limits;
        // A much too long edge is worth a bad tetrahedron or a short edge: what comes after it finds better places for those.
        let excess = match seed {
            Seed::Edge(a, b) if limits.long_first => (limits.long / self.length(a, b)).min(1.0),
            _ => 1.0,
        };
        let shortest_new = limits.shortest_new * excess.powf(SHORT_FOR_LONG);
        if let Seed::Edge(..) = seed
            && self.state.shell.ring.iter().any(|&x| self.is_shorter(v, x, shortest_new))
        {
            // It will be joined to the ring in any case.
            return Err(Refusal::Length);
        }
        let allowed = |worker: &Self| excess.powi(3) * limits.insert_floor.min(limits.insert_loss * worker.worst_old());
        let worst = self.build_star(seed, v, seeds, Bounds::default())?;
        if worst < allowed(self) {
            let larger = Bounds { wanted: limits.insert_floor, floor: 0.0 };
            if self.build_star(seed, v, seeds, larger).map_err(Refusal::or_shape)? < allowed(self) {
                return Err(Refusal::Shape);
            }
        }
        let (shortest, _) = self.star_lengths(v);
        if shortest < shortest_new {
            return Err(Refusal::Length);
        }
        // Where triangles stand across a round edge that the mesh does not resolve, the model's normal near their centroids may be any;
        // cut into pieces that lie as they did they are no worse.
        self.check_normals(0.3).or_else(|refusal| if self.turns_little() { Ok(()) } else { Err(refusal) })
    }

    /// Moves a claimed vertex, with the metric that belongs to the point.
    pub fn set_point(&mut self, v: VertexId, point: Vec3, hint: u32) {
        debug_assert!(!self.context.is_frozen(v), "{v:?} must not move");
        let mut hint = hint;
        let log = self.context.source.log_at(point, &mut hint);
        self.store.set_position(v, point);
        self.store.set_metric(v, &log, &log.exp());
        self.store.set_hint(v, hint);
    }
}
