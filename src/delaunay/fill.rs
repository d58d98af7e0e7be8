//! Tetrahedra of a small polyhedron without further points: an advancing front with exact tests that goes back where it finds
//! no way on (after the small polyhedron reconnection of Liu, Chen and Sun 2007).
use super::predicates::{in_sphere_perturbed, orient};
use crate::mesh::vector::{Vec3, area2, dot, lerp, sub, unit};

/// Tetrahedra that the search may place in all.
const BUDGET: u32 = 400;

/// Faces of the polyhedra that are tried at all.
const MOST: usize = 120;

/// Tetrahedra that fill the polyhedron of the faces, which have it on their positive side. Positive tetrahedra whose outer faces
/// are those of the polyhedron fill it without overlap.
pub fn fill(points: &[Vec3], faces: Vec<[u32; 3]>) -> Option<Vec<[u32; 4]>> {
    if faces.len() > MOST {
        return None;
    }
    let mut vertices: Vec<u32> = faces.iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut search = Search { points, vertices, front: faces, tets: Vec::new(), budget: BUDGET };
    search.advance().then_some(search.tets)
}

/// A point from which all faces are seen, on the way from one of `starts` to one of `ends`: that whose least distance to their
/// planes is largest among the ones tried.
pub fn seen_from(points: &[Vec3], faces: &[[u32; 3]], starts: &[Vec3], ends: &[Vec3]) -> Option<Vec3> {
    let at = |v: u32| points[v as usize];
    let normal = |f: &[u32; 3]| unit(area2(at(f[0]), at(f[1]), at(f[2])));
    let mut best: Option<(f64, Vec3)> = None;
    for (from, to) in starts.iter().flat_map(|s| ends.iter().map(move |e| (*s, *e))) {
        for n in 0..60 {
            let p = lerp(from, to, 0.7_f64.powi(n));
            let least = faces.iter().map(|f| dot(normal(f), sub(p, at(f[0])))).fold(f64::INFINITY, f64::min);
            if least > best.map_or(0.0, |b| b.0) && faces.iter().all(|f| orient(at(f[0]), at(f[1]), at(f[2]), p) > 0.0)
            {
                best = Some((least, p));
            }
        }
    }
    best.map(|b| b.1)
}

struct Search<'a> {
    points: &'a [Vec3],
    vertices: Vec<u32>,
    /// Faces of what is still to be filled.
    front: Vec<[u32; 3]>,
    tets: Vec<[u32; 4]>,
    budget: u32,
}

/// The face turned so that its least vertex is first.
fn turned(f: [u32; 3]) -> [u32; 3] {
    let k = if f[0] < f[1] && f[0] < f[2] {
        0
    } else if f[1] < f[2] {
        1
    } else {
        2
    };
    [f[k], f[(k + 1) % 3], f[(k + 2) % 3]]
}

impl Search<'_> {
    fn orient(&self, a: u32, b: u32, c: u32, d: u32) -> f64 {
        let at = |v: u32| self.points[v as usize];
        orient(at(a), at(b), at(c), at(d))
    }

    /// Fills what the front encloses; the front is as before when it cannot.
    fn advance(&mut self) -> bool {
        let Some(&f) = self.front.last() else { return true };
        let is_above = |v: &u32| !f.contains(v) && self.orient(f[0], f[1], f[2], *v) > 0.0;
        let mut apices: Vec<u32> = self.vertices.iter().copied().filter(is_above).collect();
        while !apices.is_empty() {
            // In the order of the Delaunay criterion: the sphere of the first holds no other. Most often that one will do.
            let nearer = |best: usize, k: usize| {
                if in_sphere_perturbed(self.points, [f[0], f[1], f[2], apices[best]], apices[k]) { k } else { best }
            };
            let first = (1..apices.len()).fold(0, nearer);
            let v = apices.swap_remove(first);
            if !self.fits(f, v) {
                continue;
            }
            if self.budget == 0 {
                return false;
            }
            self.budget -= 1;
            let saved = self.front.clone();
            self.tets.push([f[0], f[1], f[2], v]);
            for g in [f, [f[1], f[0], v], [f[2], f[1], v], [f[0], f[2], v]] {
                // Faces of the tetrahedron with it on the positive side leave the front, or enter it reversed.
                let g = turned(g);
                match self.front.iter().position(|&h| turned(h) == g) {
                    Some(k) => drop(self.front.remove(k)),
                    None => self.front.push([g[1], g[0], g[2]]),
                }
            }
            if self.advance() {
                return true;
            }
            self.tets.pop();
            self.front = saved;
        }
        false
    }

    /// Whether the tetrahedron of face f and vertex v meets the front in nothing but common vertices, edges and faces.
    fn fits(&self, f: [u32; 3], v: u32) -> bool {
        let t = [f[0], f[1], f[2], v];
        let holds = |w: u32| {
            let faces = [f, [f[1], f[0], v], [f[2], f[1], v], [f[0], f[2], v]];
            !t.contains(&w) && faces.iter().all(|g| self.orient(g[0], g[1], g[2], w) >= 0.0)
        };
        if self.front.iter().flatten().any(|&w| holds(w)) {
            return false;
        }
        for k in 0..3 {
            let side = turned([f[(k + 1) % 3], f[k], v]);
            let reversed = turned([side[1], side[0], side[2]]);
            let known = self.front.iter().any(|&h| turned(h) == side);
            if !known && self.front.iter().any(|&h| turned(h) == reversed) {
                return false;
            }
            let edge = [f[k], v];
            let rim = self.front.iter().any(|h| h.contains(&edge[0]) && h.contains(&edge[1]));
            for h in &self.front {
                if !rim && self.meets(edge[0], edge[1], *h) {
                    return false;
                }
                if !known && (0..3).any(|j| h[j] < h[(j + 1) % 3] && self.meets(h[j], h[(j + 1) % 3], side)) {
                    return false;
                }
            }
        }
        true
    }

    /// Whether the segment (a, b) meets the triangle, with which it has no vertex in common.
    fn meets(&self, a: u32, b: u32, t: [u32; 3]) -> bool {
        if t.contains(&a) || t.contains(&b) {
            return false;
        }
        let (above, below) = (self.orient(t[0], t[1], t[2], a), self.orient(t[0], t[1], t[2], b));
        if above == 0.0 && below == 0.0 || above > 0.0 && below > 0.0 || above < 0.0 && below < 0.0 {
            return false;
        }
        let side = [0, 1, 2].map(|k| self.orient(a, b, t[k], t[(k + 1) % 3]));
        side.iter().all(|&s| s >= 0.0) || side.iter().all(|&s| s <= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::volume6;

    fn prism(twist: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let point = |k: u32, turn: f64, z: f64| {
            let a = std::f64::consts::TAU * f64::from(k) / 3.0 + turn;
            [a.cos(), a.sin(), z]
        };
        let points = (0..6).map(|k| if k < 3 { point(k, 0.0, 0.0) } else { point(k - 3, twist, 1.0) }).collect();
        let mut faces = vec![[0, 1, 2], [3, 5, 4]];
        for k in 0..3 {
            let l = (k + 1) % 3;
            faces.extend([[k, l + 3, l], [k, k + 3, l + 3]]);
        }
        (points, faces)
    }

    #[test]
    fn prisms_with_three_diagonals_that_turn() {
        // Twisted one way the polyhedron bulges and can be filled; the other way it is Schönhardt's, which cannot.
        let (points, faces) = prism(-0.3);
        let tets = fill(&points, faces.clone()).or_else(|| fill(&prism(0.3).0, faces.clone()));
        let tets = tets.unwrap();
        let volume = |p: &[Vec3]| -> f64 {
            tets.iter().map(|t| t.map(|v| p[v as usize])).map(|[a, b, c, d]| volume6(a, b, c, d)).sum()
        };
        assert!(volume(&points) > 0.0);
        let filled = [-0.3, 0.3].map(|twist| fill(&prism(twist).0, prism(twist).1).is_some());
        assert_ne!(filled[0], filled[1]);
    }
}
