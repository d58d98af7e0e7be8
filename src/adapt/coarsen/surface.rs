//! The triangles of a level.
use super::level::{Balls, FIXED, Level, is_proper};
use super::vertex_map::VertexMap;
use crate::mesh::vector::{Vec3, add, area2, dot, scale, unit};
use crate::tasks::Team;

/// Least cosine between the normals of a triangle and of the one that it comes from, and of the surface at its vertices.
const LEAST_COSINE: f64 = 0.94;

/// A triangle that turns by less than this cosine stays in its plane.
const SAME_PLANE: f64 = 1.0 - 1e-12;

/// The triangles at the vertices of the boundary.
pub struct Surface {
    /// For each vertex its place in these lists; [`NONE`] inside.
    slots: Vec<u32>,
    balls: Balls,
    /// For each vertex on a face a unit normal there, of either sign.
    normals: Vec<Vec3>,
}

const NONE: u32 = u32::MAX;

impl Surface {
    /// Of a level.
    pub fn of(team: Team<'_>, level: &Level) -> Self {
        let mut slots = vec![NONE; level.points.len()];
        let mut count = 0;
        for &v in level.triangles.iter().flatten() {
            if slots[v as usize] == NONE {
                slots[v as usize] = count;
                count += 1;
            }
        }
        let triangles: Vec<[u32; 3]> = level.triangles.iter().map(|nodes| nodes.map(|v| slots[v as usize])).collect();
        let balls = Balls::of(team, &triangles, count as usize);
        let mut normals = vec![[0.0; 3]; count as usize];
        for (nodes, at) in level.triangles.iter().zip(&triangles) {
            let normal = normal(level, nodes);
            for (&v, &slot) in nodes.iter().zip(at) {
                // Triangles of other faces meet at fixed vertices only.
                if level.faces[v as usize] < FIXED {
                    let sum = &mut normals[slot as usize];
                    *sum = add(*sum, scale(normal, if dot(*sum, normal) < 0.0 { -1.0 } else { 1.0 }));
                }
            }
        }
        normals.iter_mut().for_each(|normal| *normal = unit(*normal));
        Self { slots, balls, normals }
    }

    /// The triangles at a vertex.
    pub fn at(&self, v: u32) -> &[u32] {
        match self.slots[v as usize] {
            NONE => &[],
            slot => self.balls.at(slot),
        }
    }

    /// Calls `f` with the vertices on faces that are joined to v by an edge on the same face; some come twice.
    pub fn neighbours(&self, level: &Level, v: u32, mut f: impl FnMut(u32)) {
        for &t in self.at(v) {
            let face = level.of_face[level.triangle_origin[t as usize] as usize];
            for x in level.triangles[t as usize] {
                if x != v && level.faces[x as usize] == face {
                    f(x);
                }
            }
        }
    }

    /// Whether a triangle leaves its plane and stays one.
    pub fn bends(&self, level: &Level, t: u32, map: &VertexMap) -> bool {
        let nodes = &level.triangles[t as usize];
        let mapped = map.map(nodes);
        mapped != *nodes
            && is_proper(&mapped)
            && dot(unit(normal(level, &mapped)), unit(normal(level, nodes))) < SAME_PLANE
    }

    /// Whether a triangle is no problem: it vanishes, stays as it is, or still lies along the surface.
    pub fn is_fair(&self, level: &Level, t: u32, map: &VertexMap) -> bool {
        let nodes = &level.triangles[t as usize];
        let mapped = map.map(nodes);
        if mapped == *nodes || !is_proper(&mapped) {
            return true;
        }
        let new = unit(normal(level, &mapped));
        let along = |v: u32| {
            level.faces[v as usize] >= FIXED
                || dot(self.normals[self.slots[v as usize] as usize], new).abs() >= LEAST_COSINE
        };
        dot(new, unit(normal(level, nodes))) >= LEAST_COSINE && mapped.into_iter().all(along)
    }
}

/// The normal, with a length of twice the area.
fn normal(level: &Level, nodes: &[u32; 3]) -> Vec3 {
    let [a, b, c] = nodes.map(|v| level.points[v as usize]);
    area2(a, b, c)
}
