//! The tetrahedra at a vertex and the vertices joined to it.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::refusal::Refusal;
use super::worker::{State, Worker};

/// The ball of a vertex. Allocated once.
#[derive(Default)]
pub struct Ball {
    /// Its tetrahedra.
    pub tets: Vec<TetId>,
    /// The vertices joined to it.
    pub link: Vec<VertexId>,
    /// From which tetrahedron each was reached.
    from: Vec<TetId>,
}

impl<A: Access> Worker<'_, '_, A> {
    /// Collects the ball of a claimed vertex and claims all vertices joined to it.
    pub fn gather_ball(&mut self, v: VertexId, ball: &mut Ball) -> Result<(), Refusal> {
        self.collect_ball(v, ball);
        ball.link.iter().try_for_each(|&x| self.claim(x))
    }

    /// Collects the ball of a claimed vertex, claiming no other.
    pub fn collect_ball(&mut self, v: VertexId, ball: &mut Ball) {
        let State { set, near, .. } = &mut *self.state;
        let Ball { tets, link, from } = ball;
        tets.clear();
        link.clear();
        from.clear();
        set.clear();
        near.clear();
        let first = self.store.tet_of(v);
        tets.push(first);
        from.push(TetId::NONE);
        set.insert(first.0);
        link.extend(self.store.vertices(first).into_iter().filter(|&x| x != v));
        link.iter().for_each(|x| {
            near.insert(x.0);
        });
        let mut next = 0;
        while next < tets.len() {
            let (t, before) = (tets[next], from[next]);
            next += 1;
            let (vertices, neighbours) = (self.store.vertices(t), self.store.neighbours(t));
            for i in 0..4 {
                let n = neighbours[i];
                if n == before && n.is_some() {
                    // Of the four vertices only the one beyond the face that led here can be new.
                    if near.insert(vertices[i].0) {
                        link.push(vertices[i]);
                    }
                } else if vertices[i] != v && n.is_some() && set.insert(n.0) {
                    tets.push(n);
                    from.push(t);
                }
            }
        }
    }

    /// Worst kept mean ratio of some tetrahedra.
    pub fn worst_of(&self, tets: &[TetId]) -> f64 {
        tets.iter().map(|&t| self.store.quality(t)).fold(f64::INFINITY, f64::min)
    }

    /// Adds the surface triangles at v to the list, outward, with their tags.
    pub fn list_surface(&self, v: VertexId, tets: &[TetId], triangles: &mut Vec<([VertexId; 3], u32)>) {
        if self.store.dimension(v) == 3 {
            return;
        }
        for &t in tets {
            let (w, tags, n) = (self.store.vertices(t), self.store.tags(t), self.store.neighbours(t));
            for i in
                (0..4).filter(|&i| tags[i] != 0 && w[i] != v && w.contains(&v) && self.store.lists_triangle(t, n[i]))
            {
                let [a, b, c] = FACE[i].map(|k| w[k]);
                triangles.push(([a, c, b], tags[i]));
            }
        }
    }
}
