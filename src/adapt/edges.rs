//! The edges of the mesh that are too long or too short: what is to be split and collapsed.
use super::ids::{TetId, VertexId};
use super::insert::EdgeItem;
use super::store::Store;
use crate::mesh::vector::sub;
use crate::metric::quality::edge_length;

/// An edge and its length in the metric.
pub struct Measured {
    /// The edge, the lesser vertex first, with the least of its tetrahedra.
    pub item: EdgeItem,
    /// Its length, in single precision: there are very many.
    pub length: f32,
}

/// The edges whose length passes the test, each once, in no particular order; of those that have an end where something
/// changed (`changed`, by vertex). Between sweeps only.
///
/// Each vertex is asked for its edges to greater ones, so that no list of all edges of all tetrahedra is made and sorted.
pub fn measured(store: &Store, changed: &[bool], wanted: impl Fn(f64) -> bool) -> Vec<Measured> {
    let mut found = Vec::new();
    let mut ball = Ball::new(store);
    for a in store.live_vertices().filter(|a| changed[a.index()]) {
        ball.gather(a);
        for &(b, tet) in &ball.edges {
            // Both ends changed: the edge is found at the lesser one.
            if b < a && changed[b.index()] {
                continue;
            }
            let v = sub(store.position(b), store.position(a));
            let length = edge_length(v, &store.metric(a), &store.metric(b));
            if wanted(length) {
                let item = EdgeItem { a: a.min(b), b: a.max(b), tet };
                found.push(Measured { item, length: length as f32 });
            }
        }
    }
    found
}

/// The edges at one vertex.
struct Ball<'s> {
    store: &'s Store,
    /// The vertex for which a tetrahedron was last seen, by tetrahedron.
    seen: Vec<VertexId>,
    /// The vertex whose edge to it is known, by vertex, and that edge's place in `edges`.
    known: Vec<(VertexId, u32)>,
    tets: Vec<TetId>,
    /// The other ends, each with the least tetrahedron.
    edges: Vec<(VertexId, TetId)>,
}

impl<'s> Ball<'s> {
    fn new(store: &'s Store) -> Self {
        Self {
            store,
            seen: vec![VertexId::NONE; store.tet_bound()],
            known: vec![(VertexId::NONE, 0); store.vertex_bound()],
            tets: Vec::new(),
            edges: Vec::new(),
        }
    }

    /// Collects the edges at a.
    fn gather(&mut self, a: VertexId) {
        self.edges.clear();
        self.tets.clear();
        let first = self.store.tet_of(a);
        self.tets.push(first);
        self.seen[first.index()] = a;
        let mut next = 0;
        while let Some(&t) = self.tets.get(next) {
            next += 1;
            let (vertices, neighbours) = (self.store.vertices(t), self.store.neighbours(t));
            for (b, n) in vertices.into_iter().zip(neighbours).filter(|&(b, _)| b != a) {
                if n.is_some() && self.seen[n.index()] != a {
                    self.seen[n.index()] = a;
                    self.tets.push(n);
                }
                let (of, place) = &mut self.known[b.index()];
                if *of == a {
                    let tet = &mut self.edges[*place as usize].1;
                    *tet = t.min(*tet);
                } else {
                    (*of, *place) = (a, self.edges.len() as u32);
                    self.edges.push((b, t));
                }
            }
        }
    }
}
