//! Points into the triangulation, and the flips that keep it Delaunay.
use super::{Conflict, FRAME, NONE, Plane, Point, in_circle, turn};
use crate::mesh::adjacency::sorted2;

impl Plane {
    /// Adds a point, which is looked for from a triangle on.
    ///
    /// # Errors
    /// [`Conflict::Equal`] where there is one already.
    pub(super) fn insert(&mut self, vertex: u32, from: u32) -> Result<(), Conflict> {
        let point = self.point(vertex);
        let triangle = self.locate(point, from).ok_or(Conflict::Lost)?;
        let corners = self.region.triangles[triangle as usize];
        if let Some(&same) = corners.iter().find(|&&v| self.point(v) == point) {
            return Err(match (same as usize).checked_sub(FRAME) {
                Some(same) => {
                    let [first, second] = sorted2([same as u32, vertex - FRAME as u32]);
                    Conflict::Equal(first, second)
                }
                None => Conflict::Lost,
            });
        }
        let on = (0..3).find(|&i| {
            let [b, c] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            turn(self.point(b), self.point(c), point) == 0.0
        });
        let mut stack = match on {
            Some(i) => self.split_edge(triangle, i, vertex)?,
            None => self.split_triangle(triangle, vertex),
        };
        // Each flip makes an edge to the new point.
        self.legalise(&mut stack, self.points.len())
    }

    /// The triangle that a point lies in, boundary included: by a walk towards it.
    fn locate(&self, point: Point, mut t: u32) -> Option<u32> {
        let mut from = NONE;
        for step in 0..=4 * self.region.triangles.len() {
            let corners = self.region.triangles[t as usize].map(|v| self.point(v));
            let next = (0..3).map(|k| (k + step) % 3).find(|&i| {
                let over = self.region.beside[t as usize][i];
                (over != from || over == NONE) && turn(corners[(i + 1) % 3], corners[(i + 2) % 3], point) < 0.0
            });
            match next {
                None => return Some(t),
                Some(i) => {
                    from = t;
                    t = self.region.beside[t as usize][i];
                    if t == NONE {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// Divides a triangle into three: edges to look at.
    fn split_triangle(&mut self, t: u32, vertex: u32) -> Vec<(u32, usize)> {
        let ([t, u, w], [a, b, c]) = self.region.split_triangle(t, vertex);
        self.now_at([(a, u), (b, t), (c, t), (vertex, t)]);
        vec![(t, 0), (u, 0), (w, 0)]
    }

    /// Divides the two triangles at an edge into four: edges to look at.
    fn split_edge(&mut self, t: u32, i: usize, vertex: u32) -> Result<Vec<(u32, usize)>, Conflict> {
        if self.region.beside[t as usize][i] == NONE {
            return Err(Conflict::Lost);
        }
        let ([t, u, w, x], [a, b, c, d]) = self.region.split_edge(t, i, vertex);
        self.now_at([(a, t), (b, t), (c, w), (d, u), (vertex, t)]);
        Ok(vec![(t, 0), (u, 0), (w, 0), (x, 0)])
    }

    /// Flips edges, given by a triangle and the corner opposite, until all about them are Delaunay.
    ///
    /// # Errors
    /// [`Conflict::Lost`] where that takes more than `left` flips: predicates are not exact where products of coordinates overflow or underflow.
    pub(super) fn legalise(&mut self, stack: &mut Vec<(u32, usize)>, mut left: usize) -> Result<(), Conflict> {
        while let Some((t, i)) = stack.pop() {
            let u = self.region.beside[t as usize][i];
            if u == NONE || self.region.fixed[t as usize][i] != NONE {
                continue;
            }
            let j = self.region.place_beside(t, i);
            let [a, b, c] = self.region.triangles[t as usize].map(|v| self.point(v));
            if in_circle(a, b, c, self.point(self.region.triangles[u as usize][j])) > 0.0 {
                left = left.checked_sub(1).ok_or(Conflict::Lost)?;
                self.flip(t, i);
                stack.extend([(t, 0), (u, 0), (t, 2), (u, 1)]);
            }
        }
        Ok(())
    }
}
