//! In unit tests every access to the store is checked against the rule of the locks, whether or not another thread is near:
//! - a vertex is read and written by who holds it;
//! - a tetrahedron is read by who holds one of its vertices, a neighbour or tag written by who holds that face,
//!   all else by who holds all four, before and after.
//!
//! By this rule a lock word orders whatever two threads do to one record. A race would break the rule, and a broken rule
//! is found on every run, not only when two threads meet. Outside the tests nothing of this is compiled.
//! The exception is [`Store::unlocked_vertices`].
use super::ids::{TetId, VertexId};
use super::store::Store;

#[cfg(test)]
pub use watch::{pause, work_as};

/// Outside the tests nothing is checked.
#[cfg(not(test))]
#[inline(always)]
pub fn work_as(_owner: u32) {}

/// Outside the tests no thread is delayed.
#[cfg(not(test))]
#[inline(always)]
pub fn pause() {}

#[cfg(test)]
impl Store {
    /// A vertex is read or written.
    #[track_caller]
    pub(super) fn must_hold(&self, v: VertexId) {
        assert!(watch::holds(self, v), "{v:?} is touched without its lock");
    }

    /// A tetrahedron is read.
    #[track_caller]
    pub(super) fn must_hold_one_of(&self, t: TetId) {
        let alive = self.unlocked_vertices(t).into_iter().filter(|v| v.is_some());
        assert!(!watch::is_on() || alive.into_iter().any(|v| watch::holds(self, v)), "{t:?} is read without a lock");
    }

    /// A face's tag or neighbour is written.
    #[track_caller]
    pub(super) fn must_own_face(&self, t: TetId, i: usize) {
        let face = super::ids::FACE[i].map(|k| self.unlocked_vertices(t)[k]);
        assert!(
            !watch::is_on() || face.iter().all(|&v| watch::holds(self, v)),
            "a face of {t:?} is written without locks"
        );
    }

    /// A tetrahedron is written; a dead one may be written by the thread that has its id.
    #[track_caller]
    pub(super) fn must_own_tet(&self, t: TetId) {
        let alive = self.unlocked_vertices(t).into_iter().filter(|v| v.is_some());
        assert!(
            !watch::is_on() || alive.into_iter().all(|v| watch::holds(self, v)),
            "{t:?} is written without all locks"
        );
    }
}

#[cfg(not(test))]
impl Store {
    #[inline(always)]
    pub(super) fn must_hold(&self, _v: VertexId) {}

    #[inline(always)]
    pub(super) fn must_hold_one_of(&self, _t: TetId) {}

    #[inline(always)]
    pub(super) fn must_own_face(&self, _t: TetId, _i: usize) {}

    #[inline(always)]
    pub(super) fn must_own_tet(&self, _t: TetId) {}
}

#[cfg(test)]
mod watch {
    use super::*;
    use std::cell::Cell;
    use std::sync::atomic::Ordering::Relaxed;

    thread_local! {
        static OWNER: Cell<u32> = const { Cell::new(0) };
        static TURN: Cell<u32> = const { Cell::new(1) };
    }

    /// From now on this thread works as `owner`; 0: it has the store to itself.
    pub fn work_as(owner: u32) {
        OWNER.set(owner);
    }

    /// Lets another thread go on, now and then: threads meet more often.
    pub fn pause() {
        let turn = TURN.get().wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        TURN.set(turn);
        if turn >> 27 == 0 {
            std::thread::yield_now();
        }
    }

    /// Whether this thread may touch the vertex.
    pub fn holds(store: &Store, v: VertexId) -> bool {
        let owner = OWNER.get();
        owner == 0 || store.lock(v).load(Relaxed) == owner || u32::from(store.owner(v).load(Relaxed)) == owner
    }

    /// Whether this thread works beside others.
    pub fn is_on() -> bool {
        OWNER.get() != 0
    }
}
