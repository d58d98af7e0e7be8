//! Renumbering along a space-filling curve: what is near in space comes near in memory, and dead records go. All in place.
use super::{ROOM, Store, rehouse};
use crate::adapt::ids::{TetId, VertexId};
use crate::adapt::numbering::{by_first, permute};
use crate::geometry::Entity;
use crate::mesh::hilbert;
use crate::mesh::vector::Vec3;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

impl Store {
    /// Numbers the mesh along the Hilbert curve; returns for each old vertex id the new one (`NONE` for dead ones). Blocks of ids
    /// that were taken before mean nothing any more. Between sweeps only.
    pub fn reorder(&mut self) -> Vec<VertexId> {
        if self.ordered == Some(self.clock()) {
            return (0..self.vertex_bound() as u32).map(VertexId).collect();
        }
        let bounds = [self.vertex_bound(), self.tet_bound()];
        let mut number = self.compact_vertices();
        let mut tet_number = self.compact_tets();
        self.shrink(bounds);
        let (order, place) = self.vertices_along_curve();
        number.iter_mut().filter(|v| v.is_some()).for_each(|v| *v = place[v.index()]);
        drop(place);
        // Only now, when the vertices have their numbers, the order of the tetrahedra is known.
        let first = |t: usize| self.vertices(TetId(t as u32)).map(|v| number[v.index()].0).into_iter().min();
        let (tets, place) = by_first(self.tet_bound(), order.len(), |t| first(t).unwrap_or(0));
        tet_number.iter_mut().filter(|t| t.is_some()).for_each(|t| *t = place[t.index()]);
        drop(place);
        permute(order, |i, j| {
            self.vertices.swap(i, j);
            self.places.swap(i, j);
        });
        permute(tets, |i, j| self.tets.swap(i, j));
        self.renumber_vertices(&number);
        self.renumber_tets(&number, &tet_number);
        self.note_order();
        number
    }

    /// Notes that the ids are in the order of the curve, until the next sweep.
    pub fn note_order(&mut self) {
        self.ordered = Some(self.clock());
    }

    /// Moves the live vertices to the front, in their order; returns for each old id the new one.
    fn compact_vertices(&mut self) -> Vec<VertexId> {
        let mut number = vec![VertexId::NONE; self.vertex_bound()];
        let mut live = 0;
        for v in 0..number.len() {
            if self.is_vertex(VertexId(v as u32)) {
                number[v] = VertexId(live as u32);
                if v != live {
                    self.vertices.swap(v, live);
                    self.places.swap(v, live);
                }
                live += 1;
            }
        }
        self.next_vertex = AtomicUsize::new(live);
        number
    }

    /// As [`Store::compact_vertices`], for tetrahedra.
    fn compact_tets(&mut self) -> Vec<TetId> {
        let mut number = vec![TetId::NONE; self.tet_bound()];
        let mut live = 0;
        for t in 0..number.len() {
            if self.is_tet(TetId(t as u32)) {
                number[t] = TetId(live as u32);
                if t != live {
                    self.tets.swap(t, live);
                }
                live += 1;
            }
        }
        self.next_tet = AtomicUsize::new(live);
        number
    }

    /// The order of the vertices along the curve, and the place of each in it.
    fn vertices_along_curve(&self) -> (Vec<u32>, Vec<VertexId>) {
        let points: Vec<Vec3> = self.live_vertices().map(|v| self.position(v)).collect();
        let order = hilbert::order(&points);
        let mut place = vec![VertexId::NONE; order.len()];
        order.iter().zip(0..).for_each(|(&old, new)| place[old as usize] = VertexId(new));
        (order, place)
    }

    /// Renumbers the ridges.
    fn renumber_vertices(&mut self, number: &[VertexId]) {
        let renumber = |v: VertexId| if v.is_some() { number[v.index()] } else { v };
        for v in self.live_vertices().filter(|&v| matches!(self.entity(v), Entity::Edge(_))) {
            self.set_ridge(v, self.ridge(v).map(renumber));
        }
        for ridge in self.corners.iter().flatten() {
            ridge.other.store(number[ridge.other.load(Relaxed) as usize].0, Relaxed);
        }
    }

    /// Renumbers vertices and neighbours of the tetrahedra, and the tetrahedra of the vertices.
    fn renumber_tets(&self, number: &[VertexId], tet_number: &[TetId]) {
        for t in self.live_tets() {
            let record = &self.tets[t.index()];
            let vertices = self.vertices(t).map(|v| number[v.index()]);
            for i in 0..4 {
                record.vertices[i].store(vertices[i].0, Relaxed);
                let n = record.neighbours[i].load(Relaxed);
                if n != TetId::NONE.0 {
                    record.neighbours[i].store(tet_number[n as usize].0, Relaxed);
                }
            }
            vertices.iter().for_each(|&v| self.set_tet_of(v, t));
        }
    }

    /// Gives back the memory of dead records, if they were many.
    fn shrink(&mut self, bounds: [usize; 2]) {
        let (vertices, tets) = (self.vertex_bound(), self.tet_bound());
        if vertices < bounds[0] - bounds[0] / 8 {
            rehouse(&mut self.vertices, vertices, 2 * vertices + ROOM);
            rehouse(&mut self.places, vertices, 2 * vertices + ROOM);
        }
        if tets < bounds[1] - bounds[1] / 8 {
            rehouse(&mut self.tets, tets, 2 * tets + 6 * ROOM);
        }
    }
}
