//! An edge of a face in halves.
use super::super::plane::{NONE, Point, turn};
use super::{Patch, UPRIGHT, look, sample};
use crate::geometry::OcctEvaluator;
use crate::mesh::vector::{distance, dot, norm, sub};

/// The cosine of the angle under which a point may see a chord of the border.
const FLAT: f64 = -0.5;

impl Patch {
    /// Where an edge is halved in the plane. All of a pole's line is one point: towards it the way is across that line.
    pub(super) fn middle(&self, a: u32, b: u32) -> Point {
        let [p, q] = [a, b].map(|c| self.plane[c as usize]);
        let middle = [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
        let along = |other: Point, d: Point| {
            let off = (other[0] - middle[0]) * d[0] + (other[1] - middle[1]) * d[1];
            [middle[0] + off * d[0], middle[1] + off * d[1]]
        };
        match [a, b].map(|c| self.pole_lines[c as usize]) {
            [Some(d), None] => along(q, d),
            [None, Some(d)] => along(p, d),
            _ => middle,
        }
    }

    pub(super) fn unscaled(&self, at: Point) -> Point {
        self.scale.parameters(at)
    }

    /// Halves the edge opposite to corner i; not where rounding would turn a triangle over.
    pub(super) fn halve(
        &mut self,
        on: &mut OcctEvaluator,
        face: u32,
        t: u32,
        i: usize,
        growth: f64,
        fresh: &mut Vec<(u32, usize)>,
    ) {
        let u = self.beside[t as usize][i];
        let Some(j) = (u != NONE).then(|| self.beside[u as usize].iter().position(|&x| x == t)).flatten() else {
            return;
        };
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let d = self.triangles[u as usize][j];
        let flat = |p: u32| self.plane[p as usize];
        let is_inside = |m: Point| {
            let parts = [[flat(a), flat(b), m], [flat(a), m, flat(c)], [flat(d), flat(c), m], [flat(d), m, flat(b)]];
            parts.iter().all(|&[p, q, r]| turn(p, q, r) > 0.0)
        };
        let [p, q] = [flat(b), flat(c)];
        let Some(m) =
            [self.middle(b, c), [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]].into_iter().find(|&m| is_inside(m))
        else {
            return;
        };
        let here = sample(on, face, self.unscaled(m));
        if !here.at.iter().all(|x| x.is_finite()) {
            return;
        }
        let near = 1e-6 * distance(self.spot(b), self.spot(c));
        if [a, b, c, d].into_iter().any(|v| distance(self.spot(v), here.at) <= near) {
            return;
        }
        // A chord of the border beside which a point would lie is to be halved first (Ruppert 1995); beyond it the surface may be outside.
        let of = |all: &[[u32; 3]], t: u32, k: usize| all[t as usize][k % 3];
        let outer = [
            of(&self.fixed, t, i + 2),
            of(&self.fixed, t, i + 1),
            of(&self.fixed, u, j + 1),
            of(&self.fixed, u, j + 2),
        ];
        let mut is_outside = false;
        for (ends, on) in [[a, b], [c, a], [b, d], [d, c]].into_iter().zip(outer) {
            let [p, q] = ends.map(|c| self.spot(c));
            let normals = [self.normals[ends[0] as usize], self.normals[ends[1] as usize], here.normal];
            let [to_p, to_q] = [p, q].map(|p| sub(p, here.at));
            let (near, most) = (dot(to_p, to_q), norm(to_p) * norm(to_q));
            let least = if self.is_strict { UPRIGHT } else { 0.0 };
            if on != NONE
                && (self.is_strict && near < FLAT * most || near < 0.0 && look([p, q, here.at], normals) < least)
            {
                self.pressed.push(on);
                is_outside = true;
            }
        }
        if is_outside {
            return;
        }
        let vertex = self.plane.len() as u32;
        let size = self.grown(b, here.at, growth).min(self.grown(c, here.at, growth));
        self.plane.push(m);
        self.at.push(here.at);
        self.normals.push(here.normal);
        self.sizes.push(size);
        self.points.push(NONE);
        self.is_pole.push(false);
        self.pole_lines.push(None);
        let (parts, _) = self.split_edge(t, i, vertex);
        fresh.extend(parts.map(|part| (part, 0)));
    }
}
