//! Triangles that come and go, found by their place. They are kept in an R*-tree: those in thin layers are so flat that a grid would have
//! thousands of them in a cell.
use super::bounds;
use crate::adapt::core::ids::VertexId;
use crate::mesh::triangle_pair::{Corners, crossing};
use rstar::{AABB, RTree, RTreeObject};
use std::collections::HashMap;

/// A triangle's vertices, ascending: which triangle it is, whichever way it is seen.
pub type Key = [VertexId; 3];

/// The key of a triangle of these vertices.
pub fn key(mut vertices: [VertexId; 3]) -> Key {
    vertices.sort_unstable();
    vertices
}

/// A boundary triangle, seen from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its vertices, so that the normal points out of the mesh.
    pub vertices: [VertexId; 3],
    /// Where they are, in this order.
    pub corners: Corners,
}

impl Triangle {
    /// Which it is.
    pub fn key(&self) -> Key {
        key(self.vertices)
    }
}

impl RTreeObject for Triangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [low, high] = bounds(&self.corners, 0.0);
        AABB::from_corners(low, high)
    }
}

/// The triangles.
#[derive(Default)]
pub struct Triangles {
    of: HashMap<Key, Triangle>,
    placed: RTree<Triangle>,
}

impl Triangles {
    /// These triangles, each with other vertices.
    pub fn new(all: Vec<Triangle>) -> Self {
        Self { of: all.iter().map(|triangle| (triangle.key(), *triangle)).collect(), placed: RTree::bulk_load(all) }
    }

    /// Adds a triangle; one of the same vertices goes.
    pub fn insert(&mut self, triangle: Triangle) {
        self.remove(&triangle.key());
        self.of.insert(triangle.key(), triangle);
        self.placed.insert(triangle);
    }

    /// Takes a triangle out, if it is there.
    pub fn remove(&mut self, key: &Key) {
        if let Some(triangle) = self.of.remove(key) {
            self.placed.remove(&triangle);
        }
    }

    /// The triangle of these vertices, if it is there.
    pub fn get(&self, key: &Key) -> Option<&Triangle> {
        self.of.get(key)
    }

    /// How many there are.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.placed.size()
    }

    /// Pairs that cross, of `some` triangles with each other and with those that are here, but not those that are `left_out`.
    pub fn crossings(&self, some: &[Triangle], left_out: impl Fn(&Key) -> bool) -> usize {
        let mut count = 0;
        for (i, triangle) in some.iter().enumerate() {
            let Triangle { vertices, corners } = triangle;
            let is_met = |other: &&Triangle| crossing((vertices, corners), (&other.vertices, &other.corners)).is_some();
            count += some[..i].iter().filter(is_met).count();
            let near = self.placed.locate_in_envelope_intersecting(triangle.envelope());
            count += near.filter(|other| !left_out(&other.key())).filter(is_met).count();
        }
        count
    }
}
