//! The regions that the triangles of the surface separate.
use super::complex::{GHOST, NONE};
use super::recovery::Recovery;
use crate::mesh::adjacency::sorted3;

/// Tetrahedra by region.
pub struct Regions {
    /// Region of each slot of tetrahedra; 0 is outside.
    pub of: Vec<u32>,
    /// Regions on the side of each triangle that its normal points to, and on the other.
    pub sides: Vec<[u32; 2]>,
    /// Number of regions, the outside among them.
    pub count: u32,
}

impl Recovery<'_> {
    /// Fills regions from the hull and then from the sides of the triangles, in their order. The first triangle that is no face
    /// is the error.
    pub fn regions(&mut self) -> Result<Regions, u32> {
        let slots = self.mesh.nodes.len();
        let mut wall = vec![0_u8; slots];
        let mut front = Vec::with_capacity(self.surface.nodes.len());
        for t in 0..self.surface.nodes.len() {
            let f = self.surface.nodes[t];
            let k = self.find_facet(f).ok_or(t as u32)?;
            let i = (0..4).find(|&i| !f.contains(&self.mesh.nodes[k as usize][i])).ok_or(t as u32)?;
            debug_assert_eq!(sorted3(f), sorted3(self.mesh.face(k, i)));
            let o = self.mesh.across[k as usize][i];
            wall[k as usize] |= 1 << i;
            wall[(o >> 2) as usize] |= 1 << (o & 3);
            // The face has its tetrahedron on the positive side.
            let g = self.mesh.face(k, i);
            let same = (0..3).any(|r| [g[r], g[(r + 1) % 3], g[(r + 2) % 3]] == f);
            front.push(if same { [k, o >> 2] } else { [o >> 2, k] });
        }
        let mut of = vec![NONE; slots];
        let mut count = 0;
        let hull = (0..slots).find(|&t| self.mesh.nodes[t][0] != GHOST && self.mesh.nodes[t][3] == GHOST);
        let mut stack: Vec<u32> = Vec::new();
        for start in hull.into_iter().map(|t| t as u32).chain(front.iter().flatten().copied()) {
            if of[start as usize] != NONE {
                continue;
            }
            of[start as usize] = count;
            stack.push(start);
            while let Some(t) = stack.pop() {
                for i in 0..4 {
                    let o = self.mesh.across[t as usize][i] >> 2;
                    if wall[t as usize] >> i & 1 == 0 && of[o as usize] == NONE {
                        of[o as usize] = count;
                        stack.push(o);
                    }
                }
            }
            count += 1;
        }
        let sides = front.iter().map(|pair| pair.map(|t| of[t as usize])).collect();
        Ok(Regions { of, sides, count })
    }
}
