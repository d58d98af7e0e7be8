//! A tetrahedron between the boundary and two others goes, and its inner faces are the boundary.
use super::access::Access;
use super::ids::{TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// Takes a claimed tetrahedron out; its neighbours behind these faces, claimed too, get surface triangles with the tag;
    /// the first vertices of both faces are the ends of the edge that goes.
    ///
    /// # Errors
    /// `Geometry` when something required would go.
    pub fn take_out_tet(&mut self, t: TetId, behind: [(TetId, [VertexId; 3]); 2], tag: u32) -> Result<(), Refusal> {
        // Of its edges that between the two surface triangles goes, from the one of these faces to the other.
        let gone = behind.map(|(_, [x, ..])| x);
        let stays = |a, b| !(gone.contains(&a) && gone.contains(&b));
        self.context.required.check(self.store, &[t], &[], stays)?;
        for (outside, face) in behind {
            let back = self.store.neighbours(outside).iter().position(|&m| m == t).expect("neighbours know each other");
            self.store.set_neighbour(outside, back, TetId::NONE);
            self.store.set_tag(outside, back, tag);
            self.store.touch(outside);
            face.iter().for_each(|&x| self.store.set_tet_of(x, outside));
        }
        self.store.kill_tet(t);
        self.state.id_pool.free_tet(t);
        Ok(())
    }
}
