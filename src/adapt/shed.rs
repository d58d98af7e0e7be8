//! The flip that sheds a tetrahedron: two of its faces are surface triangles of one model face; it goes, and its other two faces are
//! the surface. On a curved wall long edges leave such tetrahedra, flat between four points of the wall.
use super::access::Access;
use super::ids::{FACE, TetId, VertexId};
use super::outcome::Refusal;
use super::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// Sheds a claimed tetrahedron at the surface edge a–b.
    ///
    /// # Errors
    /// `Topology` when a–b is not the edge of just two surface triangles of one face, both of this tetrahedron, or the edge across is on the
    /// surface already; `Geometry` when the edge must stay; `Normal` when the surface would turn from its model.
    pub fn shed(&mut self, t: TetId, a: VertexId, b: VertexId) -> Result<(), Refusal> {
        let (v, n, tags) = (self.store.vertices(t), self.store.neighbours(t), self.store.tags(t));
        // The faces with the edge a–b lie opposite c and d, those that will be the surface opposite a and b.
        let mut across = (0..4).filter(|&i| v[i] != a && v[i] != b);
        let (Some(c), Some(d)) = (across.next(), across.next()) else { return Err(Refusal::Topology) };
        let own = |x: VertexId| v.iter().position(|&y| y == x).ok_or(Refusal::Topology);
        let (i, j) = (own(a)?, own(b)?);
        let tag = tags[c];
        let is_surface = |k: usize| tags[k] == tag && !n[k].is_some();
        if tag == 0 || !is_surface(c) || !is_surface(d) || tags[i] != 0 || tags[j] != 0 {
            return Err(Refusal::Topology);
        }
        if self.store.ridge_curve(a, b).is_some() || self.context.required.has_edge(a, b) {
            return Err(Refusal::Geometry);
        }
        let ends = [v[c], v[d]];
        self.claim_tet(n[i])?;
        self.claim_tet(n[j])?;
        self.gather_shell(ends[0], ends[1], t)?;
        if !self.state.shell.closed || self.state.shell.surface_tags().next().is_some() {
            return Err(Refusal::Topology);
        }
        // Outward: as they were, and the new ones turned over.
        let outward = |k: usize| {
            let [x, y, z] = FACE[k].map(|l| v[l]);
            ([x, z, y], tag)
        };
        let inward = |k: usize| (FACE[k].map(|l| v[l]), tag);
        let facing = self.facing(&[outward(c), outward(d)]);
        self.compare_normals(facing, &[inward(i), inward(j)], 0.0)?;
        self.let_go(t, [(n[i], [b, ends[0], ends[1]]), (n[j], [a, ends[0], ends[1]])], tag);
        Ok(())
    }

    /// Takes the tetrahedron out; its neighbours behind these faces get surface triangles.
    fn let_go(&mut self, t: TetId, behind: [(TetId, [VertexId; 3]); 2], tag: u32) {
        for (outside, face) in behind {
            let back = self.store.neighbours(outside).iter().position(|&m| m == t).expect("neighbours know each other");
            self.store.set_neighbour(outside, back, TetId::NONE);
            self.store.set_tag(outside, back, tag);
            self.store.touch(outside);
            face.iter().for_each(|&x| self.store.set_tet_of(x, outside));
        }
        self.store.kill_tet(t);
        self.state.pool.free_tet(t);
    }
}
