//! Segments into the triangulation: the edges that a segment crosses are flipped until it is an edge itself (Sloan 1993; Anglada 1997).
use super::{Conflict, FRAME, NONE, Plane, turn};
use std::collections::VecDeque;

/// Most flips about an edge that a segment no longer crosses, for each point of the plane.
const FLIPS: usize = 100;

impl Plane {
    /// Makes the segment between two points an edge. The segment that is there already, if one is.
    ///
    /// # Errors
    /// [`Conflict`] where it crosses another or a point lies in it; the triangulation is as it was.
    pub fn constrain(&mut self, [from, to]: [u32; 2], segment: u32) -> Result<Option<u32>, Conflict> {
        let [a, b] = [from + FRAME as u32, to + FRAME as u32];
        if a == b {
            return Err(Conflict::Equal(from, to));
        }
        if self.edge(a, b).is_none() {
            let crossed = self.crossed(a, b, segment)?;
            self.clear(a, b, crossed)?;
        }
        let (t, i) = self.edge(a, b).ok_or(Conflict::Lost)?;
        let before = self.region.fixed[t as usize][i];
        if before != NONE {
            return Ok(Some(before));
        }
        self.region.fixed[t as usize][i] = segment;
        let u = self.region.beside[t as usize][i];
        if u != NONE {
            let j = self.region.place_beside(t, i);
            self.region.fixed[u as usize][j] = segment;
        }
        Ok(None)
    }

    /// The edges that the segment from a to b crosses.
    fn crossed(&self, a: u32, b: u32, segment: u32) -> Result<VecDeque<[u32; 2]>, Conflict> {
        let [at_a, at_b] = [a, b].map(|v| self.point(v));
        let (mut t, mut i) = self.towards(a, b, segment)?;
        let mut crossed = VecDeque::new();
        loop {
            let here = self.region.fixed[t as usize][i];
            if here != NONE {
                return Err(Conflict::Cross(segment, here));
            }
            let [right, left] = [1, 2].map(|k| self.region.triangles[t as usize][(i + k) % 3]);
            crossed.push_back([right, left]);
            let u = self.region.beside[t as usize][i];
            if u == NONE || crossed.len() > self.region.triangles.len() {
                return Err(Conflict::Lost);
            }
            let j = self.region.place_beside(t, i);
            let ahead = self.region.triangles[u as usize][j];
            if ahead == b {
                return Ok(crossed);
            }
            let side = turn(at_a, at_b, self.point(ahead));
            if side == 0.0 {
                return Err(touch(ahead, segment));
            }
            // u = (ahead, left, right): the segment leaves it between ahead and right, or left and ahead.
            (t, i) = (u, if side > 0.0 { (j + 1) % 3 } else { (j + 2) % 3 });
        }
    }

    /// The triangle at a into which the segment to b goes, and the place of a in it.
    fn towards(&self, a: u32, b: u32, segment: u32) -> Result<(u32, usize), Conflict> {
        let [at_a, at_b] = [a, b].map(|v| self.point(v));
        let start = self.at[a as usize];
        let mut t = start;
        loop {
            let i = self.place(t, a);
            let [right, left] = [1, 2].map(|k| self.region.triangles[t as usize][(i + k) % 3]);
            let [of_right, of_left] = [right, left].map(|v| turn(at_a, at_b, self.point(v)));
            for (v, side) in [(right, of_right), (left, of_left)] {
                let to = self.point(v);
                let along = (to[0] - at_a[0]) * (at_b[0] - at_a[0]) + (to[1] - at_a[1]) * (at_b[1] - at_a[1]);
                if side == 0.0 && along > 0.0 {
                    return Err(touch(v, segment));
                }
            }
            if of_right < 0.0 && of_left > 0.0 {
                return Ok((t, i));
            }
            t = self.region.beside[t as usize][(i + 1) % 3];
            if t == NONE || t == start {
                return Err(Conflict::Lost);
            }
        }
    }

    /// Flips the edges that the segment from a to b crosses out of its way, then others until they are Delaunay.
    fn clear(&mut self, a: u32, b: u32, mut crossed: VecDeque<[u32; 2]>) -> Result<(), Conflict> {
        let [at_a, at_b] = [a, b].map(|v| self.point(v));
        let mut fresh = Vec::new();
        let mut left = 64 + 16 * crossed.len() * crossed.len();
        while let Some([p, q]) = crossed.pop_front() {
            left = left.checked_sub(1).ok_or(Conflict::Lost)?;
            let (t, i) = self.edge(p, q).ok_or(Conflict::Lost)?;
            let u = self.region.beside[t as usize][i];
            let [c, d] = [
                self.region.triangles[t as usize][i],
                self.region.triangles[u as usize][self.region.place_beside(t, i)],
            ];
            let [at_p, at_q, at_c, at_d] = [p, q, c, d].map(|v| self.point(v));
            if turn(at_c, at_d, at_p) * turn(at_c, at_d, at_q) >= 0.0 || turn(at_c, at_d, at_p) == 0.0 {
                crossed.push_back([p, q]);
                continue;
            }
            self.flip(t, i);
            let sides = [turn(at_a, at_b, at_c), turn(at_a, at_b, at_d)];
            let is_across = ![a, b].contains(&c) && ![a, b].contains(&d) && (sides[0] > 0.0) != (sides[1] > 0.0);
            if is_across {
                crossed.push_back([c, d]);
            } else {
                fresh.push([c, d]);
            }
        }
        // The segment itself stays.
        let (t, i) = self.edge(a, b).ok_or(Conflict::Lost)?;
        let (u, j) = (self.region.beside[t as usize][i], self.region.place_beside(t, i));
        (self.region.fixed[t as usize][i], self.region.fixed[u as usize][j]) = (0, 0);
        for [p, q] in fresh {
            if let Some(edge) = self.edge(p, q) {
                self.legalise(&mut vec![edge], FLIPS * self.points.len())?;
            }
        }
        let (t, i) = self.edge(a, b).ok_or(Conflict::Lost)?;
        let (u, j) = (self.region.beside[t as usize][i], self.region.place_beside(t, i));
        (self.region.fixed[t as usize][i], self.region.fixed[u as usize][j]) = (NONE, NONE);
        Ok(())
    }
}

fn touch(vertex: u32, segment: u32) -> Conflict {
    (vertex as usize)
        .checked_sub(FRAME)
        .map_or(Conflict::Lost, |point| Conflict::Touch { point: point as u32, segment })
}
