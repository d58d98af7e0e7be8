//! Recovery of an edge among others in its plane, where the tetrahedra on the sides of the plane leave no room for flips: a point
//! close to the plane on each side makes every flip of two triangles in the plane possible.
use super::complex::GHOST;
use super::fill::seen_from;
use super::flips::Goal;
use super::recovery::Recovery;
use super::{Added, Error, Origin};
use crate::mesh::vector::{add, lerp, scale};

/// An edge that crosses another in its plane, with the two vertices that the flip joins.
struct Diagonal {
    ends: [u32; 2],
    joined: [u32; 2],
    /// Whether the new edge crosses too.
    crosses: bool,
}

impl Recovery<'_> {
    /// Makes (a, b) an edge when all that it crosses are edges in one plane, by flips in this plane (Lawson 1977; Sloan 1993),
    /// with points added inside.
    pub fn recover_edge_in_plane(&mut self, a: u32, b: u32) -> Result<bool, Error> {
        let mut bound = None;
        let mut steps = 0;
        loop {
            let Some(pipe) = self.pipe(a, b)? else { return Ok(true) };
            let bound = *bound.get_or_insert(4 * pipe.edges.len() + 8);
            steps += 1;
            if !pipe.faces.is_empty() || steps > bound || self.added.len() + 2 >= self.most_added {
                return Ok(false);
            }
            let all: Vec<Diagonal> = pipe.edges.iter().filter_map(|&e| self.diagonal(e, a, b)).collect();
            if all.is_empty() {
                return Ok(false);
            }
            let turn = self.mesh.below(all.len() as u32) as usize;
            let best = all.iter().position(|d| !d.crosses).unwrap_or(turn);
            if !self.flip_in_plane(&all[best], Goal::Edge(a, b)) {
                return Ok(false);
            }
        }
    }

    /// The flip of an edge, if both triangles in the plane of a and b are there and make a convex quadrangle.
    fn diagonal(&mut self, [x, y]: [u32; 2], a: u32, b: u32) -> Option<Diagonal> {
        let (ring, _) = self.whole_ring(x, y)?;
        let inside = |m: &super::Triangulation, v: u32| v != GHOST && m.orient(x, y, a, v) == 0.0;
        let joined: Vec<u32> = ring.iter().copied().filter(|&v| inside(&self.mesh, v)).collect();
        let &[p, q] = joined.as_slice() else { return None };
        let off = ring.iter().copied().find(|&v| v != GHOST && v != p && v != q)?;
        let opposite = |u: u32, v: u32, s: u32, t: u32| {
            let sides = [self.mesh.orient(off, u, v, s), self.mesh.orient(off, u, v, t)];
            sides[0] > 0.0 && sides[1] < 0.0 || sides[0] < 0.0 && sides[1] > 0.0
        };
        let shared = [p, q].iter().any(|v| *v == a || *v == b);
        opposite(p, q, x, y).then(|| Diagonal {
            ends: [x, y],
            joined: [p, q],
            crosses: !shared && opposite(a, b, p, q),
        })
    }

    /// The ring about an edge, of any length, and its tetrahedra.
    fn whole_ring(&mut self, x: u32, y: u32) -> Option<(Vec<u32>, Vec<u32>)> {
        let mut scratch = std::mem::take(&mut self.tets);
        let start = self.mesh.find_edge(x, y, &mut scratch);
        self.tets = scratch;
        let (mut ring, mut tets) = (Vec::new(), Vec::new());
        self.mesh.ring(start?, x, y, usize::MAX, &mut ring, &mut tets).then_some((ring, tets))
    }

    /// Flips one edge of the plane, after adding a point on each side of it where more than one vertex is.
    fn flip_in_plane(&mut self, d: &Diagonal, goal: Goal) -> bool {
        self.begin_flips();
        let ([x, y], [p, q]) = (d.ends, d.joined);
        self.budget = 2;
        if self.remove_edge(x, y, 0, goal) {
            return true;
        }
        for (from, to) in [(p, q), (q, p)] {
            let Some((ring, tets)) = self.whole_ring(x, y) else { return false };
            let Some(first) = ring.iter().position(|&v| v == from) else { return false };
            let n = ring.len();
            let side: Vec<usize> = (0..n).map(|k| (first + k) % n).take_while(|&k| ring[k] != to).collect();
            let inner = &side[1..];
            if inner.len() <= 1 || inner.iter().any(|&k| ring[k] == GHOST) {
                continue;
            }
            let cavity: Vec<u32> = side.iter().map(|&k| tets[k]).collect();
            let front = self.shell(&cavity);
            let at = |v: u32| self.mesh.point(v);
            let middle = inner.iter().fold([0.0; 3], |s, &k| add(s, scale(at(ring[k]), 1.0 / inner.len() as f64)));
            // On the edge, near where the new one crosses it.
            let (u, v) = (lerp(at(x), at(y), 0.5), lerp(at(p), at(q), 0.5));
            let starts = [u, lerp(u, v, 0.5), lerp(at(x), at(y), 0.25), lerp(at(x), at(y), 0.75)];
            let Some(place) = seen_from(&self.mesh.points, &front, &starts, &[middle]) else { return false };
            let point = self.place(place);
            let new = self.mesh.push_point(scale(point, self.scale));
            self.surface.push_vertex();
            self.added.push(Added { point, origin: Origin::Inside });
            let mut s = std::mem::take(&mut self.insertion);
            let done = self.mesh.join(new, &cavity, &mut s);
            self.insertion = s;
            if !done {
                return false;
            }
        }
        self.budget = 2;
        self.remove_edge(x, y, 0, goal)
    }
}
