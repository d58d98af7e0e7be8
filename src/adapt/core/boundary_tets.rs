//! Removes a tetrahedron with two faces on the boundary; its two inner faces become the boundary.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::refusal::Refusal;
use super::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a claimed tetrahedron. `behind` are its two neighbours, claimed too, with the faces that become surface triangles with
    /// this tag. The first vertices of these faces are the ends of the edge that goes.
    ///
    /// # Errors
    /// `Geometry` when something required would go, `Crossing` when the boundary would pass through itself.
    pub fn take_out_tet(&mut self, t: TetId, behind: [(TetId, [VertexId; 3]); 2], tag: u32) -> Result<(), Refusal> {
        // One edge goes: that between the two old surface triangles, whose ends are the first vertices of the two faces.
        let gone = behind.map(|(_, [x, ..])| x);
        let stays = |a, b| !(gone.contains(&a) && gone.contains(&b));
        self.context.required.check(self.store, &[t], &[], stays)?;
        let store = self.store;
        let back = |outside: TetId| {
            store.neighbours(outside).iter().position(|&m| m == t).expect("neighbours know each other")
        };
        let change = &mut self.state.surface_change;
        change.clear();
        let (v, n) = (store.vertices(t), store.neighbours(t));
        (0..4).filter(|&i| !n[i].is_some()).for_each(|i| change.goes(FACE[i].map(|k| v[k])));
        for (outside, _) in behind {
            let corners = store.vertices(outside);
            change.comes(FACE[back(outside)].map(|k| corners[k]), |x| store.position(x));
        }
        let guarded = self.guard()?;
        for (outside, face) in behind {
            let back = back(outside);
            self.store.set_neighbour(outside, back, TetId::NONE);
            self.store.set_tag(outside, back, tag);
            self.store.touch(outside);
            face.iter().for_each(|&x| self.store.set_tet_of(x, outside));
        }
        self.store.kill_tet(t);
        self.state.id_pool.free_tet(t);
        self.note_surface(guarded);
        Ok(())
    }
}
