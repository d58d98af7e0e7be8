//! Flips: an edge is removed by another triangulation of the ring about it (Shewchuk 2002), if need be after neighbouring
//! edges are. What does not lead anywhere is undone.
use super::complex::{FACE, GHOST, ghost_last};
use super::recovery::Recovery;

/// Largest number of tetrahedra about an edge that is removed.
pub const MOST: usize = 20;

/// What the flips are for; they must not bring more of what is in its way.
#[derive(Clone, Copy)]
pub enum Goal {
    /// Faces that cross the segment between two vertices.
    Edge(u32, u32),
    /// Edges that cross the triangle.
    Facet([u32; 3]),
    /// Tetrahedra of no better quality.
    Quality(f64),
}

/// The flips done since a start: tetrahedra before and after each.
#[derive(Default)]
pub struct Journal {
    before: Vec<[u32; 4]>,
    after: Vec<[u32; 4]>,
    /// Ends in `before` and `after`.
    flips: Vec<(usize, usize)>,
}

impl Journal {
    /// Forgets what was done: it stays.
    pub fn clear(&mut self) {
        self.before.clear();
        self.after.clear();
        self.flips.clear();
    }

    /// Number of flips so far.
    pub fn mark(&self) -> usize {
        self.flips.len()
    }
}

impl Recovery<'_> {
    /// Forgets the flips so far: they stay.
    pub fn begin_flips(&mut self) {
        self.journal.clear();
        self.made.clear();
    }

    /// Replaces tetrahedra and writes it down.
    pub fn flip(&mut self, old: &[u32], new: &[[u32; 4]]) -> bool {
        let first = self.journal.before.len();
        self.journal.before.extend(old.iter().map(|&t| self.mesh.nodes[t as usize]));
        let mut made = std::mem::take(&mut self.made);
        let done = self.mesh.replace(old, new, &mut made);
        self.made = made;
        if !done {
            self.journal.before.truncate(first);
            return false;
        }
        self.journal.after.extend_from_slice(new);
        self.journal.flips.push((self.journal.before.len(), self.journal.after.len()));
        true
    }

    /// Takes back all flips after the mark.
    pub fn undo(&mut self, mark: usize) {
        while self.journal.flips.len() > mark {
            self.journal.flips.pop();
            let (b, a) = self.journal.flips.last().copied().unwrap_or((0, 0));
            let after = self.journal.after.split_off(a);
            let before = self.journal.before.split_off(b);
            let mut tets = std::mem::take(&mut self.tets);
            let now: Vec<u32> = after
                .iter()
                .filter_map(|n| {
                    self.mesh.star_until(n[0], &mut tets, |m, t| n.iter().all(|v| m.nodes[t as usize].contains(v)))
                })
                .collect();
            self.tets = tets;
            let mut made = std::mem::take(&mut self.made);
            self.mesh.replace(&now, &before, &mut made);
            self.made = made;
        }
    }

    /// Replaces the two tetrahedra at face i of t by three at the edge between their apices, if these are positive.
    pub fn flip_face(&mut self, t: u32, i: usize) -> bool {
        let across = self.mesh.across[t as usize][i];
        let (d, e) = (self.mesh.nodes[t as usize][i], self.mesh.nodes[(across >> 2) as usize][(across & 3) as usize]);
        let f = self.mesh.face(t, i);
        if d == GHOST || e == GHOST || f.contains(&GHOST) {
            return false;
        }
        let new = [0, 1, 2].map(|k| [f[k], f[(k + 1) % 3], e, d]);
        new.iter().all(|n| self.mesh.orient(n[0], n[1], n[2], n[3]) > 0.0) && self.flip(&[t, across >> 2], &new)
    }

    /// Removes the edge (u, v), which is none of the surface, by a triangulation of its ring; with `depth` > 0 also after
    /// removing edges from u or v to the ring. False, and all as before, when that fails.
    pub fn remove_edge(&mut self, u: u32, v: u32, depth: u32, goal: Goal) -> bool {
        if self.budget == 0 || self.surface.with_edge(u, v).is_some() {
            return false;
        }
        self.budget -= 1;
        let mark = self.journal.mark();
        let (mut ring, mut tets) = (Vec::with_capacity(MOST), Vec::with_capacity(MOST));
        let mut tried: Vec<u32> = Vec::new();
        loop {
            let mut scratch = std::mem::take(&mut self.tets);
            let start = self.mesh.find_edge(u, v, &mut scratch);
            self.tets = scratch;
            let Some(start) = start else { return true };
            let whole = self.mesh.ring(start, u, v, MOST + 6, &mut ring, &mut tets);
            if whole && ring.len() <= MOST && self.retriangulate(u, v, &ring, &tets, goal) {
                return true;
            }
            if depth == 0 || !whole {
                break;
            }
            // The edges from u or v to the ring that keep a face about (u, v) from being flipped.
            let n = ring.len();
            let blocked = (0..n).flat_map(|i| [(i, u), (i, v)]).find(|&(i, w)| {
                let (p, q, r) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
                if p == GHOST || q == GHOST || r == GHOST || tried.contains(&(2 * q + u32::from(w == v))) {
                    return false;
                }
                let side = if w == v { self.mesh.orient(p, q, r, v) } else { self.mesh.orient(p, r, q, u) };
                side <= 0.0
            });
            let Some((i, w)) = blocked else { break };
            tried.push(2 * ring[i] + u32::from(w == v));
            if tried.len() > 2 * MOST {
                break;
            }
            self.remove_edge(w, ring[i], depth - 1, goal);
        }
        self.undo(mark);
        false
    }

    /// Replaces the tetrahedra about the edge (u, v) by those of the triangulation of the ring with the fewest crossings of
    /// the goal among those with positive tetrahedra only (dynamic programming after Klincsek 1980).
    pub fn retriangulate(&mut self, u: u32, v: u32, ring: &[u32], tets: &[u32], goal: Goal) -> bool {
        let n = ring.len();
        let mut cost = [[f64::INFINITY; MOST]; MOST];
        let mut apex = [[0_u8; MOST]; MOST];
        for i in 0..n - 1 {
            cost[i][i + 1] = 0.0;
        }
        for length in 2..n {
            for i in 0..n - length {
                let j = i + length;
                if length < n - 1 && self.is_in_the_way(ring[i], ring[j], goal) {
                    continue;
                }
                for k in i + 1..j {
                    let parts = cost[i][k] + cost[k][j];
                    if parts < cost[i][j] {
                        let whole = parts + self.ring_triangle(u, v, [ring[i], ring[k], ring[j]], goal);
                        if whole < cost[i][j] {
                            cost[i][j] = whole;
                            apex[i][j] = k as u8;
                        }
                    }
                }
            }
        }
        if cost[0][n - 1].is_infinite() {
            return false;
        }
        let mut new: Vec<[u32; 4]> = Vec::with_capacity(2 * n);
        let mut open = vec![(0, n - 1)];
        while let Some((i, j)) = open.pop() {
            if j > i + 1 {
                let k = apex[i][j] as usize;
                let [p, q, r] = [ring[i], ring[k], ring[j]];
                new.push(ghost_last([p, q, r, v]));
                new.push(ghost_last([p, r, q, u]));
                open.push((i, k));
                open.push((k, j));
            }
        }
        self.flip(tets, &new)
    }

    /// Whether the new edge (p, q) crosses the facet that is to be recovered.
    fn is_in_the_way(&self, p: u32, q: u32, goal: Goal) -> bool {
        match goal {
            Goal::Facet(f) if p != GHOST && q != GHOST => self.segment_meets_triangle(p, q, f),
            _ => false,
        }
    }

    /// Crossings that triangle t of the ring about (u, v) adds; infinite if its tetrahedra are not positive.
    fn ring_triangle(&self, u: u32, v: u32, t: [u32; 3], goal: Goal) -> f64 {
        let [p, q, r] = t;
        if let Some(k) = t.iter().position(|&w| w == GHOST) {
            // Another diagonal of a flat part of the hull.
            let (a, b) = (t[(k + 1) % 3], t[(k + 2) % 3]);
            return if self.mesh.orient(a, b, u, v) == 0.0 { 0.0 } else { f64::INFINITY };
        }
        if self.mesh.orient(p, q, r, v) <= 0.0 || self.mesh.orient(p, r, q, u) <= 0.0 {
            return f64::INFINITY;
        }
        match goal {
            Goal::Edge(a, b) if self.segment_meets_triangle(a, b, t) => 1.0,
            Goal::Quality(least) if self.mesh.quality([p, q, r, v]).min(self.mesh.quality([p, r, q, u])) <= least => {
                f64::INFINITY
            }
            _ => 0.0,
        }
    }

    /// Whether the segment (a, b), which has no vertex in common with it, meets the triangle, its border included; a segment in
    /// its plane does not count.
    pub fn segment_meets_triangle(&self, a: u32, b: u32, t: [u32; 3]) -> bool {
        if t.contains(&a) || t.contains(&b) {
            return false;
        }
        let (above, below) = (self.mesh.orient(t[0], t[1], t[2], a), self.mesh.orient(t[0], t[1], t[2], b));
        if above == 0.0 && below == 0.0 || above > 0.0 && below > 0.0 || above < 0.0 && below < 0.0 {
            return false;
        }
        let side = [0, 1, 2].map(|k| self.mesh.orient(a, b, t[k], t[(k + 1) % 3]));
        side.iter().all(|&s| s >= 0.0) || side.iter().all(|&s| s <= 0.0)
    }

    /// The faces of the tetrahedra that are not between two of them, each with its tetrahedra on the positive side.
    pub fn shell(&mut self, tets: &[u32]) -> Vec<[u32; 3]> {
        self.mesh.begin_visit();
        for &t in tets {
            self.mesh.see(t);
        }
        let m = &self.mesh;
        let faces = tets.iter().flat_map(|&t| (0..4).map(move |i| (t, i)));
        faces
            .filter(|&(t, i)| m.seen[(m.across[t as usize][i] >> 2) as usize] != m.visit)
            .map(|(t, i)| FACE[i].map(|k| m.nodes[t as usize][k]))
            .collect()
    }
}
