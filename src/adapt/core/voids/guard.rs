//! Tests a change of the surface against the triangles near it across a void.
use super::Voids;
use super::triangles::{Key, Triangle, key};
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;
use crate::mesh::vector::Vec3;
use std::sync::PoisonError;

/// What a change does to the boundary. Allocated once.
#[derive(Default)]
pub struct SurfaceChange {
    /// Boundary triangles that go.
    gone: Vec<Key>,
    /// Those that come.
    come: Vec<Triangle>,
    /// A vertex that is elsewhere now, so that its triangles come even where they were before.
    pub moving: Option<VertexId>,
}

impl SurfaceChange {
    /// Begins with none.
    pub fn clear(&mut self) {
        self.gone.clear();
        self.come.clear();
    }

    /// A triangle goes.
    pub fn goes(&mut self, face: [VertexId; 3]) {
        self.gone.push(key(face));
    }

    /// A triangle comes, of a face of a tetrahedron as [`FACE`] has it.
    pub fn comes(&mut self, [a, b, c]: [VertexId; 3], at: impl Fn(VertexId) -> Vec3) {
        self.come.push(Triangle { vertices: [a, c, b], corners: [at(a), at(c), at(b)] });
    }

    /// Forgets triangles that go and come again at the same place.
    fn drop_common(&mut self) {
        let Self { gone, come, moving } = self;
        let moves = |key: &Key| moving.is_some_and(|v| key.contains(&v));
        come.retain(|triangle| match gone.iter().position(|key| *key == triangle.key() && !moves(key)) {
            Some(at) => {
                gone.swap_remove(at);
                false
            }
            None => true,
        });
    }
}

/// Whether a change has to be noted when it is made.
#[must_use]
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Guarded {
    /// No: it is far from all narrow voids.
    No,
    /// Yes: it is in one.
    Yes,
}

impl<A: Access> Worker<'_, '_, A> {
    /// Whether `state.replacement`, whose new faces are matched, keeps the boundary out of itself; `is_surface(tet, face)` tells whether
    /// there is nothing beyond a new face.
    pub fn guard_replacement(&mut self, is_surface: impl Fn(usize, usize) -> bool) -> Result<Guarded, Refusal> {
        if self.context.voids.is_empty() {
            return Ok(Guarded::No);
        }
        let (store, state) = (self.store, &mut *self.state);
        let change = &mut state.surface_change;
        change.clear();
        for &t in &state.replacement.old {
            let (v, n) = (store.vertices(t), store.neighbours(t));
            (0..4).filter(|&i| !n[i].is_some()).for_each(|i| change.goes(FACE[i].map(|k| v[k])));
        }
        for (index, tet) in state.replacement.new.iter().enumerate() {
            for i in (0..4).filter(|&i| is_surface(index, i)) {
                change.comes(FACE[i].map(|k| tet.vertices[k]), |v| store.position(v));
            }
        }
        change.drop_common();
        self.guard()
    }

    /// Whether a vertex that was moved keeps the boundary out of itself where it is now; `ball` are its tetrahedra. If so it stays there.
    ///
    /// # Errors
    /// As [`Worker::guard`].
    pub fn keep_apart(&mut self, v: VertexId, ball: &[TetId]) -> Result<(), Refusal> {
        if self.context.voids.is_empty() || self.store.dimension(v) == 3 {
            return Ok(());
        }
        let (store, change) = (self.store, &mut self.state.surface_change);
        change.clear();
        for &t in ball {
            let (w, n) = (store.vertices(t), store.neighbours(t));
            for i in (0..4).filter(|&i| !n[i].is_some() && w[i] != v) {
                let face = FACE[i].map(|k| w[k]);
                change.goes(face);
                change.comes(face, |x| store.position(x));
            }
        }
        let guarded = self.guard()?;
        self.note_surface(guarded);
        Ok(())
    }

    /// Whether `state.surface_change` keeps the boundary out of itself.
    ///
    /// # Errors
    /// `Conflict` beside other threads, `Crossing` when it would bring more triangles through others than it takes away.
    pub fn guard(&mut self) -> Result<Guarded, Refusal> {
        let Voids { narrow: Some(narrow) } = &self.context.voids else { return Ok(Guarded::No) };
        let SurfaceChange { gone, come, .. } = &self.state.surface_change;
        let triangles = narrow.triangles();
        let is_near =
            gone.iter().any(|key| triangles.get(key).is_some()) || come.iter().any(|t| narrow.meets(&t.corners));
        if !is_near {
            return Ok(Guarded::No);
        }
        if !A::IS_ALONE {
            return Err(Refusal::Conflict);
        }
        let is_gone = |key: &Key| gone.contains(key);
        let after = triangles.crossings(come, is_gone);
        if after > 0 {
            let known: Vec<Triangle> = gone.iter().filter_map(|key| triangles.get(key).copied()).collect();
            if after > triangles.crossings(&known, is_gone) {
                return Err(Refusal::Crossing);
            }
        }
        Ok(Guarded::Yes)
    }

    /// Notes a change that was guarded and is made.
    pub fn note_surface(&mut self, guarded: Guarded) {
        let Voids { narrow: Some(narrow) } = &self.context.voids else { return };
        if guarded == Guarded::No {
            return;
        }
        let SurfaceChange { gone, come, .. } = &self.state.surface_change;
        let mut triangles = narrow.triangles.write().unwrap_or_else(PoisonError::into_inner);
        gone.iter().for_each(|key| triangles.remove(key));
        come.iter().filter(|t| narrow.meets(&t.corners)).for_each(|t| triangles.insert(*t));
    }
}
