//! The Delaunay tetrahedra while they are refined: records of 32-bit ids, every field a relaxed atomic, ordered by the vertices' lock words alone.
//!
//! Who replaces a tetrahedron holds its four vertices; who writes a neighbour holds the three of the face. Vertices stay where they are and
//! are never removed. Room is fixed while threads work; [`Store::grow`] makes more between.
use crate::mesh::vector::Vec3;
use crate::tasks::claims::Claims;
use crate::tasks::lock::Claim;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering::Relaxed};

/// No vertex, no tetrahedron.
pub const NONE: u32 = u32::MAX;

/// Fresh ids are taken in blocks of this size.
const BLOCK: usize = 64;

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A corner of the box about everything.
    Corner,
    /// A sample of a surface.
    Surface,
    /// Inside a region.
    Inner,
}

#[derive(Default)]
struct Point {
    at: [AtomicU64; 3],
    role: AtomicU32,
    lock: AtomicU32,
}

struct Record {
    nodes: [AtomicU32; 4],
    neighbours: [AtomicU32; 4],
    centre: [AtomicU64; 3],
    region: AtomicU32,
}

impl Default for Record {
    fn default() -> Self {
        let none = || std::array::from_fn(|_| AtomicU32::new(NONE));
        Self { nodes: none(), neighbours: none(), centre: Default::default(), region: AtomicU32::new(0) }
    }
}

/// Why an item was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its tetrahedron or face is gone.
    Stale,
    /// Another thread holds a vertex that is needed.
    Conflict,
    /// No room.
    Full,
    /// A surface must be refined first.
    Encroaching,
    /// The point would be too near to others.
    Crowded,
    /// The point is in neither tetrahedron's circumsphere: the rounding of floating point.
    Lost,
}

/// How vertices are claimed.
pub trait Access {
    /// Claims a vertex; claiming twice is harmless.
    fn claim(&mut self, store: &Store, v: u32) -> Result<(), Refusal>;

    /// Gives all back.
    fn release(&mut self, store: &Store);
}

/// One thread: nothing to claim.
pub struct Alone;

impl Access for Alone {
    #[inline(always)]
    fn claim(&mut self, _: &Store, _: u32) -> Result<(), Refusal> {
        Ok(())
    }

    #[inline(always)]
    fn release(&mut self, _: &Store) {}
}

impl Access for Claims {
    #[inline]
    fn claim(&mut self, store: &Store, v: u32) -> Result<(), Refusal> {
        match Claims::claim(self, v, &store.points[v as usize].lock) {
            Claim::Refused => Err(Refusal::Conflict),
            Claim::Taken | Claim::Held => Ok(()),
        }
    }

    fn release(&mut self, store: &Store) {
        Claims::release(self, |v| &store.points[v as usize].lock);
    }
}

/// The store.
#[derive(Default)]
pub struct Store {
    points: Vec<Point>,
    tets: Vec<Record>,
    next_point: AtomicUsize,
    next_tet: AtomicUsize,
}

/// Ids that a thread may use.
#[derive(Default)]
pub struct IdPool {
    points: Range<u32>,
    fresh: Range<u32>,
    free: Vec<u32>,
}

impl IdPool {
    /// Makes sure that a vertex and so many tetrahedra are at hand.
    pub fn provide(&mut self, store: &Store, tets: usize) -> Result<(), Refusal> {
        if self.points.is_empty() {
            self.points = take(&store.next_point, store.points.len()).ok_or(Refusal::Full)?;
        }
        while self.free.len() + self.fresh.len() < tets {
            self.free.extend(self.fresh.by_ref());
            self.fresh = take(&store.next_tet, store.tets.len()).ok_or(Refusal::Full)?;
        }
        Ok(())
    }

    /// A vertex, after [`IdPool::provide`].
    pub fn point(&mut self) -> u32 {
        self.points.next().expect("was provided")
    }

    /// A tetrahedron, after [`IdPool::provide`].
    pub fn tet(&mut self) -> u32 {
        self.free.pop().or_else(|| self.fresh.next()).expect("was provided")
    }

    /// Gives a tetrahedron back.
    pub fn free(&mut self, t: u32) {
        self.free.push(t);
    }
}

fn take(next: &AtomicUsize, room: usize) -> Option<Range<u32>> {
    let start = next.fetch_add(BLOCK, Relaxed);
    if start + BLOCK > room {
        next.fetch_sub(BLOCK, Relaxed);
        return None;
    }
    Some(start as u32..(start + BLOCK) as u32)
}

impl Store {
    /// Room for at least so many more tetrahedra than there are, and vertices in proportion. False when ids do not reach so far.
    pub fn grow(&mut self, more: usize) -> bool {
        let tets = *self.next_tet.get_mut() + more;
        // Of Delaunay tetrahedra there are between five and seven a vertex; near a surface fewer.
        let points = *self.next_point.get_mut() + more / 4;
        if tets >= NONE as usize {
            return false;
        }
        self.tets.resize_with(tets.max(self.tets.len()), Record::default);
        self.points.resize_with(points.max(self.points.len()), Point::default);
        true
    }

    /// Tetrahedra have ids below this; some are not alive.
    pub fn tet_bound(&self) -> u32 {
        self.next_tet.load(Relaxed) as u32
    }

    /// Vertices have ids below this; some were never used.
    pub fn point_bound(&self) -> u32 {
        self.next_point.load(Relaxed) as u32
    }

    /// Whether nobody holds a vertex.
    #[cfg(test)]
    pub fn is_free(&self, v: u32) -> bool {
        self.points[v as usize].lock.load(Relaxed) == 0
    }

    /// Writes a vertex that is not yet known to others.
    pub fn write_point(&self, v: u32, at: Vec3, role: Role) {
        let point = &self.points[v as usize];
        for i in 0..3 {
            point.at[i].store(at[i].to_bits(), Relaxed);
        }
        point.role.store(role as u32, Relaxed);
    }

    /// Where a vertex is.
    #[inline(always)]
    pub fn at(&self, v: u32) -> Vec3 {
        let point = &self.points[v as usize];
        std::array::from_fn(|i| f64::from_bits(point.at[i].load(Relaxed)))
    }

    /// What a vertex is.
    #[inline(always)]
    pub fn role(&self, v: u32) -> Role {
        match self.points[v as usize].role.load(Relaxed) {
            0 => Role::Corner,
            1 => Role::Surface,
            _ => Role::Inner,
        }
    }

    /// The four vertices; the first is [`NONE`] when it is not alive. Certain only for who holds one of them.
    #[inline(always)]
    pub fn nodes(&self, t: u32) -> [u32; 4] {
        let record = &self.tets[t as usize];
        std::array::from_fn(|i| record.nodes[i].load(Relaxed))
    }

    /// Where the vertices of a tetrahedron are.
    #[inline(always)]
    pub fn corners(&self, nodes: [u32; 4]) -> [Vec3; 4] {
        nodes.map(|v| self.at(v))
    }

    /// The neighbour opposite each vertex.
    #[inline(always)]
    pub fn neighbours(&self, t: u32) -> [u32; 4] {
        let record = &self.tets[t as usize];
        std::array::from_fn(|i| record.neighbours[i].load(Relaxed))
    }

    /// Sets the neighbour opposite local vertex i.
    #[inline(always)]
    pub fn set_neighbour(&self, t: u32, i: usize, n: u32) {
        self.tets[t as usize].neighbours[i].store(n, Relaxed);
    }

    /// Centre of the circumsphere.
    #[inline(always)]
    pub fn centre(&self, t: u32) -> Vec3 {
        let record = &self.tets[t as usize];
        std::array::from_fn(|i| f64::from_bits(record.centre[i].load(Relaxed)))
    }

    /// The region that the centre of the circumsphere lies in.
    #[inline(always)]
    pub fn region(&self, t: u32) -> u16 {
        self.tets[t as usize].region.load(Relaxed) as u16
    }

    /// Writes all but the neighbours.
    pub fn write_tet(&self, t: u32, nodes: [u32; 4], centre: Vec3, region: u16) {
        let record = &self.tets[t as usize];
        for i in 0..4 {
            record.nodes[i].store(nodes[i], Relaxed);
        }
        for i in 0..3 {
            record.centre[i].store(centre[i].to_bits(), Relaxed);
        }
        record.region.store(u32::from(region), Relaxed);
    }

    /// Marks a tetrahedron as not alive: who comes with an old id must not find a vertex here that it holds.
    pub fn kill(&self, t: u32) {
        self.tets[t as usize].nodes.iter().for_each(|node| node.store(NONE, Relaxed));
    }
}
