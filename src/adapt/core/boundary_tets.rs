//! Removes a tetrahedron with two faces on the boundary; its two inner faces become the boundary.
use super::access::Access;
use super::ids::{TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a claimed tetrahedron. `behind` are its two neighbours, claimed too, with the faces that become surface triangles with
    /// this tag. The first vertices of these faces are the ends of the edge that goes.
    ///
    /// # Errors
    /// `Geometry` when something required would go.
    pub fn take_out_tet(&mut self, t: TetId, behind: [(TetId, [VertexId; 3]); 2], tag: u32) -> Result<(), Refusal> {
        // One edge goes: that between the two old surface triangles, whose ends are the first vertices of the two faces.
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
