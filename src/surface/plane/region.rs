//! What the segments bound: the triangles that an odd number of them separates from the far outside.
use super::{FRAME, NONE, Plane};

/// Triangles, with those beside them and the segments on their edges.
#[derive(Clone, Debug, Default)]
pub struct Region {
    /// Corners, counter-clockwise, by the numbers of the points.
    pub triangles: Vec<[u32; 3]>,
    /// The triangle across the edge opposite to each corner.
    pub beside: Vec<[u32; 3]>,
    /// The segment on that edge.
    pub fixed: Vec<[u32; 3]>,
}

impl Plane {
    /// The inside, where `counts` says which segments are its border: others have it on both sides, or on none.
    pub fn region(&self, counts: impl Fn(u32) -> bool) -> Region {
        let mut inside: Vec<Option<bool>> = vec![None; self.triangles.len()];
        let mut stack = vec![(self.at[0], false)];
        inside[self.at[0] as usize] = Some(false);
        while let Some((t, is_inside)) = stack.pop() {
            for i in 0..3 {
                let (u, segment) = (self.beside[t as usize][i], self.fixed[t as usize][i]);
                if u != NONE && inside[u as usize].is_none() {
                    let other = is_inside != (segment != NONE && counts(segment));
                    inside[u as usize] = Some(other);
                    stack.push((u, other));
                }
            }
        }
        let mut new = vec![NONE; self.triangles.len()];
        let kept: Vec<usize> = (0..self.triangles.len()).filter(|&t| inside[t] == Some(true)).collect();
        for (i, &t) in kept.iter().enumerate() {
            new[t] = i as u32;
        }
        Region {
            triangles: kept.iter().map(|&t| self.triangles[t].map(|v| v.saturating_sub(FRAME as u32))).collect(),
            beside: kept
                .iter()
                .map(|&t| self.beside[t].map(|u| if u == NONE { NONE } else { new[u as usize] }))
                .collect(),
            fixed: kept.iter().map(|&t| self.fixed[t]).collect(),
        }
    }
}
