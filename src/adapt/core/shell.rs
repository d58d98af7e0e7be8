//! The tetrahedra about an edge.
use super::access::Access;
use super::ids::{ACROSS, TetId, VertexId, place_of};
use super::refusal::Refusal;
use super::worker::Worker;

/// An edge with more tetrahedra than this is left alone.
const MOST: usize = 256;

/// The tetrahedra about the edge a–b in turn: `tets[i]` is (a, b, `ring[i]`, `ring[i + 1]`) in positive order.
/// Inside the domain the ring is closed and `ring` does not repeat its first vertex; an edge on the
/// boundary has an open ring with one vertex more than tetrahedra.
#[derive(Default)]
pub struct Shell {
    /// Tetrahedra in turn.
    pub tets: Vec<TetId>,
    /// Vertices in turn.
    pub ring: Vec<VertexId>,
    /// Whether it goes all the way around.
    pub closed: bool,
    /// Tags of the faces (a, b, `ring[i]`).
    pub tags: Vec<u32>,
}

impl Shell {
    /// Tags of the surface triangles at the edge: an edge on the boundary or an interface has two or more.
    pub fn surface_tags(&self) -> impl Iterator<Item = u32> + '_ {
        self.tags.iter().copied().filter(|&tag| tag != 0)
    }

    /// Whether the edge is one of another part of the mesh too: a face about it has neither a tetrahedron behind it nor a tag.
    pub fn is_shared(&self) -> bool {
        !self.closed && [self.tags.first(), self.tags.last()].contains(&Some(&0))
    }

    /// Turns a closed shell so that it begins at a tagged face, if there is one.
    pub fn begin_at_tag(&mut self) {
        let at = self.tags.iter().position(|&tag| tag != 0).unwrap_or(0);
        self.tets.rotate_left(at);
        self.ring.rotate_left(at);
        self.tags.rotate_left(at);
    }
}

impl<A: Access> Worker<'_, '_, A> {
    /// Local indices in t of the vertices that follow a and b in positive order.
    #[inline]
    fn turn(&self, t: TetId, a: VertexId, b: VertexId) -> Option<[usize; 2]> {
        let v = self.store.vertices(t);
        let (i, j) = (place_of(a, v), place_of(b, v));
        (v[i] == a && v[j] == b).then(|| ACROSS[i][j])
    }

    /// Collects the shell of the edge a–b, both claimed, from a tetrahedron that holds it; claims the ring.
    pub fn gather_shell(&mut self, a: VertexId, b: VertexId, start: TetId) -> Result<(), Refusal> {
        self.gather_shell_while(a, b, start, MOST, |_, _| true)
    }

    /// As [`Worker::gather_shell`], but it ends as `Stale` at the first tetrahedron that is not wanted, and as `Topology` when there are
    /// more than `most`.
    pub fn gather_shell_while(
        &mut self,
        a: VertexId,
        b: VertexId,
        start: TetId,
        most: usize,
        wanted: impl Fn(&Self, TetId) -> bool,
    ) -> Result<(), Refusal> {
        let mut shell = std::mem::take(&mut self.state.shell);
        let mut result = self.turn_around((a, b), start, most, &mut shell, &wanted);
        if result.is_ok() && !shell.closed {
            // The walk ended on the boundary: the shell begins at its other end.
            result = self.rewind(a, b, start).and_then(|first| match first == start {
                true => Ok(()),
                false => self.turn_around((a, b), first, most, &mut shell, &wanted),
            });
        }
        self.state.shell = shell;
        result
    }

    fn turn_around(
        &mut self,
        (a, b): (VertexId, VertexId),
        first: TetId,
        most: usize,
        shell: &mut Shell,
        wanted: &impl Fn(&Self, TetId) -> bool,
    ) -> Result<(), Refusal> {
        shell.tets.clear();
        shell.ring.clear();
        shell.tags.clear();
        let mut t = first;
        loop {
            if !wanted(self, t) {
                return Err(Refusal::Stale);
            }
            let [k, l] = self.turn(t, a, b).ok_or(Refusal::Topology)?;
            let (v, n, tags) = (self.store.vertices(t), self.store.neighbours(t), self.store.tags(t));
            if t == first {
                self.claim(v[k])?;
            }
            // It is the v[k] of the next tetrahedron.
            self.claim(v[l])?;
            shell.tets.push(t);
            shell.ring.push(v[k]);
            self.store.fetch_vertex(v[k]);
            // The face (a, b, ring[i]) lies opposite ring[i + 1], and the next one opposite ring[i].
            shell.tags.push(tags[l]);
            t = n[k];
            shell.closed = t == first;
            if shell.closed {
                return Ok(());
            }
            if !t.is_some() {
                shell.ring.push(v[l]);
                shell.tags.push(tags[k]);
                return Ok(());
            }
            if shell.tets.len() >= most {
                return Err(Refusal::Topology);
            }
        }
    }

    /// The tetrahedron where an open shell begins.
    fn rewind(&self, a: VertexId, b: VertexId, start: TetId) -> Result<TetId, Refusal> {
        let mut t = start;
        for _ in 0..MOST {
            let [_, l] = self.turn(t, a, b).ok_or(Refusal::Topology)?;
            let before = self.store.neighbour(t, l);
            if !before.is_some() {
                return Ok(t);
            }
            t = before;
        }
        Err(Refusal::Topology)
    }
}
