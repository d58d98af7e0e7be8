//! The tetrahedra at a vertex and the vertices joined to it.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId, place_of};
use super::refusal::Refusal;
use super::worker::{State, Worker};
use crate::mesh::stamped_set::StampedSet;

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

/// The local vertices other than i, ascending.
const FACE_ASCENDING: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/// The local vertices other than i and j, ascending.
const OTHERS: [[[usize; 2]; 4]; 4] = [
    [[0, 0], [2, 3], [1, 3], [1, 2]],
    [[2, 3], [0, 0], [0, 3], [0, 2]],
    [[1, 3], [0, 3], [0, 0], [0, 1]],
    [[1, 2], [0, 2], [0, 1], [0, 0]],
];

/// Lists a neighbour and from where it was reached, unless it is listed already, or there is none.
#[inline(always)]
fn add(set: &mut StampedSet, (tets, from): (&mut Vec<TetId>, &mut Vec<TetId>), n: TetId, t: TetId) {
    if n.is_some() {
        let is_new = set.insert(n.0);
        tets.push(n);
        from.push(t);
        let len = tets.len() - usize::from(!is_new);
        tets.truncate(len);
        from.truncate(len);
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Collects the ball of a claimed vertex and claims all vertices joined to it.
    pub fn gather_ball(&mut self, v: VertexId, ball: &mut Ball) -> Result<(), Refusal> {
        self.collect_ball(v, ball);
        ball.link.iter().try_for_each(|&x| self.claim(x))
    }

    /// Collects the ball of a claimed vertex, claiming no other.
    pub fn collect_ball(&mut self, v: VertexId, ball: &mut Ball) {
        self.walk_ball(v, ball, |_| false);
    }

    /// A tetrahedron with both vertices, the first of which is claimed; none when no edge joins them.
    pub fn find_tet_with(&mut self, v: VertexId, other: VertexId) -> Option<TetId> {
        let mut ball = std::mem::take(&mut self.state.unclaimed_ball);
        let found = self.walk_ball(v, &mut ball, |vertices| vertices.contains(&other));
        self.state.unclaimed_ball = ball;
        found
    }

    /// Collects the ball of a claimed vertex, up to the first tetrahedron that is wanted.
    ///
    /// What is met again and what is new comes in no order, so all is listed, and taken back if it was there.
    fn walk_ball(&mut self, v: VertexId, ball: &mut Ball, wanted: impl Fn([VertexId; 4]) -> bool) -> Option<TetId> {
        let State { set, near, .. } = &mut *self.state;
        let Ball { tets, link, from } = ball;
        tets.clear();
        link.clear();
        from.clear();
        set.clear();
        near.clear();
        let first = self.store.tet_of(v);
        set.insert(first.0);
        tets.push(first);
        from.push(TetId::NONE);
        for (x, n) in self.store.vertices(first).into_iter().zip(self.store.neighbours(first)).filter(|&(x, _)| x != v)
        {
            near.insert(x.0);
            link.push(x);
            self.store.fetch_vertex(x);
            self.store.fetch_tet(n);
        }
        let mut next = 0;
        while next < tets.len() {
            let (t, before) = (tets[next], from[next]);
            next += 1;
            let (vertices, neighbours) = (self.store.vertices(t), self.store.neighbours(t));
            if wanted(vertices) {
                return Some(t);
            }
            let own = place_of(v, vertices);
            let [one, two] = if t == first {
                let [one, two, three] = FACE_ASCENDING[own];
                add(set, (tets, from), neighbours[one], t);
                [two, three]
            } else {
                // Of the four vertices only the one beyond the face that led here can be new.
                let back = place_of(before, neighbours);
                let x = vertices[back];
                self.store.fetch_vertex(x);
                let is_new = near.insert(x.0);
                link.push(x);
                link.truncate(link.len() - usize::from(!is_new));
                OTHERS[own][back]
            };
            for n in [neighbours[one], neighbours[two]] {
                self.store.fetch_tet(n);
                add(set, (tets, from), n, t);
            }
        }
        None
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Exclusive;
    use crate::adapt::core::worker::Worker;
    use crate::adapt::tests::bench::{Bench, Shape, sample};
    use std::collections::BTreeSet;

    /// Of each vertex all tetrahedra and neighbours once, and for each other vertex whether an edge joins them.
    #[test]
    fn a_ball_has_all_at_its_vertex_once() {
        let sample = sample(Shape::Cube, 3, 0.4);
        let mut bench = Bench::new(&sample, 1, 5);
        let (context, states) = (&bench.context, &mut bench.states);
        let mut worker = Worker::new(context, &mut states[0], Exclusive);
        let (store, mut ball) = (worker.store, Ball::default());
        for v in store.live_vertices() {
            let tets: BTreeSet<_> = store.live_tets().filter(|&t| store.vertices(t).contains(&v)).collect();
            let link: BTreeSet<_> =
                tets.iter().flat_map(|&t| store.vertices(t)).filter(|&x| x != v).map(|x| x.0).collect();
            worker.collect_ball(v, &mut ball);
            assert_eq!((ball.tets.len(), ball.link.len()), (tets.len(), link.len()));
            assert_eq!(ball.tets.iter().copied().collect::<BTreeSet<_>>(), tets);
            assert_eq!(ball.link.iter().map(|x| x.0).collect::<BTreeSet<_>>(), link);
            for x in store.live_vertices().filter(|&x| x != v) {
                let found = worker.find_tet_with(v, x);
                assert_eq!(found.is_some(), link.contains(&x.0));
                assert!(found.is_none_or(|t| tets.contains(&t) && store.vertices(t).contains(&x)));
            }
        }
    }

    #[test]
    fn the_other_local_vertices_ascend() {
        for i in 0..4 {
            assert!(FACE_ASCENDING[i].iter().copied().eq((0..4).filter(|&k| k != i)));
            for j in (0..4).filter(|&j| j != i) {
                assert!(OTHERS[i][j].iter().copied().eq((0..4).filter(|&k| k != i && k != j)));
            }
        }
    }
}
