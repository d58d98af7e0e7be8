//! Renumbering along a space-filling curve: what is near in space comes near in memory, and dead records go.
use super::{CornerRidge, Store};
use crate::adapt::ids::{TetId, VertexId};
use crate::geometry::Entity;
use crate::mesh::hilbert;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

impl Store {
    /// The same mesh with its ids in the order of the Hilbert curve, and for each old vertex id the new one (`NONE` for
    /// dead ones). Blocks of ids that were taken from this store mean nothing in the new one.
    pub fn reordered(&self) -> (Store, Vec<VertexId>) {
        let order = self.vertices_along_curve();
        let mut number = vec![VertexId::NONE; self.vertex_bound()];
        order.iter().enumerate().for_each(|(new, old)| number[old.index()] = VertexId(new as u32));
        let first = |t: TetId| self.vertices(t).map(|v| number[v.index()]).into_iter().min();
        let mut tets: Vec<TetId> = self.live_tets().collect();
        tets.sort_by_cached_key(|&t| first(t));
        let mut tet_number = vec![TetId::NONE; self.tet_bound()];
        tets.iter().enumerate().for_each(|(new, old)| tet_number[old.index()] = TetId(new as u32));

        let mut store = Store::with_capacity(self.vertices.len(), self.tets.len());
        store.take_vertices(order.len()).expect("the new store is as large");
        store.take_tets(tets.len()).expect("the new store is as large");
        store.clock.store(self.clock(), Relaxed);
        for (new, &old) in order.iter().enumerate() {
            self.copy_vertex(old, &store, VertexId(new as u32), &number);
        }
        for (new, &old) in tets.iter().enumerate() {
            self.copy_tet(old, &store, TetId(new as u32), &number, &tet_number);
        }
        let renumbered = |ridge: &CornerRidge| CornerRidge {
            other: AtomicU32::new(number[ridge.other.load(Relaxed) as usize].0),
            curve: ridge.curve,
        };
        store.corners = self.corners.iter().map(|ridges| ridges.iter().map(renumbered).collect()).collect();
        (store, number)
    }

    fn vertices_along_curve(&self) -> Vec<VertexId> {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for v in self.live_vertices() {
            let p = self.position(v);
            low = std::array::from_fn(|i| low[i].min(p[i]));
            high = std::array::from_fn(|i| high[i].max(p[i]));
        }
        let mut order: Vec<VertexId> = self.live_vertices().collect();
        order.sort_by_cached_key(|&v| hilbert::key(self.position(v), low, high));
        order
    }

    fn copy_vertex(&self, old: VertexId, to: &Store, new: VertexId, number: &[VertexId]) {
        to.set_position(new, self.position(old));
        to.set_metric(new, &self.log(old), &self.metric(old));
        to.set_place(new, self.entity(old), self.parameters(old));
        to.set_hint(new, self.hint(old));
        match self.entity(old) {
            Entity::Edge(_) => {
                let renumber = |v: VertexId| if v.is_some() { number[v.index()] } else { v };
                to.set_ridge(new, self.ridge(old).map(renumber));
            }
            // The place of a corner's list.
            _ => to.places[new.index()].ridge[0].store(self.places[old.index()].ridge[0].load(Relaxed), Relaxed),
        }
    }

    fn copy_tet(&self, old: TetId, to: &Store, new: TetId, number: &[VertexId], tet_number: &[TetId]) {
        let vertices = self.vertices(old).map(|v| number[v.index()]);
        to.write_tet(new, vertices, self.region(old), self.quality(old));
        to.tets[new.index()].stamp.store(self.stamp(old), Relaxed);
        to.tets[new.index()].moved.store(self.moved(old), Relaxed);
        let (neighbours, tags) = (self.neighbours(old), self.tags(old));
        for i in 0..4 {
            let n = neighbours[i];
            to.set_neighbour(new, i, if n.is_some() { tet_number[n.index()] } else { n });
            to.set_tag(new, i, tags[i]);
        }
        vertices.iter().for_each(|&v| to.set_tet_of(v, new));
    }
}
