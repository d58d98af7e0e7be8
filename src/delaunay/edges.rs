//! Recovery of an edge of the surface by flips of the faces and edges that it crosses (after Weatherill and Hassan 1994;
//! George, Hecht and Saltel 1991).
use super::Error;
use super::flips::Goal;
use super::recovery::Recovery;
use crate::mesh::vector::{Vec3, lerp};

/// What the segment from a to b meets first.
enum Meets {
    /// The edge is there.
    Nothing,
    /// The face opposite a in this tetrahedron, in its inside.
    Face(u32),
    /// An edge, in its inside.
    Edge(u32, u32),
    /// A vertex.
    Vertex(u32),
    /// It leaves the hull: the triangulation is not valid.
    Outside,
}

impl Recovery<'_> {
    /// Makes (a, b) an edge by flips; whether it is one now. When not, all is as before.
    ///
    /// # Errors
    /// The segment crosses a triangle or edge of the surface that is there, or has a vertex on it.
    pub fn recover_edge(&mut self, a: u32, b: u32, depth: u32) -> Result<bool, Error> {
        self.begin_flips();
        self.budget = 40 * (depth * depth * depth + 1);
        for (a, b) in [(a, b), (b, a)] {
            for _ in 0..60 {
                let done = match self.first_met(a, b) {
                    Meets::Nothing => return Ok(true),
                    Meets::Outside => false,
                    Meets::Vertex(v) => return Err(self.touching(self.surface.with_edge(a, b), v)),
                    Meets::Edge(p, q) => {
                        if self.surface.with_edge(p, q).is_some() {
                            return Err(self.crossing(self.surface.with_edge(a, b), &[p, q], self.middle(a, b)));
                        }
                        self.remove_edge(p, q, depth, Goal::Edge(a, b))
                    }
                    Meets::Face(t) => self.clear_face(a, b, t, depth)?,
                };
                if !done {
                    break;
                }
            }
        }
        self.undo(0);
        if depth > 0 { self.recover_edge_by_pipe(a, b, depth - 1) } else { Ok(false) }
    }

    /// Removes the face opposite a in t, which the segment crosses, by a flip, or one of its edges that is in the way of it.
    fn clear_face(&mut self, a: u32, b: u32, t: u32, depth: u32) -> Result<bool, Error> {
        let Some(i) = self.mesh.place(t, a) else { return Ok(false) };
        let f = self.mesh.face(t, i);
        if self.surface.with_nodes(f).is_some() {
            return Err(self.crossing(self.surface.with_edge(a, b), &f, self.middle(a, b)));
        }
        if self.flip_face(t, i) {
            return Ok(true);
        }
        let across = self.mesh.across[t as usize][i];
        let e = self.mesh.nodes[(across >> 2) as usize][(across & 3) as usize];
        for k in 0..3 {
            let (p, q) = (f[k], f[(k + 1) % 3]);
            if self.mesh.orient(p, q, e, a) <= 0.0 && self.remove_edge(p, q, depth, Goal::Edge(a, b)) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn first_met(&mut self, a: u32, b: u32) -> Meets {
        let mut tets = std::mem::take(&mut self.tets);
        let mut met = Meets::Outside;
        // Looked for about the end with fewer triangles, which has fewer tetrahedra.
        let (u, v) = if self.surface.degree(a) <= self.surface.degree(b) { (a, b) } else { (b, a) };
        if self.mesh.find_edge(u, v, &mut tets).is_some() {
            self.tets = tets;
            return Meets::Nothing;
        }
        if u != a {
            self.mesh.star(a, &mut tets);
        }
        for &t in tets.iter().filter(|&&t| !self.mesh.is_ghost(t)) {
            let Some(i) = self.mesh.place(t, a) else { continue };
            let f = self.mesh.face(t, i);
            let mut zero = [false; 3];
            let inside = (0..3).all(|k| {
                let side = self.mesh.orient(f[k], f[(k + 1) % 3], b, a);
                zero[k] = side == 0.0;
                side >= 0.0
            });
            if inside {
                met = match zero {
                    [false, false, false] => Meets::Face(t),
                    [true, false, false] => Meets::Edge(f[0], f[1]),
                    [false, true, false] => Meets::Edge(f[1], f[2]),
                    [false, false, true] => Meets::Edge(f[2], f[0]),
                    [true, true, _] => Meets::Vertex(f[1]),
                    [false, true, true] => Meets::Vertex(f[2]),
                    [true, false, true] => Meets::Vertex(f[0]),
                };
                break;
            }
        }
        self.tets = tets;
        met
    }

    pub fn middle(&self, a: u32, b: u32) -> Vec3 {
        lerp(self.mesh.point(a), self.mesh.point(b), 0.5)
    }

    /// The error that vertex v lies on triangle t.
    pub fn touching(&self, t: Option<u32>, v: u32) -> Error {
        let triangle = t.map_or(u32::MAX, |t| self.surface.source[t as usize]);
        Error::Touching { triangle, point: v, at: self.place(self.mesh.point(v)) }
    }
}
