//! Triangles that know each other; and what the segments bound: those that an odd number of them separates from the far outside.
use super::{FRAME, NONE, Plane};

/// The two triangles at an edge: t = (a, b, c) and u = (d, c, b).
struct AtEdge {
    u: u32,
    corners: [u32; 4],
    /// What is beside, and the segment, at ca, ab, bd and dc.
    beside: [u32; 4],
    fixed: [u32; 4],
}

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

impl Region {
    /// The place, in the triangle beside, of the edge opposite to corner i.
    pub fn place_beside(&self, triangle: u32, i: usize) -> usize {
        let other = self.beside[triangle as usize][i];
        self.beside[other as usize].iter().position(|&t| t == triangle).unwrap_or(0)
    }

    /// The triangle t and the one across the edge opposite to its corner i, which must be there.
    fn at_edge(&self, t: u32, i: usize) -> AtEdge {
        let (u, j) = (self.beside[t as usize][i], self.place_beside(t, i));
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let sides = [(t, i + 1), (t, i + 2), (u, j + 1), (u, j + 2)];
        let of = |all: &[[u32; 3]]| sides.map(|(triangle, k)| all[triangle as usize][k % 3]);
        let corners = [a, b, c, self.triangles[u as usize][j]];
        AtEdge { u, corners, beside: of(&self.beside), fixed: of(&self.fixed) }
    }

    /// Turns the edge opposite to corner i of a triangle into the other diagonal of the two triangles at it: t = (a, b, c), u = (d, c, b)
    /// become t = (a, b, d), u = (a, d, c). Returns u and the corners.
    pub fn flip(&mut self, t: u32, i: usize) -> (u32, [u32; 4]) {
        let AtEdge { u, corners, beside: [ca, ab, bd, dc], fixed: [on_ca, on_ab, on_bd, on_dc] } = self.at_edge(t, i);
        let [a, b, c, d] = corners;
        self.set(t, [a, b, d], [bd, u, ab], [on_bd, NONE, on_ab]);
        self.set(u, [a, d, c], [dc, ca, t], [on_dc, on_ca, NONE]);
        self.relink(bd, u, t);
        self.relink(ca, t, u);
        (u, corners)
    }

    /// Divides the two triangles at the edge opposite to corner i of t by a vertex on it, into (v, a, b), (v, b, d), (v, c, a) and (v, d, c).
    /// Returns these four, the first two being t and u, and the corners.
    pub fn split_edge(&mut self, t: u32, i: usize, v: u32) -> ([u32; 4], [u32; 4]) {
        let on = self.fixed[t as usize][i];
        let AtEdge { u, corners, beside: [ca, ab, bd, dc], fixed: [on_ca, on_ab, on_bd, on_dc] } = self.at_edge(t, i);
        let [a, b, c, d] = corners;
        let w = self.add();
        let x = self.add();
        self.set(t, [v, a, b], [ab, u, w], [on_ab, on, NONE]);
        self.set(u, [v, b, d], [bd, x, t], [on_bd, NONE, on]);
        self.set(w, [v, c, a], [ca, t, x], [on_ca, NONE, on]);
        self.set(x, [v, d, c], [dc, w, u], [on_dc, on, NONE]);
        self.relink(ca, t, w);
        self.relink(dc, u, x);
        ([t, u, w, x], corners)
    }

    /// Divides a triangle (a, b, c) into (v, b, c), itself, (v, c, a) and (v, a, b). Returns these, and the corners.
    pub fn split_triangle(&mut self, t: u32, v: u32) -> ([u32; 3], [u32; 3]) {
        let [corners, beside, fixed] = [&self.triangles, &self.beside, &self.fixed].map(|all| all[t as usize]);
        let ([a, b, c], [bc, ca, ab], [on_bc, on_ca, on_ab]) = (corners, beside, fixed);
        let u = self.add();
        let w = self.add();
        self.set(t, [v, b, c], [bc, u, w], [on_bc, NONE, NONE]);
        self.set(u, [v, c, a], [ca, w, t], [on_ca, NONE, NONE]);
        self.set(w, [v, a, b], [ab, t, u], [on_ab, NONE, NONE]);
        self.relink(ca, t, u);
        self.relink(ab, t, w);
        ([t, u, w], corners)
    }

    /// A further triangle, which is set next.
    fn add(&mut self) -> u32 {
        for all in [&mut self.triangles, &mut self.beside, &mut self.fixed] {
            all.push([NONE; 3]);
        }
        self.triangles.len() as u32 - 1
    }

    fn set(&mut self, t: u32, corners: [u32; 3], beside: [u32; 3], fixed: [u32; 3]) {
        self.triangles[t as usize] = corners;
        self.beside[t as usize] = beside;
        self.fixed[t as usize] = fixed;
    }

    /// Puts `new` in the place of `old` beside a triangle.
    fn relink(&mut self, triangle: u32, old: u32, new: u32) {
        if triangle != NONE
            && let Some(beside) = self.beside[triangle as usize].iter_mut().find(|beside| **beside == old)
        {
            *beside = new;
        }
    }
}

impl Plane {
    /// The inside, where `counts` says which segments are its border: others have it on both sides, or on none.
    pub fn region(&self, counts: impl Fn(u32) -> bool) -> Region {
        let mut inside: Vec<Option<bool>> = vec![None; self.region.triangles.len()];
        let mut stack = vec![(self.at[0], false)];
        inside[self.at[0] as usize] = Some(false);
        while let Some((t, is_inside)) = stack.pop() {
            for i in 0..3 {
                let (u, segment) = (self.region.beside[t as usize][i], self.region.fixed[t as usize][i]);
                if u != NONE && inside[u as usize].is_none() {
                    let other = is_inside != (segment != NONE && counts(segment));
                    inside[u as usize] = Some(other);
                    stack.push((u, other));
                }
            }
        }
        let mut new = vec![NONE; self.region.triangles.len()];
        let kept: Vec<usize> = (0..self.region.triangles.len()).filter(|&t| inside[t] == Some(true)).collect();
        for (i, &t) in kept.iter().enumerate() {
            new[t] = i as u32;
        }
        Region {
            triangles: kept.iter().map(|&t| self.region.triangles[t].map(|v| v.saturating_sub(FRAME as u32))).collect(),
            beside: kept
                .iter()
                .map(|&t| self.region.beside[t].map(|u| if u == NONE { NONE } else { new[u as usize] }))
                .collect(),
            fixed: kept.iter().map(|&t| self.region.fixed[t]).collect(),
        }
    }
}
