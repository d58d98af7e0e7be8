//! Edges that are missing all about a vertex, as those of a fan of many narrow triangles in a saddle or a crater: they are split
//! at one distance from the vertex, where their inner parts have no point in their smallest spheres and so are Delaunay
//! (concentric shells, Ruppert 1995; Si and Gärtner 2005).
use super::complex::Triangulation;
use super::recovery::Recovery;
use super::{Error, Origin};
use crate::mesh::vector::{lerp, norm, sub};

/// Missing edges at a vertex from which on they are split together.
const MANY: usize = 10;

/// Shells about one vertex.
const MOST_SHELLS: usize = 4;

impl Recovery<'_> {
    /// Splits the missing edges of vertices that have many, and makes the Delaunay tetrahedra anew; whether it did. `centres` are
    /// the vertices of earlier shells.
    ///
    /// # Errors
    /// As for adding points.
    pub fn split_on_shells(&mut self, missing: &[[u32; 2]], centres: &mut Vec<u32>) -> Result<bool, Error> {
        let mut pairs: Vec<[u32; 2]> = missing.iter().flat_map(|&[u, v]| [[u, v], [v, u]]).collect();
        pairs.sort_unstable();
        let mut split = false;
        for fan in pairs.chunk_by(|a, b| a[0] == b[0]).filter(|fan| fan.len() >= MANY) {
            let c = fan[0][0];
            if centres.iter().filter(|&&v| v == c).count() == MOST_SHELLS {
                continue;
            }
            centres.push(c);
            // Another fan may have split some.
            let left = fan.iter().map(|pair| pair[1]).filter(|&v| self.surface.with_edge(c, v).is_some());
            let lengths: Vec<(u32, f64)> =
                left.map(|v| (v, norm(sub(self.mesh.point(v), self.mesh.point(c))))).collect();
            let radius = 0.5 * lengths.iter().map(|l| l.1).fold(f64::INFINITY, f64::min);
            for (v, length) in lengths {
                self.split_without_tetrahedra(c, v, radius / length)?;
                split = true;
            }
        }
        if split {
            self.begin_flips();
            self.mesh = Triangulation::new(&self.mesh.points).map_err(Error::Points)?;
        }
        Ok(split)
    }

    /// Splits the edge (u, v) of the surface at that share of the way; the tetrahedra lack the point.
    fn split_without_tetrahedra(&mut self, u: u32, v: u32, share: f64) -> Result<(), Error> {
        let Some(t) = self.surface.with_edge(u, v) else { return Ok(()) };
        let (ends, at) = if u < v { ([u, v], share) } else { ([v, u], 1.0 - share) };
        let straight = self.place(lerp(self.mesh.point(ends[0]), self.mesh.point(ends[1]), at));
        let new = self.mesh.points.len() as u32;
        let point = self.placement.on_edge(new, ends, at, straight);
        self.take_point(point, Origin::Edge(ends), t)?;
        self.surface.split_edge(ends[0], ends[1], new, &mut Vec::new());
        Ok(())
    }
}
