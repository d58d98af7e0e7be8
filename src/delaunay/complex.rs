//! Tetrahedra of a triangulation in flat arrays with their neighbours. Its hull is closed by ghost tetrahedra that join each
//! hull face to a vertex at infinity.
use super::predicates::orient;
use crate::mesh::adjacency::sorted3;
use crate::mesh::vector::Vec3;

/// The vertex at infinity. In a ghost tetrahedron it is the last node.
pub const GHOST: u32 = u32::MAX;

/// No tetrahedron.
pub const NONE: u32 = u32::MAX;

/// Face i lies opposite node i; its nodes in the order for which (face, node i) is positive.
pub const FACE: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// Points and the tetrahedra between them.
#[derive(Clone, Debug, Default)]
pub struct Triangulation {
    /// Coordinates by vertex.
    pub(super) points: Vec<Vec3>,
    /// Nodes of each tetrahedron, positive; those of a ghost (a, b, c, GHOST) are such that outside lies on the positive side
    /// of (a, b, c). A free slot has GHOST as its first node.
    pub(super) nodes: Vec<[u32; 4]>,
    /// Neighbour across each face as 4 · tetrahedron + its face.
    pub(super) across: Vec<[u32; 4]>,
    /// Slots of `nodes` to use again.
    pub(super) free: Vec<u32>,
    /// A tetrahedron at each vertex, or `NONE` for a vertex that is not inserted.
    pub(super) at_vertex: Vec<u32>,
    /// Per tetrahedron: the last visit that saw it.
    pub(super) seen: Vec<u32>,
    /// Number of the current visit.
    pub(super) visit: u32,
    /// Local number of each vertex in a cavity (place 0 is the ghost's), `NONE` outside of it.
    pub(super) local: Vec<u32>,
    /// State of the random numbers for walks.
    pub(super) random: u32,
}

/// The four nodes with a ghost moved to the last place by an even permutation.
#[inline]
pub fn ghost_last(t: [u32; 4]) -> [u32; 4] {
    if t[0] == GHOST {
        [t[3], t[2], t[1], t[0]]
    } else if t[1] == GHOST {
        [t[2], t[3], t[0], t[1]]
    } else if t[2] == GHOST {
        [t[1], t[0], t[3], t[2]]
    } else {
        t
    }
}

impl Triangulation {
    /// Coordinates of the vertices.
    pub fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// The tetrahedra without ghosts, each positive.
    pub fn tetrahedra(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        self.nodes.iter().copied().filter(|t| t[0] != GHOST && t[3] != GHOST)
    }

    #[inline]
    pub(super) fn point(&self, v: u32) -> Vec3 {
        self.points[v as usize]
    }

    #[inline]
    pub(super) fn is_ghost(&self, t: u32) -> bool {
        self.nodes[t as usize][3] == GHOST
    }

    #[inline]
    pub(super) fn is_alive(&self, t: u32) -> bool {
        self.nodes[t as usize][0] != GHOST
    }

    /// Nodes of face i of t in the order for which (face, node i) is positive.
    #[inline]
    pub(super) fn face(&self, t: u32, i: usize) -> [u32; 3] {
        let n = &self.nodes[t as usize];
        FACE[i].map(|k| n[k])
    }

    /// Place of vertex v in t.
    #[inline]
    pub(super) fn place(&self, t: u32, v: u32) -> Option<usize> {
        self.nodes[t as usize].iter().position(|&n| n == v)
    }

    /// Orientation of four real vertices.
    #[inline]
    pub(super) fn orient(&self, a: u32, b: u32, c: u32, d: u32) -> f64 {
        orient(self.point(a), self.point(b), self.point(c), self.point(d))
    }

    /// Begins a visit: what `see` marked before is unseen.
    pub(super) fn begin_visit(&mut self) {
        if self.visit >= u32::MAX - 4 {
            self.seen.fill(0);
            self.visit = 0;
        }
        self.visit += 2;
    }

    /// Marks t; whether it was not marked before.
    #[inline]
    pub(super) fn see(&mut self, t: u32) -> bool {
        let new = self.seen[t as usize] != self.visit;
        self.seen[t as usize] = self.visit;
        new
    }

    /// A slot for one more tetrahedron.
    #[inline]
    pub(super) fn slot(&mut self) -> u32 {
        if let Some(t) = self.free.pop() {
            return t;
        }
        self.nodes.push([GHOST; 4]);
        self.across.push([NONE; 4]);
        self.seen.push(0);
        self.nodes.len() as u32 - 1
    }

    /// Appends a vertex that is in no tetrahedron yet.
    pub(super) fn push_point(&mut self, p: Vec3) -> u32 {
        self.points.push(p);
        self.at_vertex.push(NONE);
        self.local.push(NONE);
        self.points.len() as u32 - 1
    }

    /// The tetrahedra at vertex v, ghosts among them.
    pub(super) fn star(&mut self, v: u32, out: &mut Vec<u32>) {
        out.clear();
        self.star_until(v, out, |_, _| false);
    }

    /// Visits the tetrahedra at v until `stop` holds for one, which it returns.
    pub(super) fn star_until(&mut self, v: u32, out: &mut Vec<u32>, stop: impl Fn(&Self, u32) -> bool) -> Option<u32> {
        out.clear();
        let first = self.at_vertex[v as usize];
        if first == NONE {
            return None;
        }
        self.begin_visit();
        self.see(first);
        out.push(first);
        let mut next = 0;
        while next < out.len() {
            let t = out[next];
            next += 1;
            if stop(self, t) {
                return Some(t);
            }
            for i in 0..4 {
                if self.nodes[t as usize][i] == v {
                    continue;
                }
                let n = self.across[t as usize][i] >> 2;
                if self.see(n) {
                    out.push(n);
                }
            }
        }
        None
    }

    /// A tetrahedron that has the edge (u, v), looked for about u.
    pub(super) fn find_edge(&mut self, u: u32, v: u32, scratch: &mut Vec<u32>) -> Option<u32> {
        self.star_until(u, scratch, |m, t| m.nodes[t as usize].contains(&v))
    }

    /// A tetrahedron that has the face (u, v, w), looked for about u.
    pub(super) fn find_face(&mut self, f: [u32; 3], scratch: &mut Vec<u32>) -> Option<u32> {
        self.star_until(f[0], scratch, |m, t| {
            let n = &m.nodes[t as usize];
            n.contains(&f[1]) && n.contains(&f[2])
        })
    }

    /// The ring about the edge (u, v) of tetrahedron t: vertices r₀, r₁, ... such that each (u, v, rᵢ, rᵢ₊₁) is a positive
    /// tetrahedron, and these. False when t lacks the edge or the ring has more than `most` of them.
    pub(super) fn ring(&self, t: u32, u: u32, v: u32, most: usize, ring: &mut Vec<u32>, tets: &mut Vec<u32>) -> bool {
        ring.clear();
        tets.clear();
        let (Some(i), Some(j)) = (self.place(t, u), self.place(t, v)) else { return false };
        let (x, y) = others(i, j);
        let (x, mut y) = (self.nodes[t as usize][x], self.nodes[t as usize][y]);
        ring.push(x);
        tets.push(t);
        let mut behind = x;
        let mut current = t;
        loop {
            let Some(k) = self.place(current, behind) else { return false };
            let next = self.across[current as usize][k];
            if next >> 2 == t {
                return true;
            }
            if ring.len() == most {
                return false;
            }
            ring.push(y);
            behind = y;
            current = next >> 2;
            tets.push(current);
            y = self.nodes[current as usize][(next & 3) as usize];
        }
    }

    /// Puts the tetrahedra `new` in the place of `old`: both fill the same space. Appends where they lie to `made`. False, and
    /// nothing done, when their outer faces do not match.
    pub(super) fn replace(&mut self, old: &[u32], new: &[[u32; 4]], made: &mut Vec<u32>) -> bool {
        self.begin_visit();
        for &t in old {
            self.see(t);
        }
        // Faces by their sorted nodes: outer ones with what lies across, then those of the new ones.
        let mut faces: Vec<([u32; 3], u32, bool)> = Vec::with_capacity(4 * (old.len() + new.len()));
        for &t in old {
            for i in 0..4 {
                let n = self.across[t as usize][i];
                if self.seen[(n >> 2) as usize] != self.visit {
                    faces.push((sorted3(self.face(t, i)), n, true));
                }
            }
        }
        for (k, t) in new.iter().enumerate() {
            for i in 0..4 {
                faces.push((sorted3(FACE[i].map(|j| t[j])), (4 * k + i) as u32, false));
            }
        }
        faces.sort_unstable();
        let twins = faces.chunks_exact(2).all(|p| p[0].0 == p[1].0 && !(p[0].2 && p[1].2));
        let single = faces.windows(3).all(|p| p[0].0 != p[2].0);
        if !faces.len().is_multiple_of(2) || !twins || !single {
            return false;
        }
        let first = made.len();
        for &t in old.iter().skip(new.len()) {
            self.nodes[t as usize] = [GHOST; 4];
            self.free.push(t);
        }
        made.extend_from_slice(&old[..old.len().min(new.len())]);
        while made.len() < first + new.len() {
            let t = self.slot();
            made.push(t);
        }
        for (k, n) in new.iter().enumerate() {
            let t = made[first + k];
            self.nodes[t as usize] = *n;
            for &v in n.iter().filter(|&&v| v != GHOST) {
                self.at_vertex[v as usize] = t;
            }
        }
        for pair in faces.chunks_exact(2) {
            let [a, b] =
                [pair[0], pair[1]].map(|f| if f.2 { f.1 } else { made[first + f.1 as usize / 4] * 4 + f.1 % 4 });
            self.across[(a >> 2) as usize][(a & 3) as usize] = b;
            self.across[(b >> 2) as usize][(b & 3) as usize] = a;
        }
        true
    }
}

/// The two other places (x, y) of a tetrahedron such that (i, j, x, y) is an even permutation.
#[inline]
pub fn others(i: usize, j: usize) -> (usize, usize) {
    let f = FACE[j];
    // (f₀, f₁, f₂, j) is even: rotate i to the front; (i, x, y, j) even means (i, j, x, y) even.
    let k = f.iter().position(|&n| n == i).unwrap_or(0);
    (f[(k + 1) % 3], f[(k + 2) % 3])
}

#[cfg(test)]
pub mod check {
    use super::*;

    /// Panics unless neighbours match, every tetrahedron is positive and each ghost lies on a hull that is convex.
    pub fn is_valid(m: &Triangulation) {
        for t in 0..m.nodes.len() as u32 {
            if !m.is_alive(t) {
                continue;
            }
            let n = m.nodes[t as usize];
            assert!(!n[..3].contains(&GHOST));
            if n[3] != GHOST {
                assert!(m.orient(n[0], n[1], n[2], n[3]) > 0.0, "tetrahedron {t} is not positive");
            }
            for i in 0..4 {
                let o = m.across[t as usize][i];
                assert_eq!(m.across[(o >> 2) as usize][(o & 3) as usize], 4 * t + i as u32);
                assert_eq!(sorted3(m.face(t, i)), sorted3(m.face(o >> 2, (o & 3) as usize)));
                let beyond = m.nodes[(o >> 2) as usize][(o & 3) as usize];
                if n[3] == GHOST && i < 3 {
                    assert!(m.orient(n[0], n[1], n[2], beyond) <= 0.0, "the hull is not convex");
                }
            }
        }
        for (v, &t) in m.at_vertex.iter().enumerate() {
            assert!(t == NONE || m.nodes[t as usize].contains(&(v as u32)));
        }
    }

    #[test]
    fn places_are_even() {
        let sign =
            |p: [usize; 4]| (0..4).flat_map(|a| (0..a).map(move |b| (b, a))).filter(|&(b, a)| p[b] > p[a]).count() % 2;
        for i in 0..4 {
            assert_eq!(sign([FACE[i][0], FACE[i][1], FACE[i][2], i]), 0);
            for j in (0..4).filter(|&j| j != i) {
                let (x, y) = others(i, j);
                assert_eq!(sign([i, j, x, y]), 0);
            }
            let mut t = [0, 1, 2, 3];
            t[i] = GHOST;
            let moved = ghost_last(t).map(|v| if v == GHOST { i } else { v as usize });
            assert_eq!((moved[3], sign(moved)), (i, 0));
        }
    }
}
