//! Flips that make flat tetrahedra better; the surface stays.
use super::complex::{GHOST, Triangulation};
use super::flips::{Goal, MOST};
use super::recovery::Recovery;
use super::regions::Regions;
use crate::mesh::vector::{Vec3, dot, sub, volume6};

/// Tetrahedra below this quality are looked at.
const FLAT: f64 = 1e-4;

/// Tetrahedra below this quality may be flat but for rounding.
const NOTHING: f64 = 1e-10;

/// Flips per tetrahedron at the start that are done at most.
const ROUNDS: usize = 4;

/// √2 times six volumes over the cube of the longest edge: 1 for the regular tetrahedron, 0 for a flat one; no more than zero
/// where it is not positive.
pub fn quality(p: [Vec3; 4]) -> f64 {
    let mut longest = 0.0_f64;
    for i in 0..4 {
        for j in 0..i {
            let e = sub(p[i], p[j]);
            longest = longest.max(dot(e, e));
        }
    }
    std::f64::consts::SQRT_2 * volume6(p[0], p[1], p[2], p[3]) / (longest * longest.sqrt())
}

impl Triangulation {
    /// Quality of four vertices as a tetrahedron.
    pub(super) fn quality(&self, t: [u32; 4]) -> f64 {
        quality(t.map(|v| self.point(v)))
    }
}

impl Recovery<'_> {
    /// Removes edges of flat tetrahedra, or faces, where the worst of what replaces them is better than the worst of what was;
    /// not outside. Regions follow.
    pub fn improve(&mut self, regions: &mut Regions) {
        let inside = |r: &Regions, t: u32| r.of.get(t as usize).is_some_and(|&k| k != 0);
        let flat = |m: &Triangulation, t: u32| m.is_alive(t) && !m.is_ghost(t) && m.quality(m.nodes[t as usize]) < FLAT;
        let slots = self.mesh.nodes.len() as u32;
        let mut work: Vec<u32> = (0..slots).filter(|&t| inside(regions, t) && flat(&self.mesh, t)).collect();
        let mut left = ROUNDS * work.len();
        let (mut ring, mut tets) = (Vec::new(), Vec::new());
        while let Some(t) = work.pop() {
            if left == 0 {
                return;
            }
            left -= 1;
            if !inside(regions, t) || !flat(&self.mesh, t) {
                continue;
            }
            let region = regions.of[t as usize];
            self.begin_flips();
            let better = self.improve_one(t, &mut ring, &mut tets) || self.dissolve(t);
            // All flips are within the region, and what is undone lies in other places than before.
            for k in 0..self.made.len() {
                let new = self.made[k];
                if regions.of.len() <= new as usize {
                    regions.of.resize(new as usize + 1, 0);
                }
                regions.of[new as usize] = region;
                if better {
                    work.push(new);
                }
            }
        }
    }

    /// Removes an edge of t, when it has next to no volume, by a search of several flips that make none as flat.
    fn dissolve(&mut self, t: u32) -> bool {
        let n = self.mesh.nodes[t as usize];
        if self.mesh.quality(n) > NOTHING {
            return false;
        }
        self.budget = 100;
        (0..4).any(|i| {
            (0..i).any(|j| {
                // A short ring: the search is for edges of few tetrahedra, not for the axis of a fan.
                self.remove_edge(n[i], n[j], 2, Goal::Quality(10.0 * NOTHING))
            })
        })
    }

    /// One flip of an edge or face of t that is for the better.
    fn improve_one(&mut self, t: u32, ring: &mut Vec<u32>, tets: &mut Vec<u32>) -> bool {
        let n = self.mesh.nodes[t as usize];
        for i in 0..4 {
            for j in 0..i {
                // The ring first: it is short where it counts, unlike the list of triangles at an apex.
                let free = self.mesh.ring(t, n[i], n[j], MOST, ring, tets) && !ring.contains(&GHOST);
                if !free || self.surface.with_edge(n[i], n[j]).is_some() {
                    continue;
                }
                let worst =
                    tets.iter().map(|&t| self.mesh.quality(self.mesh.nodes[t as usize])).fold(f64::INFINITY, f64::min);
                if self.retriangulate(n[i], n[j], ring, tets, Goal::Quality(1.0001 * worst)) {
                    return true;
                }
            }
        }
        (0..4).any(|i| {
            let f = self.mesh.face(t, i);
            let across = self.mesh.across[t as usize][i];
            let (d, e) = (n[i], self.mesh.nodes[(across >> 2) as usize][(across & 3) as usize]);
            if e == GHOST || self.mesh.is_ghost(across >> 2) || self.surface.with_nodes(f).is_some() {
                return false;
            }
            let now = self.mesh.quality(n).min(self.mesh.quality(self.mesh.nodes[(across >> 2) as usize]));
            let better = (0..3).all(|k| self.mesh.quality([f[k], f[(k + 1) % 3], e, d]) > 1.0001 * now);
            better && self.flip_face(t, i)
        })
    }
}
