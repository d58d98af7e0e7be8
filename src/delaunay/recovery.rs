//! State of the recovery of a surface in a triangulation, and the order in which edges and facets are recovered.
use super::complex::{NONE, Triangulation};
use super::flips::Journal;
use super::insert::Scratch;
use super::triangles::Triangles;
use super::{Added, Error, Origin, Placement};
use crate::mesh::adjacency::sorted3;
use crate::mesh::vector::{Vec3, add, lerp, scale};

/// Depth of the search for flips in the last attempt before a point is added.
pub const DEPTH: u32 = 3;

/// A triangulation that is made to contain the triangles. What of them it has is never given up again: an edge or face of the
/// triangulation that is one of the surface is protected.
pub struct Recovery<'a> {
    pub mesh: Triangulation,
    pub surface: Triangles,
    pub journal: Journal,
    pub insertion: Scratch,
    pub tets: Vec<u32>,
    /// The tetrahedra that flips made, and undoing, since the flips began.
    pub made: Vec<u32>,
    pub placement: &'a mut dyn Placement,
    pub added: Vec<Added>,
    /// Coordinates of the triangulation are those of the caller times this power of two.
    pub scale: f64,
    /// Points that may be added.
    pub most_added: usize,
    /// Flips that the current attempt may still look at.
    pub budget: u32,
}

impl Recovery<'_> {
    /// Recovers all edges, then all triangles; points are added where flips do not do it.
    pub fn run(&mut self) -> Result<(), Error> {
        let (mut edges, mut facets) = self.missing();
        let mut fresh: Vec<u32> = Vec::new();
        let mut centres = Vec::new();
        loop {
            self.recover_edges(&mut edges, &[0, 1, 2, DEPTH])?;
            if self.split_on_shells(&edges, &mut centres)? {
                (edges, facets) = self.missing();
                continue;
            }
            self.recover_edges(&mut edges, &[DEPTH])?;
            if !edges.is_empty() {
                // Each that is still missing is split, and what that makes is tried at once.
                for e in std::mem::take(&mut edges) {
                    self.go_on()?;
                    if self.surface.with_edge(e[0], e[1]).is_none() || self.recover_edge(e[0], e[1], DEPTH)? {
                        continue;
                    }
                    if self.recover_edge_in_plane(e[0], e[1])? {
                        continue;
                    }
                    fresh.clear();
                    self.split_edge(e[0], e[1], &mut fresh)?;
                    self.edges_of(&fresh, &mut edges);
                    facets.extend_from_slice(&fresh);
                }
                continue;
            }
            facets.sort_unstable();
            facets.dedup();
            for depth in 0..=DEPTH {
                let mut left = Vec::new();
                for t in facets {
                    self.go_on()?;
                    if !self.recover_facet(t, depth)? {
                        left.push(t);
                    }
                }
                facets = left;
            }
            if facets.is_empty() {
                return Ok(());
            }
            for t in std::mem::take(&mut facets) {
                // An edge of it may have gone missing with a neighbour's split; then that comes first.
                if !self.has_edges(t) {
                    facets.push(t);
                    continue;
                }
                if self.recover_facet(t, DEPTH)? {
                    continue;
                }
                fresh.clear();
                self.split_facet(t, &mut fresh)?;
                self.edges_of(&fresh, &mut edges);
                facets.extend_from_slice(&fresh);
            }
        }
    }

    /// Recovers edges with searches of these depths; those that are still missing stay in the list.
    fn recover_edges(&mut self, edges: &mut Vec<[u32; 2]>, depths: &[u32]) -> Result<(), Error> {
        for &depth in depths {
            let mut left = Vec::new();
            for &[u, v] in edges.iter() {
                self.go_on()?;
                if self.surface.with_edge(u, v).is_some() && !self.recover_edge(u, v, depth)? {
                    left.push([u, v]);
                }
            }
            *edges = left;
        }
        Ok(())
    }

    /// Asks the caller whether to go on.
    fn go_on(&mut self) -> Result<(), Error> {
        if self.placement.go_on() { Ok(()) } else { Err(Error::Stopped) }
    }

    /// Edges and triangles of the surface that the triangulation lacks.
    fn missing(&mut self) -> (Vec<[u32; 2]>, Vec<u32>) {
        let (mut edges, mut facets) = (Vec::new(), Vec::new());
        let mut tets = std::mem::take(&mut self.tets);
        let mut ends: Vec<u32> = Vec::new();
        for u in 0..self.mesh.points.len() as u32 {
            if self.surface.degree(u) == 0 {
                continue;
            }
            // Each edge and triangle is looked for about its vertex of least degree.
            let rank = |v: u32| (self.surface.degree(v), v);
            ends.clear();
            for t in self.surface.at(u) {
                ends.extend(self.surface.nodes[t as usize].iter().filter(|&&v| rank(v) > rank(u)));
            }
            if ends.is_empty() {
                continue;
            }
            ends.sort_unstable();
            ends.dedup();
            self.mesh.star(u, &mut tets);
            for &t in &tets {
                for v in self.mesh.nodes[t as usize] {
                    self.mesh.local[v.wrapping_add(1) as usize] = 0;
                }
            }
            edges.extend(ends.iter().filter(|&&v| self.mesh.local[v as usize + 1] == NONE).map(|&v| [u, v]));
            for t in self.surface.at(u) {
                let f = self.surface.nodes[t as usize];
                if f.iter().all(|&v| rank(v) >= rank(u)) {
                    let near = f.iter().all(|&v| self.mesh.local[v as usize + 1] != NONE);
                    let has = |&k: &u32| f.iter().all(|v| self.mesh.nodes[k as usize].contains(v));
                    if !near || !tets.iter().any(has) {
                        facets.push(t);
                    }
                }
            }
            for &t in &tets {
                for v in self.mesh.nodes[t as usize] {
                    self.mesh.local[v.wrapping_add(1) as usize] = NONE;
                }
            }
        }
        self.tets = tets;
        (edges, facets)
    }

    fn has_edges(&mut self, t: u32) -> bool {
        let f = self.surface.nodes[t as usize];
        (0..3).all(|k| self.has_edge(f[k], f[(k + 1) % 3]))
    }

    /// Whether the triangulation has the edge.
    pub fn has_edge(&mut self, u: u32, v: u32) -> bool {
        let (u, v) = if self.surface.degree(u) <= self.surface.degree(v) { (u, v) } else { (v, u) };
        self.mesh.find_edge(u, v, &mut self.tets).is_some()
    }

    /// Appends the edges of the triangles.
    fn edges_of(&self, triangles: &[u32], edges: &mut Vec<[u32; 2]>) {
        let first = edges.len();
        for &t in triangles {
            let f = self.surface.nodes[t as usize];
            edges.extend((0..3).map(|k| [f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3])]));
        }
        edges[first..].sort_unstable();
        let all = edges.split_off(first);
        for e in all {
            if edges.last() != Some(&e) {
                edges.push(e);
            }
        }
    }

    /// Place in the caller's coordinates.
    pub fn place(&self, p: Vec3) -> Vec3 {
        scale(p, 1.0 / self.scale)
    }

    /// The failure to recover triangle t.
    pub fn unrecovered(&self, t: u32) -> Error {
        if let Some(error) = self.find_crossing(t) {
            return error;
        }
        let at = self.centre(t);
        Error::Unrecovered { triangle: self.surface.source[t as usize], at }
    }

    /// Centre of triangle t in the caller's coordinates.
    pub fn centre(&self, t: u32) -> Vec3 {
        let [a, b, c] = self.surface.nodes[t as usize].map(|v| self.mesh.point(v));
        self.place(scale(add(add(a, b), c), 1.0 / 3.0))
    }

    /// Adds a point on the missing edge (u, v); appends the triangles that are new with it.
    fn split_edge(&mut self, u: u32, v: u32, changed: &mut Vec<u32>) -> Result<(), Error> {
        let Some(t) = self.surface.with_edge(u, v) else { return Ok(()) };
        let (u, v) = (u.min(v), u.max(v));
        let at = self.crossing_place(u, v);
        let new = self.mesh.points.len() as u32;
        let straight = self.place(lerp(self.mesh.point(u), self.mesh.point(v), at));
        let p = self.placement.on_edge(new, [u, v], at, straight);
        self.add_point(p, Origin::Edge([u, v]), t)?;
        self.surface.split_edge(u, v, new, changed);
        Ok(())
    }

    /// Adds a point in the missing triangle t, whose edges are there; appends the three triangles.
    fn split_facet(&mut self, t: u32, changed: &mut Vec<u32>) -> Result<(), Error> {
        let f = self.surface.nodes[t as usize];
        let at = self.facet_place(t);
        let new = self.mesh.points.len() as u32;
        let corner = f.map(|v| self.mesh.point(v));
        let straight = (0..3).fold([0.0; 3], |s, k| add(s, scale(corner[k], at[k])));
        let straight = self.place(straight);
        let p = self.placement.in_triangle(new, f, at, straight);
        self.add_point(p, Origin::Triangle(f), t)?;
        self.surface.split_triangle(t, new, changed);
        Ok(())
    }

    /// Inserts the point `p` of the caller, for triangle t.
    fn add_point(&mut self, p: Vec3, origin: Origin, t: u32) -> Result<(), Error> {
        let v = self.take_point(p, origin, t)?;
        self.insert_among_constraints(v, t)
    }

    /// Takes the point `p` of the caller, for triangle t, as a vertex without tetrahedra.
    ///
    /// # Errors
    /// There are too many added points, or it is not finite.
    pub fn take_point(&mut self, p: Vec3, origin: Origin, t: u32) -> Result<u32, Error> {
        if self.added.len() >= self.most_added || p.iter().any(|x| !x.is_finite()) {
            return Err(self.unrecovered(t));
        }
        let v = self.mesh.push_point(scale(p, self.scale));
        self.surface.push_vertex();
        self.added.push(Added { point: p, origin });
        Ok(v)
    }

    /// The error that triangle t crosses the one of the surface that has the edge or face `nodes`.
    pub fn crossing(&self, t: Option<u32>, nodes: &[u32], at: Vec3) -> Error {
        let other = match *nodes {
            [u, v] => self.surface.with_edge(u, v),
            [u, v, w] => self.surface.with_nodes(sorted3([u, v, w])),
            _ => None,
        };
        let source = |t: Option<u32>| t.map_or(NONE, |t| self.surface.source[t as usize]);
        let (a, b) = (source(t), source(other));
        Error::Crossing { triangles: [a.min(b), a.max(b)], at: self.place(at) }
    }
}
