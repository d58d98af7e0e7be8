//! Ridges, known at both of their ends, after a commit has split or collapsed one.
use super::access::Access;
use super::ids::VertexId;
use super::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// The ridge a–b has become a–v–b: v is new.
    pub fn split_ridge(&mut self, [a, b]: [VertexId; 2], v: VertexId) {
        self.store.set_ridge(v, [a, b]);
        self.store.redirect_ridge(a, b, v);
        self.store.redirect_ridge(b, a, v);
    }

    /// The ridge other–v–w has become other–w: v is gone.
    pub fn join_ridge(&mut self, other: VertexId, v: VertexId, w: VertexId) {
        self.store.redirect_ridge(other, v, w);
        self.store.redirect_ridge(w, v, other);
    }
}
