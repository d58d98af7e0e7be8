//! Records that will be read soon are asked for ahead, so that the processor does not wait for memory when they are.
use super::super::ids::{TetId, VertexId};
use super::Store;
use std::sync::atomic::Ordering::Relaxed;

/// Bytes of a cache line.
const LINE: usize = 64;

/// Asks for the cache line that holds an address. Any address will do: where there is nothing, nothing happens.
#[inline(always)]
pub(super) fn fetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing that the program sees, and faults at no address.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(at.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}

impl Store {
    /// Asks for a tetrahedron's record; the id may be none.
    #[inline(always)]
    pub fn fetch_tet(&self, t: TetId) {
        fetch(self.tets.as_ptr().wrapping_add(t.0 as usize));
    }

    /// Asks for a vertex's record; the id may be none.
    #[inline(always)]
    pub fn fetch_vertex(&self, v: VertexId) {
        let record = self.vertices.as_ptr().wrapping_add(v.0 as usize);
        fetch(record);
        fetch(record.cast::<u8>().wrapping_add(LINE));
    }

    /// Asks for the records of a tetrahedron's vertices. It need not be held, or be there.
    #[inline(always)]
    pub fn fetch_vertices(&self, t: TetId) {
        let Some(record) = self.tets.get(t.0 as usize) else { return };
        record.vertices.iter().for_each(|v| self.fetch_vertex(VertexId(v.load(Relaxed))));
    }

    /// Asks for the records of a tetrahedron's vertices and neighbours. It need not be held, or be there.
    #[inline(always)]
    pub fn fetch_about(&self, t: TetId) {
        let Some(record) = self.tets.get(t.0 as usize) else { return };
        record.neighbours.iter().for_each(|n| self.fetch_tet(TetId(n.load(Relaxed))));
        record.vertices.iter().for_each(|v| self.fetch_vertex(VertexId(v.load(Relaxed))));
    }

    /// Asks for the records of the neighbours of a tetrahedron's neighbours. It need not be held, or be there.
    #[inline(always)]
    pub fn fetch_beyond(&self, t: TetId) {
        let Some(record) = self.tets.get(t.0 as usize) else { return };
        for n in &record.neighbours {
            let Some(next) = self.tets.get(n.load(Relaxed) as usize) else { continue };
            next.neighbours.iter().for_each(|n| self.fetch_tet(TetId(n.load(Relaxed))));
        }
    }

    /// The tetrahedron at a vertex, which need not be held.
    #[inline(always)]
    pub fn unlocked_tet_of(&self, v: VertexId) -> TetId {
        self.vertices.get(v.0 as usize).map_or(TetId::NONE, |record| TetId(record.tet.load(Relaxed)))
    }
}
