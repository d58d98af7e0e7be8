//! Incremental Delaunay triangulation (Bowyer 1981, Watson 1981) with location by a walk.
use super::complex::{FACE, GHOST, NONE, Triangulation};
use super::order::insertion_order;
use super::predicates::{collinear, in_sphere_perturbed};
use crate::mesh::vector::Vec3;

/// Why points have no Delaunay triangulation.
#[derive(Clone, Debug, PartialEq)]
pub enum PointError {
    /// A coordinate of the point is not a finite number.
    NotFinite(u32),
    /// The two points are the same.
    Duplicate([u32; 2]),
    /// All points lie in one plane, or there are fewer than four.
    Flat,
    /// More points than 32-bit numbers of tetrahedra allow.
    TooMany,
}

/// A face of the cavity of a point.
struct Facet {
    /// Nodes in the order for which (face, point) is positive.
    nodes: [u32; 3],
    /// What lies behind it, as in `across`.
    outer: u32,
    /// Local numbers of the nodes.
    local: [u32; 3],
    /// The new tetrahedron, and the places in it of the three nodes and of the point.
    tet: u32,
    place: [u8; 4],
}

/// Arrays that one insertion leaves to the next.
#[derive(Default)]
pub struct Scratch {
    conflict: Vec<u32>,
    facets: Vec<Facet>,
    vertices: Vec<u32>,
    table: Vec<u32>,
    edges: Vec<(u32, u32, u32)>,
}

impl Triangulation {
    /// The Delaunay tetrahedra of the points; cospherical ones are decided by [`in_sphere_perturbed`], so that the result
    /// depends on nothing but the points and their numbers.
    ///
    /// # Errors
    /// See [`PointError`].
    pub fn new(points: &[Vec3]) -> Result<Self, PointError> {
        if points.len() > (1 << 30) / 8 {
            return Err(PointError::TooMany);
        }
        if let Some(i) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(PointError::NotFinite(i as u32));
        }
        let order = insertion_order(points);
        let mut mesh = Self {
            points: points.to_vec(),
            nodes: Vec::with_capacity(7 * points.len()),
            across: Vec::with_capacity(7 * points.len()),
            seen: Vec::with_capacity(7 * points.len()),
            at_vertex: vec![NONE; points.len()],
            local: vec![NONE; points.len() + 1],
            random: 1,
            ..Self::default()
        };
        let first = mesh.first_tetrahedron(&order)?;
        let mut scratch = Scratch::default();
        let mut hint = mesh.at_vertex[first[0] as usize];
        for v in order {
            if !first.contains(&v) {
                hint = mesh
                    .insert(v, hint, &mut scratch)
                    .map_err(|other| PointError::Duplicate([other.min(v), other.max(v)]))?;
            }
        }
        Ok(mesh)
    }

    /// Makes a tetrahedron of four of the points and the ghosts about it.
    fn first_tetrahedron(&mut self, order: &[u32]) -> Result<[u32; 4], PointError> {
        let p = |v: u32| self.points[v as usize];
        let a = *order.first().ok_or(PointError::Flat)?;
        let find = |test: &dyn Fn(u32) -> bool| order.iter().copied().find(|&v| test(v)).ok_or(PointError::Flat);
        let duplicate = |v: u32| PointError::Duplicate([a.min(v), a.max(v)]);
        let b = find(&|v| p(v) != p(a)).map_err(|e| order.get(1).map_or(e, |&v| duplicate(v)))?;
        let c = find(&|v| !collinear(p(a), p(b), p(v)))?;
        let mut d = find(&|v| self.orient(a, b, c, v) != 0.0)?;
        let (mut b, c) = (b, c);
        if self.orient(a, b, c, d) < 0.0 {
            std::mem::swap(&mut b, &mut d);
        }
        let t = [a, b, c, d];
        let mut all = vec![t];
        // Seen from outside, a face has the other orientation.
        all.extend(FACE.map(|f| [t[f[1]], t[f[0]], t[f[2]], GHOST]));
        self.replace(&[], &all, &mut Vec::new());
        Ok(t)
    }

    /// A random number below n, the same in each run.
    #[inline]
    pub(super) fn below(&mut self, n: u32) -> u32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        self.random % n
    }

    /// The tetrahedron that point v lies in or on, or a ghost that it lies beyond, by a walk from t that visits at most `most`
    /// tetrahedra (a walk through tetrahedra that are not Delaunay may circle).
    pub(super) fn walk(&mut self, v: u32, t: u32, most: usize) -> Option<u32> {
        let p = self.point(v);
        let mut t = if self.is_ghost(t) { self.across[t as usize][3] >> 2 } else { t };
        let mut from = 4;
        'step: for _ in 0..most {
            let begin = self.below(4) as usize;
            for k in 0..4 {
                let i = (begin + k) & 3;
                if i == from {
                    continue;
                }
                let f = self.face(t, i);
                if super::predicates::orient(self.point(f[0]), self.point(f[1]), self.point(f[2]), p) < 0.0 {
                    let next = self.across[t as usize][i];
                    t = next >> 2;
                    from = (next & 3) as usize;
                    if self.is_ghost(t) {
                        return Some(t);
                    }
                    continue 'step;
                }
            }
            return Some(t);
        }
        None
    }

    /// Whether vertex v lies inside the sphere of t; for a ghost, beyond its face or, in its plane, inside its circle.
    #[inline]
    pub(super) fn in_conflict(&self, t: u32, v: u32) -> bool {
        let n = self.nodes[t as usize];
        if n[3] != GHOST {
            return in_sphere_perturbed(&self.points, n, v);
        }
        let side = self.orient(n[0], n[1], n[2], v);
        if side != 0.0 {
            return side > 0.0;
        }
        // In the plane of the face, its circle is where the sphere of the tetrahedron behind it is.
        let behind = self.across[t as usize][3] >> 2;
        in_sphere_perturbed(&self.points, self.nodes[behind as usize], v)
    }

    /// Inserts vertex v, looked for from tetrahedron `hint`. Gives a tetrahedron at it, or the vertex that has the same place.
    pub(super) fn insert(&mut self, v: u32, hint: u32, s: &mut Scratch) -> Result<u32, u32> {
        let p = self.point(v);
        let start = self.walk(v, hint, usize::MAX).unwrap_or(hint);
        for n in self.nodes[start as usize] {
            if n != GHOST && self.point(n) == p {
                return Err(n);
            }
        }
        self.begin_visit();
        let (inside, outside) = (self.visit, self.visit + 1);
        s.conflict.clear();
        s.facets.clear();
        s.conflict.push(start);
        self.seen[start as usize] = inside;
        let mut next = 0;
        while next < s.conflict.len() {
            let t = s.conflict[next];
            next += 1;
            for i in 0..4 {
                let outer = self.across[t as usize][i];
                let n = outer >> 2;
                let state = self.seen[n as usize];
                if state == inside {
                    continue;
                }
                if state != outside {
                    if self.in_conflict(n, v) {
                        self.seen[n as usize] = inside;
                        s.conflict.push(n);
                        continue;
                    }
                    self.seen[n as usize] = outside;
                }
                s.facets.push(Facet { nodes: self.face(t, i), outer, local: [0; 3], tet: 0, place: [0; 4] });
            }
        }
        self.fill_cavity(v, s);
        Ok(self.at_vertex[v as usize])
    }

    /// Joins vertex v to the faces of the tetrahedra of `cavity`, which it replaces. False, and nothing done, when it does not
    /// see one of them.
    pub(super) fn join(&mut self, v: u32, cavity: &[u32], s: &mut Scratch) -> bool {
        self.begin_visit();
        for &t in cavity {
            self.see(t);
        }
        s.conflict.clear();
        s.conflict.extend_from_slice(cavity);
        s.facets.clear();
        for &t in cavity {
            for i in 0..4 {
                let outer = self.across[t as usize][i];
                if self.seen[(outer >> 2) as usize] != self.visit {
                    let f = self.face(t, i);
                    if !f.contains(&GHOST) && self.orient(f[0], f[1], f[2], v) <= 0.0 {
                        return false;
                    }
                    s.facets.push(Facet { nodes: f, outer, local: [0; 3], tet: 0, place: [0; 4] });
                }
            }
        }
        self.fill_cavity(v, s);
        true
    }

    /// Joins the faces of the cavity to vertex v.
    fn fill_cavity(&mut self, v: u32, s: &mut Scratch) {
        s.vertices.clear();
        for (k, f) in s.facets.iter_mut().enumerate() {
            for j in 0..3 {
                let local = &mut self.local[f.nodes[j].wrapping_add(1) as usize];
                if *local == NONE {
                    *local = s.vertices.len() as u32;
                    s.vertices.push(f.nodes[j]);
                }
                f.local[j] = *local;
            }
            f.tet = s.conflict.get(k).copied().unwrap_or_else(|| self.slot());
            let [a, b, c] = f.nodes;
            (self.nodes[f.tet as usize], f.place) = if a == GHOST {
                ([v, c, b, a], [3, 2, 1, 0])
            } else if b == GHOST {
                ([c, v, a, b], [2, 3, 0, 1])
            } else if c == GHOST {
                ([b, a, v, c], [1, 0, 3, 2])
            } else {
                ([a, b, c, v], [0, 1, 2, 3])
            };
            let inner = 4 * f.tet + u32::from(f.place[3]);
            self.across[f.tet as usize][f.place[3] as usize] = f.outer;
            self.across[(f.outer >> 2) as usize][(f.outer & 3) as usize] = inner;
            for n in f.nodes {
                if n != GHOST {
                    self.at_vertex[n as usize] = f.tet;
                }
            }
            self.at_vertex[v as usize] = f.tet;
        }
        // A cavity of many faces needs more tetrahedra than it had; should it ever have fewer, the rest is free.
        for &t in s.conflict.iter().skip(s.facets.len()) {
            self.nodes[t as usize] = [GHOST; 4];
            self.free.push(t);
        }
        for &n in &s.vertices {
            self.local[n.wrapping_add(1) as usize] = NONE;
        }
        let width = s.vertices.len() as u32;
        if width <= 256 {
            // Each directed edge of the cavity's surface has one face on its left: a table by the two nodes.
            s.table.resize((width * width) as usize, NONE);
            let edge =
                |f: &Facet, j: usize| (f.local[(j + 1) % 3], f.local[(j + 2) % 3], 4 * f.tet + u32::from(f.place[j]));
            for f in &s.facets {
                for j in 0..3 {
                    let (a, b, face) = edge(f, j);
                    s.table[(a * width + b) as usize] = face;
                }
            }
            for f in &s.facets {
                for j in 0..3 {
                    let (a, b, _) = edge(f, j);
                    self.across[f.tet as usize][f.place[j] as usize] = s.table[(b * width + a) as usize];
                }
            }
        } else {
            s.edges.clear();
            for f in &s.facets {
                for j in 0..3 {
                    let (a, b) = (f.local[(j + 1) % 3], f.local[(j + 2) % 3]);
                    s.edges.push((a.min(b), a.max(b), 4 * f.tet + u32::from(f.place[j])));
                }
            }
            s.edges.sort_unstable();
            for pair in s.edges.chunks_exact(2) {
                let (a, b) = (pair[0].2, pair[1].2);
                self.across[(a >> 2) as usize][(a & 3) as usize] = b;
                self.across[(b >> 2) as usize][(b & 3) as usize] = a;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::complex::check;
    use super::*;

    fn random_points(n: usize, seed: u64) -> Vec<Vec3> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / 2f64.powi(53)
        };
        (0..n).map(|_| [next(), next(), next()]).collect()
    }

    /// Neighbours match, tetrahedra are positive, spheres hold no point, and the volumes add up to `volume` of the hull.
    fn check_delaunay(points: &[Vec3], volume: Option<f64>) -> Triangulation {
        let m = Triangulation::new(points).unwrap();
        check::is_valid(&m);
        for t in m.tetrahedra() {
            for e in (0..points.len() as u32).filter(|e| !t.contains(e)) {
                assert!(!in_sphere_perturbed(points, t, e), "{t:?} has {e} in its sphere");
            }
        }
        assert!(m.at_vertex.iter().all(|&t| t != NONE));
        if let Some(volume) = volume {
            let sum: f64 = m
                .tetrahedra()
                .map(|t| crate::mesh::vector::volume6(m.point(t[0]), m.point(t[1]), m.point(t[2]), m.point(t[3])) / 6.0)
                .sum();
            assert!((sum / volume - 1.0).abs() < 1e-12, "{sum}");
        }
        m
    }

    #[test]
    fn random() {
        for seed in 0..8 {
            check_delaunay(&random_points(4 + 40 * seed as usize, seed), None);
        }
    }

    #[test]
    fn grids_are_decided_alike_in_any_order() {
        let n = 5;
        let grid: Vec<Vec3> =
            (0..n * n * n).map(|i| [(i % n) as f64, (i / n % n) as f64, (i / n / n) as f64]).collect();
        let m = check_delaunay(&grid, Some(64.0));
        let mut expected: Vec<[u32; 4]> = m
            .tetrahedra()
            .map(|mut t| {
                t.sort_unstable();
                t
            })
            .collect();
        expected.sort_unstable();
        // The same points inserted in the order of their numbers.
        let mut other = Triangulation {
            points: grid.clone(),
            at_vertex: vec![NONE; grid.len()],
            local: vec![NONE; grid.len() + 1],
            random: 5,
            ..Triangulation::default()
        };
        let order: Vec<u32> = (0..grid.len() as u32).collect();
        let first = other.first_tetrahedron(&order).unwrap();
        for v in order.into_iter().filter(|v| !first.contains(v)) {
            let hint = other.at_vertex[first[0] as usize];
            other.insert(v, hint, &mut Scratch::default()).unwrap();
        }
        check::is_valid(&other);
        let mut found: Vec<[u32; 4]> = other
            .tetrahedra()
            .map(|mut t| {
                t.sort_unstable();
                t
            })
            .collect();
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn far_from_the_origin_and_of_any_scale() {
        for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (1e-3, 1e6), (1e-30, 0.0), (1e40, 0.0)] {
            let points: Vec<Vec3> = random_points(120, 3).iter().map(|p| p.map(|x| offset + scale * x)).collect();
            check_delaunay(&points, None);
        }
        // On a sphere, on a line, and in a plane with one point off it.
        let sphere: Vec<Vec3> = (0..200)
            .map(|i| (i as f64 * 2.4, (i as f64 / 99.5 - 1.0).clamp(-1.0, 1.0)))
            .map(|(a, z)| [(1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z])
            .collect();
        check_delaunay(&sphere, None);
        let mut plane: Vec<Vec3> = (0..100).map(|i| [(i % 10) as f64, (i / 10) as f64, 0.0]).collect();
        plane.push([3.0, 3.0, 1.0]);
        check_delaunay(&plane, Some(27.0));
    }

    #[test]
    fn a_vertex_with_very_many_neighbours() {
        let mut points: Vec<Vec3> =
            (0..700).map(|i| i as f64 * 0.01).map(|a| [a.cos(), a.sin(), 1e-3 * (7.0 * a).sin()]).collect();
        points.push([0.0, 0.0, 30.0]);
        points.push([0.0, 0.0, -30.0]);
        check::is_valid(&Triangulation::new(&points).unwrap());
    }

    #[test]
    fn what_is_no_triangulation() {
        assert_eq!(Triangulation::new(&[]).unwrap_err(), PointError::Flat);
        assert_eq!(Triangulation::new(&[[0.0; 3]; 5]).unwrap_err(), PointError::Duplicate([0, 1]));
        let plane: Vec<Vec3> = random_points(50, 1).iter().map(|p| [p[0], p[1], 0.5]).collect();
        assert_eq!(Triangulation::new(&plane).unwrap_err(), PointError::Flat);
        let mut points = random_points(50, 1);
        points.push(points[20]);
        assert_eq!(Triangulation::new(&points).unwrap_err(), PointError::Duplicate([20, 50]));
        points[7][1] = f64::NAN;
        assert_eq!(Triangulation::new(&points).unwrap_err(), PointError::NotFinite(7));
    }
}
