//! Points into the triangulation, and the flips that keep it Delaunay.
use super::{Conflict, FRAME, NONE, Plane, Point, in_circle, turn};

impl Plane {
    /// Adds a point; it gets the next number.
    ///
    /// # Errors
    /// [`Conflict::Equal`] where it is there already.
    pub(super) fn insert(&mut self, point: Point) -> Result<u32, Conflict> {
        let triangle = self.locate(point).ok_or(Conflict::Lost)?;
        let vertex = self.points.len() as u32;
        let corners = self.triangles[triangle as usize];
        if let Some(&same) = corners.iter().find(|&&v| self.point(v) == point) {
            return Err(match (same as usize).checked_sub(FRAME) {
                Some(same) => Conflict::Equal(same as u32, vertex - FRAME as u32),
                None => Conflict::Lost,
            });
        }
        self.points.push(point);
        self.at.push(triangle);
        let on = (0..3).find(|&i| {
            let [b, c] = [corners[(i + 1) % 3], corners[(i + 2) % 3]];
            turn(self.point(b), self.point(c), point) == 0.0
        });
        let mut stack = match on {
            Some(i) => self.split_edge(triangle, i, vertex)?,
            None => self.split_triangle(triangle, vertex),
        };
        self.legalise(&mut stack);
        self.last = self.at[vertex as usize];
        Ok(vertex - FRAME as u32)
    }

    /// The triangle that a point lies in, boundary included: by a walk towards it.
    fn locate(&self, point: Point) -> Option<u32> {
        let mut t = self.last;
        let mut from = NONE;
        for step in 0..=4 * self.triangles.len() {
            let corners = self.triangles[t as usize].map(|v| self.point(v));
            let next = (0..3).map(|k| (k + step) % 3).find(|&i| {
                let over = self.beside[t as usize][i];
                (over != from || over == NONE) && turn(corners[(i + 1) % 3], corners[(i + 2) % 3], point) < 0.0
            });
            match next {
                None => return Some(t),
                Some(i) => {
                    from = t;
                    t = self.beside[t as usize][i];
                    if t == NONE {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// Divides a triangle into three.
    fn split_triangle(&mut self, t: u32, vertex: u32) -> Vec<(u32, usize)> {
        let [a, b, c] = self.triangles[t as usize];
        let [bc, ca, ab] = self.beside[t as usize];
        let [fixed_bc, fixed_ca, fixed_ab] = self.fixed[t as usize];
        let [u, w] = [0, 1].map(|k| self.triangles.len() as u32 + k);
        self.triangles[t as usize] = [vertex, b, c];
        self.beside[t as usize] = [bc, u, w];
        self.fixed[t as usize] = [fixed_bc, NONE, NONE];
        self.triangles.extend([[vertex, c, a], [vertex, a, b]]);
        self.beside.extend([[ca, w, t], [ab, t, u]]);
        self.fixed.extend([[fixed_ca, NONE, NONE], [fixed_ab, NONE, NONE]]);
        self.relink(ca, t, u);
        self.relink(ab, t, w);
        for (v, triangle) in [(a, u), (b, t), (c, t), (vertex, t)] {
            self.at[v as usize] = triangle;
        }
        vec![(t, 0), (u, 0), (w, 0)]
    }

    /// Divides the two triangles at an edge into four.
    fn split_edge(&mut self, t: u32, i: usize, vertex: u32) -> Result<Vec<(u32, usize)>, Conflict> {
        let u = self.beside[t as usize][i];
        if u == NONE {
            return Err(Conflict::Lost);
        }
        let j = self.place_beside(t, i);
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let d = self.triangles[u as usize][j];
        let of = |all: &[[u32; 3]], t: u32, k: usize| all[t as usize][k % 3];
        let [ca, ab] = [of(&self.beside, t, i + 1), of(&self.beside, t, i + 2)];
        let [bd, dc] = [of(&self.beside, u, j + 1), of(&self.beside, u, j + 2)];
        let [fixed_ca, fixed_ab] = [of(&self.fixed, t, i + 1), of(&self.fixed, t, i + 2)];
        let [fixed_bd, fixed_dc] = [of(&self.fixed, u, j + 1), of(&self.fixed, u, j + 2)];
        let on = self.fixed[t as usize][i];
        let [w, x] = [0, 1].map(|k| self.triangles.len() as u32 + k);
        self.triangles[t as usize] = [vertex, a, b];
        self.beside[t as usize] = [ab, u, w];
        self.fixed[t as usize] = [fixed_ab, on, NONE];
        self.triangles[u as usize] = [vertex, b, d];
        self.beside[u as usize] = [bd, x, t];
        self.fixed[u as usize] = [fixed_bd, NONE, on];
        self.triangles.extend([[vertex, c, a], [vertex, d, c]]);
        self.beside.extend([[ca, t, x], [dc, w, u]]);
        self.fixed.extend([[fixed_ca, NONE, on], [fixed_dc, on, NONE]]);
        self.relink(ca, t, w);
        self.relink(dc, u, x);
        for (v, triangle) in [(a, t), (b, t), (c, w), (d, u), (vertex, t)] {
            self.at[v as usize] = triangle;
        }
        Ok(vec![(t, 0), (u, 0), (w, 0), (x, 0)])
    }

    /// Flips edges, given by a triangle and the corner opposite, until all about them are Delaunay.
    pub(super) fn legalise(&mut self, stack: &mut Vec<(u32, usize)>) {
        while let Some((t, i)) = stack.pop() {
            let u = self.beside[t as usize][i];
            if u == NONE || self.fixed[t as usize][i] != NONE {
                continue;
            }
            let j = self.place_beside(t, i);
            let [a, b, c] = self.triangles[t as usize].map(|v| self.point(v));
            if in_circle(a, b, c, self.point(self.triangles[u as usize][j])) > 0.0 {
                self.flip(t, i);
                stack.extend([(t, 0), (u, 0), (t, 2), (u, 1)]);
            }
        }
    }
}
