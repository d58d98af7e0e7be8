//! What the store holds of vertices.
use super::super::ids::{TetId, VertexId};
use super::{CornerRidge, INDEX_BITS, Store, load, pack, save, unpack, value};
use crate::geometry::Entity;
use crate::mesh::vector::Vec3;
use crate::metric::Sym3;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering::Relaxed};

impl Store {
    /// Position, model units.
    #[inline(always)]
    pub fn position(&self, v: VertexId) -> Vec3 {
        self.must_hold(v);
        load(&self.vertices[v.index()].position)
    }

    /// Moves a vertex.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_position(&self, v: VertexId, p: Vec3) {
        self.must_hold(v);
        save(&self.vertices[v.index()].position, p);
    }

    /// ln M.
    #[inline(always)]
    pub fn log(&self, v: VertexId) -> Sym3 {
        self.must_hold(v);
        Sym3(load(&self.vertices[v.index()].log))
    }

    /// M.
    #[inline(always)]
    pub fn metric(&self, v: VertexId) -> Sym3 {
        self.must_hold(v);
        Sym3(load(&self.vertices[v.index()].metric))
    }

    /// Σ ln M over the vertices of a triangle. Component by component, so that all of it stays in registers.
    #[inline(always)]
    pub fn log_sum(&self, triangle: [VertexId; 3]) -> Sym3 {
        triangle.iter().for_each(|&v| self.must_hold(v));
        let [a, b, c] = triangle.map(|v| &self.vertices[v.index()].log);
        Sym3(std::array::from_fn(|i| value(&a[i]) + value(&b[i]) + value(&c[i])))
    }

    /// ΣM over the vertices of a triangle.
    #[inline(always)]
    pub fn metric_sum(&self, triangle: [VertexId; 3]) -> Sym3 {
        triangle.iter().for_each(|&v| self.must_hold(v));
        let [a, b, c] = triangle.map(|v| &self.vertices[v.index()].metric);
        Sym3(std::array::from_fn(|i| value(&a[i]) + value(&b[i]) + value(&c[i])))
    }

    /// Sets ln M and M together.
    #[inline]
    pub(in crate::adapt::core) fn set_metric(&self, v: VertexId, log: &Sym3, metric: &Sym3) {
        self.must_hold(v);
        save(&self.vertices[v.index()].log, log.0);
        save(&self.vertices[v.index()].metric, metric.0);
    }

    /// The owner of the vertex in this round, 0 for none.
    #[inline(always)]
    pub fn owner(&self, v: VertexId) -> &AtomicU8 {
        &self.owners[v.index()]
    }

    /// The lock word, 0 when free.
    #[inline(always)]
    pub fn lock(&self, v: VertexId) -> &AtomicU32 {
        &self.vertices[v.index()].lock
    }

    /// One tetrahedron at the vertex; none when the vertex is dead.
    #[inline(always)]
    pub fn tet_of(&self, v: VertexId) -> TetId {
        self.must_hold(v);
        TetId(self.vertices[v.index()].tet.load(Relaxed))
    }

    /// Sets the tetrahedron at the vertex.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_tet_of(&self, v: VertexId, t: TetId) {
        self.must_hold(v);
        self.vertices[v.index()].tet.store(t.0, Relaxed);
    }

    /// Offers the vertex one of its tetrahedra. It keeps the one with the least id of all that are offered.
    #[inline]
    pub(in crate::adapt::core) fn offer_tet(&self, v: VertexId, t: TetId) {
        let first = &self.vertices[v.index()].tet;
        if t.0 < first.load(Relaxed) {
            first.fetch_min(t.0, Relaxed);
        }
    }

    /// Whether the vertex is alive.
    #[inline(always)]
    pub fn is_vertex(&self, v: VertexId) -> bool {
        self.tet_of(v).is_some()
    }

    /// The model entity the vertex lies on.
    #[inline(always)]
    pub fn entity(&self, v: VertexId) -> Entity {
        self.must_hold(v);
        unpack(self.places[v.index()].entity.load(Relaxed))
    }

    /// Dimension of the entity: 0 corner, 1 ridge, 2 surface, 3 interior.
    #[inline(always)]
    pub fn dimension(&self, v: VertexId) -> u32 {
        self.must_hold(v);
        self.places[v.index()].entity.load(Relaxed) >> INDEX_BITS
    }

    /// Parameters on the entity.
    #[inline(always)]
    pub fn parameters(&self, v: VertexId) -> [f64; 2] {
        self.must_hold(v);
        load(&self.places[v.index()].parameters)
    }

    /// Sets entity and parameters.
    #[inline]
    pub(in crate::adapt::core) fn set_place(&self, v: VertexId, entity: Entity, parameters: [f64; 2]) {
        self.must_hold(v);
        let place = &self.places[v.index()];
        place.entity.store(pack(entity), Relaxed);
        save(&place.parameters, parameters);
    }

    /// The background tetrahedron that last held the vertex.
    #[inline(always)]
    pub fn hint(&self, v: VertexId) -> u32 {
        self.must_hold(v);
        self.places[v.index()].hint.load(Relaxed)
    }

    /// Sets the hint.
    #[inline(always)]
    pub(in crate::adapt::core) fn set_hint(&self, v: VertexId, hint: u32) {
        self.must_hold(v);
        self.places[v.index()].hint.store(hint, Relaxed);
    }

    // ---- ridges

    /// Sets the two ridge neighbours of a vertex on a model edge.
    pub(in crate::adapt::core) fn set_ridge(&self, v: VertexId, ends: [VertexId; 2]) {
        self.must_hold(v);
        for (slot, end) in self.places[v.index()].ridge.iter().zip(ends) {
            slot.store(end.0, Relaxed);
        }
    }

    /// The two ridge neighbours of a vertex on a model edge.
    #[inline]
    pub fn ridge(&self, v: VertexId) -> [VertexId; 2] {
        self.must_hold(v);
        std::array::from_fn(|i| VertexId(self.places[v.index()].ridge[i].load(Relaxed)))
    }

    /// Gives a corner its ridges. Only while the store is being filled.
    pub(in crate::adapt::core) fn set_corner(&mut self, v: VertexId, ridges: Vec<(VertexId, u32)>) {
        let list = ridges.into_iter().map(|(other, curve)| CornerRidge { other: AtomicU32::new(other.0), curve });
        self.places[v.index()].ridge[0].store(self.corners.len() as u32, Relaxed);
        self.corners.push(list.collect());
    }

    /// The ridges that leave a corner: other end and model edge.
    pub fn corner_ridges(&self, v: VertexId) -> impl Iterator<Item = (VertexId, u32)> + '_ {
        self.must_hold(v);
        let index = self.places[v.index()].ridge[0].load(Relaxed) as usize;
        self.corners[index].iter().map(|ridge| (VertexId(ridge.other.load(Relaxed)), ridge.curve))
    }

    /// The model edge that the mesh edge lies on, if it is a ridge.
    #[inline]
    pub fn ridge_curve(&self, a: VertexId, b: VertexId) -> Option<u32> {
        match (self.entity(a), self.entity(b)) {
            (Entity::Edge(curve), _) => self.ridge(a).contains(&b).then_some(curve),
            (_, Entity::Edge(curve)) => self.ridge(b).contains(&a).then_some(curve),
            (Entity::Vertex(_), Entity::Vertex(_)) => {
                self.corner_ridges(a).find(|&(other, _)| other == b).map(|(_, curve)| curve)
            }
            _ => None,
        }
    }

    /// Redirects the ridge v–old to v–new.
    pub(in crate::adapt::core) fn redirect_ridge(&self, v: VertexId, old: VertexId, new: VertexId) {
        self.must_hold(v);
        let place = &self.places[v.index()];
        let slot = if self.dimension(v) == 1 {
            place.ridge.iter().find(|end| end.load(Relaxed) == old.0)
        } else {
            let index = place.ridge[0].load(Relaxed) as usize;
            self.corners[index].iter().map(|ridge| &ridge.other).find(|other| other.load(Relaxed) == old.0)
        };
        slot.expect("a ridge is known at both of its ends").store(new.0, Relaxed);
    }
}
