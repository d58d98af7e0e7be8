//! Recovery of a triangle of the surface whose edges are there: the edges that cross it are flipped away; else the tetrahedra
//! that it cuts are replaced, above and below it (after Si and Gärtner 2005).
use super::Error;
use super::complex::{GHOST, NONE};
use super::fill;
use super::flips::Goal;
use super::recovery::Recovery;
use crate::mesh::vector::{Vec3, area2, dot, lerp, sub};

/// What a triangle cuts: tetrahedra, and edges with their ends above and below it.
#[derive(Default)]
struct Cut {
    tets: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

impl Recovery<'_> {
    /// Makes triangle t a face; whether it is one now. When not, all is as before. Not without its edges.
    ///
    /// # Errors
    /// An edge of the surface that is there crosses it, or a vertex lies on it.
    pub fn recover_facet(&mut self, t: u32, depth: u32) -> Result<bool, Error> {
        let f = self.surface.nodes[t as usize];
        self.begin_flips();
        self.budget = 40 * (depth * depth * depth + 1);
        for _ in 0..200 {
            if self.find_facet(f).is_some() {
                return Ok(true);
            }
            let Some(cut) = self.cut(t, f)? else { break };
            let all = 0..cut.edges.len();
            if all.clone().any(|k| self.remove_edge(cut.edges[k][0], cut.edges[k][1], 0, Goal::Facet(f))) {
                continue;
            }
            if self.refill(f, &cut) {
                continue;
            }
            if depth == 0
                || !all.clone().any(|k| self.remove_edge(cut.edges[k][0], cut.edges[k][1], depth, Goal::Facet(f)))
            {
                break;
            }
        }
        self.undo(0);
        Ok(false)
    }

    /// A tetrahedron with the face.
    pub fn find_facet(&mut self, f: [u32; 3]) -> Option<u32> {
        let k = (0..3).min_by_key(|&k| self.surface.degree(f[k])).unwrap_or(0);
        self.mesh.find_face([f[k], f[(k + 1) % 3], f[(k + 2) % 3]], &mut self.tets)
    }

    /// What triangle t = f cuts; `None` when one of its edges is missing. With its edges there, a tetrahedron that it cuts has
    /// all its section in it, hence vertices above, below and at its corners only.
    fn cut(&mut self, t: u32, f: [u32; 3]) -> Result<Option<Cut>, Error> {
        let [a, b, c] = f;
        for k in 0..3 {
            if !self.has_edge(f[k], f[(k + 1) % 3]) {
                return Ok(None);
            }
        }
        let mut scratch = std::mem::take(&mut self.tets);
        let start = self.mesh.find_edge(a, b, &mut scratch);
        self.tets = scratch;
        let (mut ring, mut tets) = (Vec::new(), Vec::new());
        let Some(start) = start else { return Ok(None) };
        if !self.mesh.ring(start, a, b, usize::MAX, &mut ring, &mut tets) {
            return Ok(None);
        }
        let mut cut = Cut::default();
        for i in 0..ring.len() {
            let (p, q) = (ring[i], ring[(i + 1) % ring.len()]);
            if p == GHOST || q == GHOST {
                continue;
            }
            let (left, right) = (self.mesh.orient(a, b, p, c), self.mesh.orient(a, b, c, q));
            if left >= 0.0 && right >= 0.0 {
                if left == 0.0 || right == 0.0 {
                    return Err(self.touching(Some(t), if left == 0.0 { p } else { q }));
                }
                cut.tets.push(tets[i]);
                break;
            }
        }
        self.mesh.begin_visit();
        for &t in &cut.tets {
            self.mesh.see(t);
        }
        let mut next = 0;
        while next < cut.tets.len() {
            let k = cut.tets[next];
            next += 1;
            let n = self.mesh.nodes[k as usize];
            let mut side = [0.0; 4];
            for i in 0..4 {
                if n[i] == GHOST {
                    return Ok(None);
                }
                if !f.contains(&n[i]) {
                    side[i] = self.mesh.orient(a, b, c, n[i]);
                    if side[i] == 0.0 {
                        return Err(self.touching(Some(t), n[i]));
                    }
                }
            }
            for i in 0..4 {
                for j in 0..i {
                    if side[i] > 0.0 && side[j] < 0.0 || side[i] < 0.0 && side[j] > 0.0 {
                        cut.edges.push(if side[i] > 0.0 { [n[i], n[j]] } else { [n[j], n[i]] });
                    }
                }
                let face = (0..4).filter(|&j| j != i);
                if face.clone().any(|j| side[j] > 0.0) && face.clone().any(|j| side[j] < 0.0) {
                    let other = self.mesh.across[k as usize][i] >> 2;
                    if self.mesh.see(other) {
                        cut.tets.push(other);
                    }
                }
            }
        }
        cut.edges.sort_unstable();
        cut.edges.dedup();
        for &[p, q] in &cut.edges {
            if self.surface.with_edge(p, q).is_some() {
                let at = lerp(self.mesh.point(p), self.mesh.point(q), self.share(f, p, q));
                return Err(self.crossing(Some(t), &[p, q], at));
            }
        }
        Ok((!cut.edges.is_empty()).then_some(cut))
    }

    /// Share of the way from p to q at which the plane of f lies.
    fn share(&self, f: [u32; 3], p: u32, q: u32) -> f64 {
        let [a, b, c] = f.map(|v| self.mesh.point(v));
        let n = area2(a, b, c);
        let (above, below) = (dot(n, sub(self.mesh.point(p), a)).abs(), dot(n, sub(self.mesh.point(q), a)).abs());
        if above + below > 0.0 { above / (above + below) } else { 0.5 }
    }

    /// Replaces the tetrahedra that f cuts by some above and some below.
    fn refill(&mut self, f: [u32; 3], cut: &Cut) -> bool {
        let shell = self.shell(&cut.tets);
        let [a, b, c] = f;
        let (mut above, mut below) = (vec![[a, b, c]], vec![[a, c, b]]);
        for face in shell {
            let Some(&v) = face.iter().find(|v| !f.contains(v)) else { return false };
            if self.mesh.orient(a, b, c, v) > 0.0 { above.push(face) } else { below.push(face) }
        }
        let points = &self.mesh.points;
        let Some(mut new) = fill::fill(points, above) else { return false };
        let Some(lower) = fill::fill(points, below) else { return false };
        new.extend(lower);
        self.flip(&cut.tets, &new)
    }

    /// Barycentric coordinates of the point to add in triangle t: where an edge crosses it, far from its border.
    pub fn facet_place(&mut self, t: u32) -> Vec3 {
        let third = [1.0 / 3.0; 3];
        let f = self.surface.nodes[t as usize];
        let Ok(Some(cut)) = self.cut(t, f) else { return third };
        let [a, b, c] = f.map(|v| self.mesh.point(v));
        let n = area2(a, b, c);
        let mut best = (0.1, third);
        for &[p, q] in &cut.edges {
            let x = lerp(self.mesh.point(p), self.mesh.point(q), self.share(f, p, q));
            let part = |u: Vec3, v: Vec3| dot(area2(x, u, v), n) / dot(n, n);
            let w = [part(b, c), part(c, a), part(a, b)];
            let least = w[0].min(w[1]).min(w[2]);
            if least > best.0 {
                best = (least, w);
            }
        }
        best.1
    }

    /// A triangle of the surface that crosses t, for the report.
    pub fn find_crossing(&self, t: u32) -> Option<Error> {
        let f = self.surface.nodes[t as usize];
        let range = |f: [u32; 3], k: usize| {
            let x = f.map(|v| self.mesh.point(v)[k]);
            (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]))
        };
        let mine = [0, 1, 2].map(|k| range(f, k));
        for (o, &g) in self.surface.nodes.iter().enumerate() {
            let near = (0..3).all(|k| {
                let (low, high) = range(g, k);
                low <= mine[k].1 && high >= mine[k].0
            });
            if !near || o as u32 == t {
                continue;
            }
            let meets = |s: [u32; 3], f: [u32; 3]| (0..3).any(|k| self.segment_meets_triangle(s[k], s[(k + 1) % 3], f));
            if meets(f, g) || meets(g, f) {
                let source = |t: u32| self.surface.source[t as usize];
                let (a, b) = (source(t), source(o as u32));
                return Some(Error::Crossing { triangles: [a.min(b), a.max(b)], at: self.centre(t) });
            }
        }
        None
    }

    /// Adds vertex v, a point for triangle t, to the triangulation without giving up what it has of the surface.
    ///
    /// # Errors
    /// The point lies on an edge or triangle of the surface that is there, or on a vertex.
    pub fn insert_among_constraints(&mut self, v: u32, t: u32) -> Result<(), Error> {
        let near = self.surface.nodes[t as usize][0];
        let Some(start) = self.locate(v, self.mesh.at_vertex[near as usize]) else { return Err(self.unrecovered(t)) };
        let mut base = vec![start];
        let n = self.mesh.nodes[start as usize];
        if n[3] != GHOST {
            let flat: Vec<usize> = (0..4)
                .filter(|&i| {
                    let f = self.mesh.face(start, i);
                    self.mesh.orient(f[0], f[1], f[2], v) == 0.0
                })
                .collect();
            match flat[..] {
                [] => {}
                [i] => {
                    if self.surface.with_nodes(self.mesh.face(start, i)).is_some() {
                        return Err(self.touching(self.surface.with_nodes(self.mesh.face(start, i)), v));
                    }
                    base.push(self.mesh.across[start as usize][i] >> 2);
                }
                [i, j] => {
                    // On the edge between the two nodes that are not opposite these faces.
                    let (x, y) = super::complex::others(i, j);
                    if let Some(t) = self.surface.with_edge(n[x], n[y]) {
                        return Err(self.touching(Some(t), v));
                    }
                    let (mut ring, mut tets) = (Vec::new(), Vec::new());
                    self.mesh.ring(start, n[x], n[y], usize::MAX, &mut ring, &mut tets);
                    base = tets;
                }
                _ => return Err(self.touching(Some(t), v)),
            }
        }
        let cavity = self.cavity_of(v, &base);
        let mut s = std::mem::take(&mut self.insertion);
        let done = self.mesh.join(v, &cavity, &mut s);
        let done = done || self.mesh.join(v, &base, &mut s);
        self.insertion = s;
        if done { Ok(()) } else { Err(self.unrecovered(t)) }
    }

    /// The tetrahedron that holds v, also where a walk circles.
    fn locate(&mut self, v: u32, hint: u32) -> Option<u32> {
        if hint != NONE
            && let Some(t) = self.mesh.walk(v, hint, 2000)
        {
            return Some(t);
        }
        let m = &self.mesh;
        let all = || (0..m.nodes.len() as u32).filter(|&t| m.is_alive(t));
        let side = |t: u32, i: usize| {
            let f = m.face(t, i);
            m.orient(f[0], f[1], f[2], v)
        };
        let inside = all().find(|&t| !m.is_ghost(t) && (0..4).all(|i| side(t, i) >= 0.0));
        inside.or_else(|| all().find(|&t| m.is_ghost(t) && side(t, 3) > 0.0))
    }

    /// The tetrahedra about those of `base` whose spheres hold v, as many as can be joined to v: seen from it, and without an
    /// edge, triangle or vertex of the surface inside.
    fn cavity_of(&mut self, v: u32, base: &[u32]) -> Vec<u32> {
        let mut cavity: Vec<u32> = base.to_vec();
        let mut barred: Vec<u32> = Vec::new();
        loop {
            cavity.truncate(base.len());
            self.mesh.begin_visit();
            for &t in base {
                self.mesh.see(t);
            }
            let mut next = 0;
            while next < cavity.len() && cavity.len() < 300 {
                let t = cavity[next];
                next += 1;
                for i in 0..4 {
                    let o = self.mesh.across[t as usize][i] >> 2;
                    let new = self.mesh.seen[o as usize] != self.mesh.visit && !barred.contains(&o);
                    if new
                        && self.surface.with_nodes_or_ghost(self.mesh.face(t, i)).is_none()
                        && self.mesh.in_conflict(o, v)
                    {
                        self.mesh.see(o);
                        cavity.push(o);
                    }
                }
            }
            let Some(bad) = self.first_unfit(v, &cavity, base.len()) else { return cavity };
            barred.push(bad);
        }
    }

    /// A tetrahedron of the cavity, none of the first `fixed`, that cannot be in it.
    fn first_unfit(&self, v: u32, cavity: &[u32], fixed: usize) -> Option<u32> {
        let m = &self.mesh;
        let is_in = |t: u32| m.seen[t as usize] == m.visit;
        let mut rim: Vec<[u32; 2]> = Vec::new();
        for &t in cavity {
            for i in 0..4 {
                if !is_in(m.across[t as usize][i] >> 2) {
                    let f = m.face(t, i);
                    rim.extend((0..3).map(|k| [f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])]));
                }
            }
        }
        rim.sort_unstable();
        rim.dedup();
        cavity[fixed..].iter().copied().find(|&t| {
            let n = m.nodes[t as usize];
            let hidden = (0..4).any(|i| {
                let f = m.face(t, i);
                let inner = is_in(m.across[t as usize][i] >> 2);
                if f.contains(&GHOST) {
                    return false;
                }
                if inner { self.surface.with_nodes(f).is_some() } else { m.orient(f[0], f[1], f[2], v) <= 0.0 }
            });
            hidden
                || (0..4).any(|i| {
                    // A vertex is in the rim when one of its edges is.
                    let lost = n[i] != GHOST && !rim.iter().any(|e| e.contains(&n[i]));
                    lost || (0..i).any(|j| {
                        let e = [n[i].min(n[j]), n[i].max(n[j])];
                        n[i] != GHOST
                            && n[j] != GHOST
                            && rim.binary_search(&e).is_err()
                            && self.surface.with_edge(e[0], e[1]).is_some()
                    })
                })
        })
    }
}
