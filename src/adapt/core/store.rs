//! The mesh while it is adapted: flat arrays of records with 32-bit ids.
//!
//! Every field is a relaxed atomic, which costs nothing on the machines we build for and lets threads share the store
//! without `unsafe`. Order comes from the lock words: who holds all four vertices of a tetrahedron owns it, and its record
//! was published by the release of the last owner's locks ([`super::access`]). Reading a tetrahedron needs one of its vertices.
//! The arrays are reserved with room (zero pages that cost no memory until touched) and grow only between sweeps.
mod fetch;
mod order;
mod tetrahedra;
mod vertices;

pub use order::Torn;

use super::ids::{TetId, VertexId};
use crate::geometry::Entity;
use crate::tasks::Team;
use bytemuck::Zeroable;
use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};

/// Room for this many vertices beside those of a small mesh, and for six times as many tetrahedra. Room that is not used costs no
/// memory.
pub const ROOM: usize = 1 << 16;

/// What operations read of a vertex: two cache lines.
#[derive(Zeroable)]
#[repr(C)]
struct VertexRecord {
    position: [AtomicU64; 3],
    log: [AtomicU64; 6],
    metric: [AtomicU64; 6],
    lock: AtomicU32,
    tet: AtomicU32,
}

/// Where a vertex lies on the model: read for boundary vertices only.
#[derive(Zeroable)]
#[repr(C)]
struct PlaceRecord {
    parameters: [AtomicU64; 2],
    ridge: [AtomicU32; 2],
    entity: AtomicU32,
    hint: AtomicU32,
}

/// A tetrahedron: one cache line.
#[derive(Zeroable)]
#[repr(C)]
struct TetRecord {
    vertices: [AtomicU32; 4],
    neighbours: [AtomicU32; 4],
    tags: [AtomicU32; 4],
    region: AtomicU32,
    quality: AtomicU32,
    stamp: AtomicU32,
    moved: AtomicU32,
}

/// A ridge edge that leaves a corner.
pub struct CornerRidge {
    /// The vertex at the other end; changes as the edge is split and collapsed.
    other: AtomicU32,
    /// The model edge.
    pub curve: u32,
}

/// The mesh store.
pub struct Store {
    vertices: Vec<VertexRecord>,
    /// The owner of each vertex in a round of the deterministic scheduler. Bytes in an array of their own, since a claim reads nothing else.
    owners: Vec<AtomicU8>,
    places: Vec<PlaceRecord>,
    tets: Vec<TetRecord>,
    corners: Vec<Vec<CornerRidge>>,
    next_vertex: AtomicUsize,
    next_tet: AtomicUsize,
    /// Ticks with every sweep; a tetrahedron is stamped with it when it is written.
    clock: AtomicU32,
    /// The time when the ids were last in the order of the curve.
    ordered: Option<u32>,
}

#[inline(always)]
fn value(from: &AtomicU64) -> f64 {
    f64::from_bits(from.load(Relaxed))
}

#[inline(always)]
fn load<const N: usize>(from: &[AtomicU64; N]) -> [f64; N] {
    std::array::from_fn(|i| value(&from[i]))
}

#[inline(always)]
fn save<const N: usize>(to: &[AtomicU64; N], values: [f64; N]) {
    for i in 0..N {
        to[i].store(values[i].to_bits(), Relaxed);
    }
}

/// Records that a task of [`rehouse`] moves, and tasks at a time.
const MOVED: usize = 1 << 13;
/// See [`MOVED`].
const AT_ONCE: usize = 16;

/// Moves the used records to an array of another capacity; needs them exclusively, so between sweeps only. They go from the back, and
/// the old array gives back its memory as it gets shorter, so that they never are there twice. Without memory for that array they stay
/// where they are, and the answer is no.
fn rehouse<T: Zeroable + Send>(team: Team<'_>, records: &mut Vec<T>, used: usize, capacity: usize) -> bool {
    let Some(mut roomy) = crate::memory::try_zeroed_vec::<T>(capacity.max(used)) else { return false };
    records.truncate(used);
    while !records.is_empty() {
        let start = (records.len() - 1) / (AT_ONCE * MOVED) * (AT_ONCE * MOVED);
        let mut pairs: Vec<_> = roomy[start..].chunks_mut(MOVED).zip(records[start..].chunks_mut(MOVED)).collect();
        team.fill(1, &mut pairs, |_, pairs| {
            for (to, from) in pairs {
                to.iter_mut().zip(from.iter_mut()).for_each(|(to, from)| std::mem::swap(to, from));
            }
        });
        records.truncate(start);
        records.shrink_to_fit();
    }
    *records = roomy;
    true
}

/// Bytes of a page, at the least, and pages that are touched in a task: a huge page.
const PAGE: usize = 1 << 12;
/// See [`PAGE`].
const PAGES: usize = 1 << 9;

/// Writes a zero to a record on each page of some that are not used.
fn touch<T: Sync>(
    team: Team<'_>,
    records: &[T],
    unused: std::ops::Range<usize>,
    word: impl Fn(&T) -> &AtomicU32 + Sync,
) {
    let unused = unused.start..unused.end.min(records.len());
    let step = PAGE / size_of::<T>();
    team.for_each(PAGES, unused.len().div_ceil(step), |pages| {
        pages.for_each(|page| word(&records[unused.start + step * page]).store(0, Relaxed));
    });
}

/// How much to ask memory for, in turn: what is wished; what is needed with half of the rest, a quarter, and so on; at last what is needed
/// alone. Where memory is not lent beyond what there is, room for later counts as used.
fn capacities(needed: usize, wished: usize) -> impl Iterator<Item = usize> {
    let rest = wished.saturating_sub(needed);
    (0..6).map(move |halvings| needed + (rest >> halvings)).chain([needed])
}

/// As many empty records as there is memory for, from what is wished down to what is needed.
fn roomy<T: Zeroable>(needed: usize, wished: usize) -> Vec<T> {
    let some = capacities(needed, wished).find_map(crate::memory::try_zeroed_vec);
    some.unwrap_or_else(|| bytemuck::allocation::zeroed_vec(needed))
}

const INDEX_BITS: u32 = 30;

fn pack(entity: Entity) -> u32 {
    let index = match entity {
        Entity::Vertex(i) | Entity::Edge(i) | Entity::Face(i) => i,
        Entity::Interior => 0,
    };
    entity.dimension() << INDEX_BITS | index
}

#[inline(always)]
fn unpack(word: u32) -> Entity {
    let index = word & ((1 << INDEX_BITS) - 1);
    match word >> INDEX_BITS {
        0 => Entity::Vertex(index),
        1 => Entity::Edge(index),
        2 => Entity::Face(index),
        _ => Entity::Interior,
    }
}

impl Store {
    /// An empty store for so many vertices and tetrahedra, with room for as many again and some more if there is memory for it.
    pub fn with_room(vertices: usize, tets: usize) -> Self {
        Self::of(roomy(vertices, 2 * vertices + ROOM), roomy(tets, 2 * tets + 6 * ROOM))
    }

    /// An empty store with room for so many vertices and tetrahedra.
    #[cfg(test)]
    pub fn with_capacity(vertices: usize, tets: usize) -> Self {
        Self::of(bytemuck::allocation::zeroed_vec(vertices), bytemuck::allocation::zeroed_vec(tets))
    }

    fn of(vertices: Vec<VertexRecord>, tets: Vec<TetRecord>) -> Self {
        Self {
            owners: bytemuck::allocation::zeroed_vec(vertices.len()),
            places: bytemuck::allocation::zeroed_vec(vertices.len()),
            vertices,
            tets,
            corners: Vec::new(),
            next_vertex: AtomicUsize::new(0),
            next_tet: AtomicUsize::new(0),
            clock: AtomicU32::new(1),
            ordered: None,
        }
    }

    /// Makes room for at least so many more vertices and tetrahedra. An array that must grow gets room for several times as many, and for the
    /// number that is `expected` in all, if there is memory for it: so it seldom grows, and untouched pages cost no memory. Returns whether
    /// there was memory for what is needed; if not, what has no room is refused. Between sweeps only.
    pub fn reserve(&mut self, team: Team<'_>, [vertices, tets]: [usize; 2], expected: [usize; 2]) -> bool {
        let used = self.vertex_bound();
        let needed = used + vertices;
        if needed > self.vertices.len() {
            // Ids go as far as the vertices' own array, so the others grow before it.
            let has_grown = capacities(needed, expected[0].max(used + 3 * needed)).any(|room| {
                self.make_owners(room)
                    && rehouse(team, &mut self.places, used, room)
                    && rehouse(team, &mut self.vertices, used, room)
            });
            if !has_grown {
                return false;
            }
        }
        let used = self.tet_bound();
        let needed = used + tets;
        needed <= self.tets.len()
            || capacities(needed, expected[1].max(used + 3 * needed))
                .any(|room| rehouse(team, &mut self.tets, used, room))
    }

    /// For a mesh that will have so many vertices and tetrahedra, writes to each page of the records that it does not use yet, on all threads. The
    /// system gives memory when it is first written, which takes long; without this the first part of the mesh that needs new ids would wait for
    /// all pages. Between sweeps only.
    pub fn map_pages(&self, team: Team<'_>, vertices: usize, tets: usize) {
        touch(team, &self.tets, self.tet_bound()..tets, |tet| &tet.moved);
        let vertices = self.vertex_bound()..vertices;
        touch(team, &self.vertices, vertices.clone(), |vertex| &vertex.lock);
        touch(team, &self.places, vertices, |place| &place.hint);
    }

    /// An array of owners for so many vertices, which means nothing between sweeps.
    fn make_owners(&mut self, vertices: usize) -> bool {
        let made = crate::memory::try_zeroed_vec(vertices);
        made.map(|owners| self.owners = owners).is_some()
    }

    /// Gives back what the live records leave of the memory, room for more included. Between sweeps only.
    pub fn trim(&mut self) {
        let (vertices, tets) = (self.vertex_bound(), self.tet_bound());
        self.vertices.truncate(vertices);
        self.vertices.shrink_to_fit();
        self.owners.truncate(vertices);
        self.owners.shrink_to_fit();
        self.places.truncate(vertices);
        self.places.shrink_to_fit();
        self.tets.truncate(tets);
        self.tets.shrink_to_fit();
    }

    /// Vertices and tetrahedra that still fit.
    pub fn room(&self) -> (usize, usize) {
        (
            self.vertices.len().saturating_sub(self.next_vertex.load(Relaxed)),
            self.tets.len().saturating_sub(self.next_tet.load(Relaxed)),
        )
    }

    /// All vertex ids are below this.
    #[inline(always)]
    pub fn vertex_bound(&self) -> usize {
        self.next_vertex.load(Relaxed).min(self.vertices.len())
    }

    /// All tetrahedron ids are below this.
    #[inline(always)]
    pub fn tet_bound(&self) -> usize {
        self.next_tet.load(Relaxed).min(self.tets.len())
    }

    /// A block of ids never used before, `None` when there is no room. Ids may be left over at the end of the room.
    pub(super) fn take_vertices(&self, count: usize) -> Option<std::ops::Range<u32>> {
        take(&self.next_vertex, self.vertices.len(), count, |i| {
            self.vertices[i as usize].tet.store(TetId::NONE.0, Relaxed);
        })
    }

    /// As [`Store::take_vertices`], for tetrahedra.
    pub(super) fn take_tets(&self, count: usize) -> Option<std::ops::Range<u32>> {
        take(&self.next_tet, self.tets.len(), count, |i| self.clear_tet(TetId(i)))
    }

    /// The block of ids from `start` on, which nobody else takes; `None` when there is no room. What lies between it and the ids taken
    /// before must be taken too before the next sweep.
    pub(super) fn take_vertices_at(&self, start: usize, count: usize) -> Option<std::ops::Range<u32>> {
        take_at(&self.next_vertex, self.vertices.len(), start..start + count, |i| {
            self.vertices[i as usize].tet.store(TetId::NONE.0, Relaxed);
        })
    }

    /// As [`Store::take_vertices_at`], for tetrahedra.
    pub(super) fn take_tets_at(&self, start: usize, count: usize) -> Option<std::ops::Range<u32>> {
        take_at(&self.next_tet, self.tets.len(), start..start + count, |i| self.clear_tet(TetId(i)))
    }

    /// Ids of live vertices. Between sweeps only.
    #[cfg(any(test, feature = "internals"))]
    pub fn live_vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.vertex_bound() as u32).map(VertexId).filter(|&v| self.is_vertex(v))
    }

    /// As [`Store::live_vertices`], of some ids.
    pub fn live_vertices_in(&self, ids: std::ops::Range<usize>) -> impl Iterator<Item = VertexId> + '_ {
        (ids.start as u32..ids.end as u32).map(VertexId).filter(|&v| self.is_vertex(v))
    }

    /// As [`Store::live_tets`], of some ids.
    pub fn live_tets_in(&self, ids: std::ops::Range<usize>) -> impl Iterator<Item = TetId> + '_ {
        (ids.start as u32..ids.end as u32).map(TetId).filter(|&t| self.is_tet(t))
    }

    /// Of these ids each `step`-th, of live tetrahedra.
    pub fn live_tets_each(&self, ids: std::ops::Range<usize>, step: usize) -> impl Iterator<Item = TetId> + '_ {
        let asked = (ids.start.next_multiple_of(step)..ids.end).step_by(step);
        asked.map(|id| TetId(id as u32)).filter(|&t| self.is_tet(t))
    }

    /// Ids of live tetrahedra. Between sweeps only.
    #[cfg(any(test, feature = "internals"))]
    pub fn live_tets(&self) -> impl Iterator<Item = TetId> + '_ {
        (0..self.tet_bound() as u32).map(TetId).filter(|&t| self.is_tet(t))
    }

    /// The clock that stamps changes.
    pub fn clock(&self) -> u32 {
        self.clock.load(Relaxed)
    }

    /// Begins a new sweep; returns the new time.
    pub fn tick(&self) -> u32 {
        self.clock.fetch_add(1, Relaxed) + 1
    }
}

fn take(next: &AtomicUsize, room: usize, count: usize, fresh: impl Fn(u32)) -> Option<std::ops::Range<u32>> {
    let start = next.fetch_add(count, Relaxed);
    if start + count > room {
        next.fetch_sub(count, Relaxed);
        return None;
    }
    (start..start + count).for_each(|i| fresh(i as u32));
    Some(start as u32..(start + count) as u32)
}

fn take_at(
    next: &AtomicUsize,
    room: usize,
    ids: std::ops::Range<usize>,
    fresh: impl Fn(u32),
) -> Option<std::ops::Range<u32>> {
    if ids.end > room {
        return None;
    }
    let ids = ids.start as u32..ids.end as u32;
    ids.clone().for_each(fresh);
    next.fetch_max(ids.end as usize, Relaxed);
    Some(ids)
}

/// Writes for tests alone, past the operations, to have something to repair.
#[cfg(test)]
impl Store {
    /// Moves a vertex, whatever that inverts.
    pub fn displace(&self, v: VertexId, to: crate::mesh::vector::Vec3) {
        self.set_position(v, to);
    }

    /// Tags one side of a face.
    pub fn tag_face(&self, t: TetId, i: usize, tag: u32) {
        self.set_tag(t, i, tag);
    }
}
