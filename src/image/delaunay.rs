//! The Delaunay kernel: a point is inserted, and replaces the tetrahedra whose circumspheres hold it (Bowyer, Watson 1981).
//!
//! With exact predicates, and points on a sphere counted as not inside, the cavity is a star about the point, so all new tetrahedra
//! are positive: the part of a circumsphere beyond a face is within that of the neighbour.
use super::circumsphere;
use super::domain::Domain;
use super::edge_table::EdgeTable;
use super::store::{Access, IdPool, NONE, Refusal, Role, Store};
use crate::mesh::adjacency::FACES;
use crate::mesh::predicate::{is_positive, orientation};
use crate::mesh::vector::{Vec3, distance};

/// A face of the cavity's rim.
#[derive(Clone, Copy)]
struct RimFace {
    /// With the point behind them, a positive tetrahedron.
    nodes: [u32; 3],
    /// The tetrahedron beyond, and which of its faces this is.
    beyond: u32,
    back: usize,
}

/// What a thread has in hand.
#[derive(Default)]
pub struct Scratch {
    supply: IdPool,
    /// Tetrahedra that go.
    pub cavity: Vec<u32>,
    /// Tetrahedra at the rim that stay.
    staying: Vec<u32>,
    rim: Vec<RimFace>,
    edges: EdgeTable,
    /// Tetrahedra that came.
    pub fresh: Vec<u32>,
}

/// A thread at work.
pub struct Worker<'w, A: Access> {
    pub store: &'w Store,
    pub domain: &'w Domain,
    pub access: A,
    pub scratch: &'w mut Scratch,
}

impl<A: Access> Worker<'_, A> {
    /// Claims a tetrahedron that may be changing; `Stale` when it is another one by now.
    pub fn claim_tet(&mut self, t: u32, nodes: [u32; 4]) -> Result<(), Refusal> {
        if self.store.nodes(t) != nodes {
            return Err(Refusal::Stale);
        }
        for v in nodes {
            self.access.claim(self.store, v)?;
        }
        if self.store.nodes(t) == nodes { Ok(()) } else { Err(Refusal::Stale) }
    }

    /// Whether the point is inside the circumsphere of a tetrahedron that holds still.
    pub fn in_conflict(&self, t: u32, p: Vec3) -> bool {
        circumsphere::contains(self.store.corners(self.store.nodes(t)), p)
    }

    /// Finds and claims the cavity of the point, from a tetrahedron in conflict with it whose vertices are claimed.
    pub fn dig(&mut self, p: Vec3, start: u32) -> Result<(), Refusal> {
        let store = self.store;
        self.scratch.cavity.clear();
        self.scratch.staying.clear();
        self.scratch.rim.clear();
        self.scratch.cavity.push(start);
        let mut next = 0;
        while let Some(&t) = self.scratch.cavity.get(next) {
            next += 1;
            let (nodes, neighbours) = (store.nodes(t), store.neighbours(t));
            for i in 0..4 {
                let n = neighbours[i];
                if self.scratch.cavity.contains(&n) {
                    continue;
                }
                // Seen from outside, so the point is behind it.
                let [a, b, c] = FACES[i].map(|k| nodes[k]);
                let mut face = RimFace { nodes: [a, c, b], beyond: n, back: 0 };
                if n != NONE {
                    let there = store.nodes(n);
                    // Its other three vertices are claimed with t: it holds still.
                    face.back =
                        there.iter().position(|v| ![a, b, c].contains(v)).expect("a neighbour has another apex");
                    if !self.scratch.staying.contains(&n) {
                        if circumsphere::contains(store.corners(there), p) {
                            self.access.claim(store, there[face.back])?;
                            self.scratch.cavity.push(n);
                            continue;
                        }
                        self.scratch.staying.push(n);
                    }
                }
                self.scratch.rim.push(face);
            }
        }
        Ok(())
    }

    /// Distance from the point to the nearest vertex of the cavity, which is the nearest of all.
    pub fn room(&self, p: Vec3) -> f64 {
        let nodes = self.scratch.rim.iter().flat_map(|face| face.nodes);
        nodes.map(|v| distance(self.store.at(v), p)).fold(f64::INFINITY, f64::min)
    }

    /// Fills the cavity with a star about the point; the new tetrahedra are `fresh`.
    pub fn fill(&mut self, p: Vec3, role: Role) -> Result<u32, Refusal> {
        let store = self.store;
        let Scratch { supply, cavity, rim, edges, fresh, .. } = &mut *self.scratch;
        supply.provide(store, rim.len().saturating_sub(cavity.len()))?;
        let v = supply.point();
        store.write_point(v, p, role);
        self.access.claim(store, v)?;
        fresh.clear();
        edges.clear(2 * rim.len());
        for face in rim.iter() {
            // The ids of those that go come first; they are all claimed.
            let t = cavity.pop().unwrap_or_else(|| supply.tet());
            let [a, b, c] = face.nodes;
            let nodes = [a, b, c, v];
            let corners = store.corners(nodes);
            debug_assert!(is_positive(corners), "the cavity is a star");
            let centre = circumsphere::centre(corners);
            store.write_tet(t, nodes, centre, self.domain.region(centre));
            store.set_neighbour(t, 3, face.beyond);
            if face.beyond != NONE {
                store.set_neighbour(face.beyond, face.back, t);
            }
            let index = fresh.len() as u32;
            fresh.push(t);
            for i in 0..3 {
                let [a, b] = [face.nodes[(i + 1) % 3], face.nodes[(i + 2) % 3]];
                if let Some(side) = edges.meet(a, b, 4 * index + i as u32) {
                    let (other, j) = (fresh[side as usize / 4], side as usize % 4);
                    store.set_neighbour(t, i, other);
                    store.set_neighbour(other, j, t);
                }
            }
        }
        for t in cavity.drain(..) {
            store.kill(t);
            supply.free(t);
        }
        Ok(v)
    }

    /// The tetrahedron that holds the point, walking from another. For one thread alone.
    pub fn locate(&self, p: Vec3, from: u32) -> u32 {
        let store = self.store;
        let mut t = from;
        loop {
            let (nodes, neighbours) = (store.nodes(t), store.neighbours(t));
            let beyond = (0..4).find(|&i| {
                let [a, b, c] = FACES[i].map(|k| store.at(nodes[k]));
                neighbours[i] != NONE && orientation(a, b, c, p) > 0.0
            });
            match beyond {
                Some(i) => t = neighbours[i],
                None => return t,
            }
        }
    }
}

/// Six tetrahedra about the domain, large enough for all points that come.
pub fn enclose(domain: &Domain, scratch: &mut Scratch) -> Store {
    let mut store = Store::default();
    assert!(store.grow(1 << 16), "ids reach so far");
    let supply = &mut scratch.supply;
    let margin = distance(domain.low, domain.high);
    let provided = supply.provide(&store, 6);
    debug_assert!(provided.is_ok(), "an empty store has room");
    let corners: [u32; 8] = std::array::from_fn(|corner| {
        let v = supply.point();
        let bound = |i: usize| if corner >> i & 1 == 0 { domain.low[i] - margin } else { domain.high[i] + margin };
        store.write_point(v, std::array::from_fn(bound), Role::Corner);
        v
    });
    let mut sides: Vec<([u32; 3], u32, usize)> = Vec::new();
    for (order, odd) in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [1, 0, 2], [0, 2, 1], [2, 1, 0]].into_iter().zip(0..) {
        let second = 1 << order[0];
        let mut nodes = [corners[0], corners[second], corners[second | 1 << order[1]], corners[7]];
        if odd >= 3 {
            nodes.swap(0, 1);
        }
        let t = supply.tet();
        let centre = circumsphere::centre(store.corners(nodes));
        store.write_tet(t, nodes, centre, domain.region(centre));
        for i in 0..4 {
            let mut key = FACES[i].map(|k| nodes[k]);
            key.sort_unstable();
            if let Some(&(_, other, j)) = sides.iter().find(|side| side.0 == key) {
                store.set_neighbour(t, i, other);
                store.set_neighbour(other, j, t);
            }
            sides.push((key, t, i));
        }
    }
    store
}
