//! How an operation claims the vertices it reads and writes.
//!
//! An operation is written once. It claims a vertex before it reads what may change under it; a claim on a vertex makes every
//! tetrahedron at that vertex hold still, because whoever replaces a tetrahedron must hold all four of its vertices.
//! With [`Exclusive`] a claim is nothing and the compiler removes it; with [`Speculative`] it takes the vertex's lock word,
//! and a word held by another thread ends the operation with a conflict: everything is released, the item is tried again later.
//! With [`Owned`] the owner of each vertex was written before the round: each thread works on a part of the mesh that is its own, and a claim only
//! reads the owner.
use super::ids::VertexId;
use super::lock_checker;
use super::refusal::Refusal;
use super::store::Store;
use crate::tasks::claims::Claims;
use crate::tasks::lock::Claim;
use std::sync::atomic::Ordering::Relaxed;

/// How vertices are claimed.
pub trait Access: Send {
    /// Whether a claim that is refused now is refused until the round ends. Then it is best to claim early what will be needed.
    const REFUSES_UNTIL_ROUND_ENDS: bool = false;

    /// Whether no other thread works on the mesh.
    const IS_ALONE: bool = false;

    /// Claims a vertex for the operation at hand; claiming twice is harmless.
    fn claim(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal>;

    /// Claims a vertex that is new.
    #[inline(always)]
    fn adopt(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal> {
        self.claim(store, v)
    }

    /// Ends the operation: gives back all that was claimed.
    fn release(&mut self, store: &Store);
}

/// One thread: nothing to claim.
pub struct Exclusive;

impl Access for Exclusive {
    const IS_ALONE: bool = true;

    #[inline(always)]
    fn claim(&mut self, _store: &Store, _v: VertexId) -> Result<(), Refusal> {
        Ok(())
    }

    #[inline(always)]
    fn release(&mut self, _store: &Store) {}
}

/// Several threads: one lock word a vertex, never waited for (so there is no deadlock).
pub struct Speculative {
    claims: Claims,
}

impl Speculative {
    /// The access of thread `thread`, counted from 0.
    pub fn new(thread: usize) -> Self {
        let claims = Claims::new(thread);
        lock_checker::work_as(claims.owner());
        Self { claims }
    }
}

impl Access for Speculative {
    #[inline]
    fn claim(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal> {
        match self.claims.claim(v.0, store.lock(v)) {
            Claim::Taken => {
                lock_checker::pause();
                Ok(())
            }
            Claim::Held => Ok(()),
            Claim::Refused => Err(Refusal::Conflict),
        }
    }

    fn release(&mut self, store: &Store) {
        self.claims.release(|v| store.lock(VertexId(v)));
    }
}

impl Drop for Speculative {
    fn drop(&mut self) {
        lock_checker::work_as(0);
        let ended = self.claims.is_empty() || std::thread::panicking();
        debug_assert!(ended, "an operation ended without giving back its vertices");
    }
}

/// A part of the mesh that belongs to one thread for a whole round. The owners of the vertices do not change in the round.
pub struct Owned {
    /// Not 0.
    owner: u8,
}

impl Owned {
    /// The access of part `part`, counted from 0.
    pub fn new(part: usize) -> Self {
        let owner = Self::word(part);
        lock_checker::work_as(u32::from(owner));
        Self { owner }
    }

    /// The owner that is written to the vertices of a part. 0 stands for no part.
    #[inline(always)]
    pub fn word(part: usize) -> u8 {
        part as u8 + 1
    }
}

impl Access for Owned {
    const REFUSES_UNTIL_ROUND_ENDS: bool = true;

    #[inline(always)]
    fn claim(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal> {
        if store.owner(v).load(Relaxed) == self.owner { Ok(()) } else { Err(Refusal::Conflict) }
    }

    #[inline]
    fn adopt(&mut self, store: &Store, v: VertexId) -> Result<(), Refusal> {
        store.owner(v).store(self.owner, Relaxed);
        Ok(())
    }

    #[inline(always)]
    fn release(&mut self, _store: &Store) {}
}

impl Drop for Owned {
    fn drop(&mut self) {
        lock_checker::work_as(0);
    }
}
