//! How an operation claims the vertices it reads and writes.
//!
//! An operation is written once. It claims a vertex before it reads what may change under it; a claim on a vertex makes every
//! tetrahedron at that vertex hold still, because whoever replaces a tetrahedron must hold all four of its vertices.
//! With [`Exclusive`] a claim is nothing and the compiler removes it; with [`Speculative`] it takes the vertex's lock word,
//! and a word held by another thread ends the operation with a conflict: everything is released, the item is tried again later.
use super::discipline;
use super::ids::VertexId;
use super::lock::{self, Claim};
use super::outcome::Refusal;
use super::store::Store;

/// How vertices are claimed.
pub trait Access: Send {
    /// Claims a vertex for the operation at hand; claiming twice is harmless.
    fn claim(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal>;

    /// Ends the operation: gives back all that was claimed.
    fn release(&mut self, store: &Store);
}

/// One thread: nothing to claim.
pub struct Exclusive;

impl Access for Exclusive {
    #[inline(always)]
    fn claim(&mut self, _store: &Store, _v: VertexId) -> Result<(), Refusal> {
        Ok(())
    }

    #[inline(always)]
    fn release(&mut self, _store: &Store) {}
}

/// Several threads: one lock word a vertex, never waited for (so there is no deadlock).
pub struct Speculative {
    /// Not 0; another one for each thread.
    owner: u32,
    claimed: Vec<VertexId>,
}

impl Speculative {
    /// The access of thread `thread`, counted from 0.
    pub fn new(thread: usize) -> Self {
        let owner = thread as u32 + 1;
        discipline::work_as(owner);
        Self { owner, claimed: Vec::with_capacity(256) }
    }
}

impl Access for Speculative {
    #[inline]
    fn claim(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal> {
        match lock::claim(store.lock(v), self.owner) {
            Claim::Taken => {
                self.claimed.push(v);
                discipline::pause();
                Ok(())
            }
            Claim::Held => Ok(()),
            Claim::Refused => Err(Refusal::Conflict),
        }
    }

    fn release(&mut self, store: &Store) {
        for v in self.claimed.drain(..) {
            lock::release(store.lock(v));
        }
    }
}

impl Drop for Speculative {
    fn drop(&mut self) {
        discipline::work_as(0);
        let ended = self.claimed.is_empty() || std::thread::panicking();
        debug_assert!(ended, "an operation ended without giving back its vertices");
    }
}
