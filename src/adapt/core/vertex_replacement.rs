//! A vertex inside goes onto a neighbour, by changes to the records that are there. For sweeps that remove most of a crowded mesh.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;

/// A tetrahedron of the ball that stays, with a vertex replaced.
#[derive(Clone, Copy)]
pub struct Kept {
    /// The tetrahedron.
    pub tet: TetId,
    /// Which of its vertices is replaced.
    pub local: usize,
    /// Its mean ratio then.
    pub quality: f64,
}

/// What becomes of the ball of a vertex that goes. Allocated once.
#[derive(Default)]
pub struct BallSplit {
    /// What stays.
    pub kept: Vec<Kept>,
    /// Tetrahedra at the edge that goes, with the places in them of the vertex that goes and of the one that it goes onto.
    pub gone: Vec<(TetId, [usize; 2])>,
}

impl<A: Access> Worker<'_, '_, A> {
    /// Whether w, in place of another vertex, comes into a new face whose vertices must not move; see [`Worker::commit`].
    fn joins_held_at(&self, w: VertexId, ball: &BallSplit) -> bool {
        let is_held = |[x, y]: [VertexId; 2]| self.context.is_frozen(x) && self.context.is_frozen(y);
        let was_there = |edge: [VertexId; 2]| {
            ball.gone.iter().any(|&(t, _)| edge.iter().all(|x| self.store.vertices(t).contains(x)))
        };
        let comes = |&Kept { tet, local, .. }: &Kept| {
            let [a, b, c] = FACE[local].map(|k| self.store.vertices(tet)[k]);
            [[a, b], [b, c], [c, a]].into_iter().any(|edge| is_held(edge) && !was_there(edge))
        };
        self.context.is_frozen(w) && ball.kept.iter().any(comes)
    }

    /// Writes w in place of v in the tetrahedra of its ball that stay, and makes neighbours of what lies on both sides of those that go. The
    /// whole ball is claimed, and what stays is positive.
    ///
    /// # Errors
    /// `Geometry` when something required would go, or a part of a larger mesh would get a face that another part may have too.
    pub fn replace_vertex(
        &mut self,
        v: VertexId,
        w: VertexId,
        tets: &[TetId],
        ball: &BallSplit,
    ) -> Result<(), Refusal> {
        // An edge without v and w also belongs to a tetrahedron that stays.
        self.context.required.check(self.store, tets, &[v], |x, y| x != v && y != v)?;
        if self.context.required.is_part() && self.joins_held_at(w, ball) {
            return Err(Refusal::Geometry);
        }
        let store = self.store;
        for &Kept { tet, local, quality } in &ball.kept {
            store.set_vertex(tet, local, w);
            store.set_quality(tet, quality);
            store.touch(tet);
            store.vertices(tet).iter().for_each(|&x| store.set_tet_of(x, tet));
        }
        let place = |at: TetId, of: TetId| store.neighbours(at).iter().position(|&n| n == of);
        for &(tet, [of_v, of_w]) in &ball.gone {
            let (neighbours, tag) = (store.neighbours(tet), store.tags(tet)[of_v]);
            let (beyond, kept) = (neighbours[of_v], neighbours[of_w]);
            let side = place(kept, tet).expect("neighbours know each other");
            store.set_neighbour(kept, side, beyond);
            store.set_tag(kept, side, tag);
            if beyond.is_some() {
                store.set_neighbour(beyond, place(beyond, tet).expect("neighbours know each other"), kept);
            }
        }
        for &(tet, _) in &ball.gone {
            store.kill_tet(tet);
            self.state.id_pool.free_tet(tet);
        }
        store.set_tet_of(v, TetId::NONE);
        self.state.id_pool.free_vertex(v);
        Ok(())
    }
}
