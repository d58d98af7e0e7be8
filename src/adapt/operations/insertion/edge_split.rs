//! Edges that are too long are split, at their middles or thirds in the metric.
use crate::adapt::core::access::Access;
use crate::adapt::core::edge_list::EdgeItem;
use crate::adapt::core::ids::VertexId;
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::star::Seed;
use crate::adapt::core::vertex_moves::Placed;
use crate::adapt::core::worker::Worker;
use crate::adapt::schedule::Operation;
use crate::geometry::Entity;
use crate::mesh::vector::{Vec3, dot, lerp, sub};
use crate::metric::quality::mean_length;
use std::ops::RangeInclusive;

/// The place on a–b up to which the length in the metric is this share of the whole, where sizes change geometrically along it. la and
/// lb are the lengths of the whole edge in the metrics of its ends.
fn at_share(share: f64, la: f64, lb: f64) -> f64 {
    let growth = lb / la - 1.0;
    if growth.abs() < 1e-3 { share } else { ((share * growth).ln_1p() / growth.ln_1p()).clamp(0.1, 0.9) }
}

/// The share of an edge that is cut off. Between √6, from where on three pieces are nearer to unit length than two, and √18, where three
/// pieces would be too long, it is a third; else half. Halves of an edge of length three would be halved again, and be too short then.
fn cut_off(length: f64) -> f64 {
    if length * length > 6.0 && length * length < 18.0 { 1.0 / 3.0 } else { 0.5 }
}

/// Where along a ridge it is split opposite to a vertex of another; else where any edge is.
const FACING: RangeInclusive<f64> = 0.25..=0.75;

/// Splits edges that are too long.
pub struct Split;

impl Operation for Split {
    type Item = EdgeItem;
    type Scratch = ();
    const WHOLE_BALLS: bool = false;

    fn attempt<A: Access>(
        &self,
        worker: &mut Worker<'_, '_, A>,
        _scratch: &mut (),
        item: EdgeItem,
    ) -> Result<(), Refusal> {
        worker.split_edge(item)
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Splits an edge that is too long, at its middle or its third in the metric, on its entity of the model.
    ///
    /// # Errors
    /// `Stale` when it is not too long, or waits for the next sweep; else the refusal of the insertion.
    pub fn split_edge(&mut self, item: EdgeItem) -> Result<(), Refusal> {
        let EdgeItem { a, b, tet } = item;
        self.claim_live(a)?;
        self.claim_live(b)?;
        let tet = self.tet_with_edge(a, b, tet)?;
        let length = self.length(a, b);
        if length <= self.context.limits.long {
            return Err(Refusal::Stale);
        }
        self.gather_shell(a, b, tet)?;
        if self.context.limits.waits {
            let now = self.store.clock();
            if self.state.shell.tets.iter().any(|&t| self.store.stamp(t) == now) {
                return Err(Refusal::Stale);
            }
        }
        let (facing, opposite) = self.facing_vertex([a, b]).unwrap_or((VertexId::NONE, None));
        self.split_shell([a, b], opposite.unwrap_or_else(|| self.cut(a, b)), facing)
    }

    /// Splits an edge whose vertices are claimed, at a point of its straight line, on its entity of the model.
    pub fn split_at(&mut self, EdgeItem { a, b, tet }: EdgeItem, straight: Vec3) -> Result<(), Refusal> {
        self.gather_shell(a, b, tet)?;
        self.split_shell([a, b], straight, VertexId::NONE)
    }

    /// Splits the edge whose shell is gathered, at a point of its straight line, on its entity of the model. The new edge to `facing` may be
    /// as short as it is.
    fn split_shell(&mut self, [a, b]: [VertexId; 2], straight: Vec3, facing: VertexId) -> Result<(), Refusal> {
        if self.state.shell.is_shared() {
            return Err(Refusal::Geometry);
        }
        let entity = self.entity_of_edge(a, b);
        let placed = self.place(entity, straight, &[a, b]);
        let seeds = std::mem::take(&mut self.state.shell.tets);
        let mut result = self.insert(Seed::Edge(a, b), &seeds, placed, (a, facing));
        if matches!(result, Err(Refusal::Inverted | Refusal::Topology)) && placed.point != straight {
            // No room on the model: until there is, the vertex stays on the straight edge (projection.rs).
            result = self.insert(Seed::Edge(a, b), &seeds, Placed { point: straight, ..placed }, (a, facing));
            if let Ok(v) = result {
                self.state.unprojected.push(v);
            }
        }
        self.state.shell.tets = seeds;
        let v = result?;
        if let Entity::Edge(_) = entity {
            self.split_ridge([a, b], v);
        }
        Ok(())
    }

    /// The nearest vertex of another edge of the model, nearer than new edges may be short, that lies opposite to the ridge a–b, whose shell
    /// is gathered; and the point of a–b that it faces, unless that is too near to an end. Where two edges of the model run side by side, nearer
    /// than the metric's sizes (a blunt trailing edge), each point of one is too near to the other: if that counted, the ridges would stay too
    /// long (docs/decisions/surface.md).
    fn facing_vertex(&self, [a, b]: [VertexId; 2]) -> Option<(VertexId, Option<Vec3>)> {
        let curve = self.store.ridge_curve(a, b)?;
        let is_on_another = |x: VertexId| match self.store.entity(x) {
            Entity::Edge(other) => other != curve,
            Entity::Vertex(_) => true,
            Entity::Face(_) | Entity::Interior => false,
        };
        let near = self.context.limits.shortest_new.powi(2);
        let found = self.state.shell.ring.iter().copied().filter(|&x| is_on_another(x)).filter_map(|x| {
            let (share, point) = self.closest_between(x, a, b);
            let off = self.store.metric(x).quadratic(sub(self.store.position(x), point));
            let opposite = FACING.contains(&share).then_some(point);
            ((0.0..=1.0).contains(&share) && off < near).then_some((off, x, opposite))
        });
        found.min_by(|x, y| x.0.total_cmp(&y.0)).map(|(_, x, opposite)| (x, opposite))
    }

    /// The point of the line a–b closest to x in the metric there, and its share of the way from a to b.
    pub fn closest_between(&self, x: VertexId, a: VertexId, b: VertexId) -> (f64, Vec3) {
        let [p, q, r] = [a, b, x].map(|v| self.store.position(v));
        let (along, off) = (sub(q, p), sub(r, p));
        let metric = self.store.metric(x);
        let share = dot(metric.apply(off), along) / metric.quadratic(along);
        (share, lerp(p, q, share))
    }

    /// The point of the straight edge where it is cut.
    fn cut(&self, a: VertexId, b: VertexId) -> Vec3 {
        let (p, q) = (self.store.position(a), self.store.position(b));
        let v = sub(q, p);
        let la = self.store.metric(a).quadratic(v).sqrt();
        let lb = self.store.metric(b).quadratic(v).sqrt();
        lerp(p, q, at_share(cut_off(mean_length(la, lb)), la, lb))
    }
}
