//! The triangles of one face: first those of its border, then as fine as its surface wants, by halving edges and turning diagonals.
use super::edges::{STRETCH, angle};
use super::outline::Outline;
use super::plane::{Conflict, NONE, Plane, Point, Region, in_circle, turn};
use super::points::Points;
use super::{Options, Wish};
use crate::geometry::OcctEvaluator;
use crate::mesh::vector::{Vec3, add, area2, cross, distance, dot, lerp, norm, scale, sub};
use std::collections::BTreeSet;

/// Rounds of halving at most, and triangles at most.
const ROUNDS: usize = 40;
const TRIANGLES: usize = 400_000;
/// Cosines between a triangle and its surface: what new ones must have, if the old ones had it; below what one looks away.
const UPRIGHT: f64 = 0.5;
const TURNED: f64 = 0.1;
/// The cosine of the angle under which a point may see a chord of the border.
const FLAT: f64 = -0.5;
/// Triangles of this share of their face may look where they will.
const SMALL: f64 = 2e-3;
/// The curvature across an edge divides it only if it is longer than this share of its face.
const ACROSS: f64 = 1.0 / 24.0;

/// The triangles of a face.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Places in the scaled plane.
    plane: Vec<Point>,
    scale: Point,
    /// Coordinates.
    pub at: Vec<Vec3>,
    /// Unit normals Su × Sv; zero where there is none.
    normals: Vec<Vec3>,
    sizes: Vec<f64>,
    /// The diagonal of the border's box.
    reach: f64,
    /// The number among all points; [`NONE`] for those inside the face.
    pub points: Vec<u32>,
    /// Whether a corner is one of several of a pole.
    is_pole: Vec<bool>,
    /// The direction of that pole's line.
    pole_lines: Vec<Option<Point>>,
    /// Corners, counter-clockwise in the plane of the parameters.
    pub triangles: Vec<[u32; 3]>,
    beside: Vec<[u32; 3]>,
    /// The segment on the edge opposite to each corner.
    pub fixed: Vec<[u32; 3]>,
    /// Whether chords of the border keep points away; else only those that would turn triangles over.
    pub is_strict: bool,
    /// Segments whose chords were in the way of a point.
    pub pressed: Vec<u32>,
}

/// What is asked of the surface at a point.
struct Sample {
    at: Vec3,
    normal: Vec3,
    bend: f64,
}

/// Point, unit normal Su × Sv and greatest curvature of a face.
fn sample(on: &mut OcctEvaluator, face: u32, uv: Point) -> Sample {
    let jet = on.surface(face, uv);
    let across = cross(jet.du, jet.dv);
    let (area, sides) = (norm(across), norm(jet.du) * norm(jet.dv));
    if !(area > 1e-7 * sides) || !(area > 0.0) {
        return Sample { at: jet.point, normal: [0.0; 3], bend: 0.0 };
    }
    let normal = scale(across, 1.0 / area);
    let (e, f, g) = (dot(jet.du, jet.du), dot(jet.du, jet.dv), dot(jet.dv, jet.dv));
    let (l, m, n) = (dot(jet.duu, normal), dot(jet.duv, normal), dot(jet.dvv, normal));
    let square = area * area;
    let mean = 0.5 * (e * n - 2.0 * f * m + g * l) / square;
    let product = (l * n - m * m) / square;
    let bend = mean.abs() + (mean * mean - product).max(0.0).sqrt();
    Sample { at: jet.point, normal, bend: if bend.is_finite() { bend } else { 0.0 } }
}

impl Patch {
    /// The triangles of a border alone.
    ///
    /// # Errors
    /// What of the border is in conflict, by corners and segments of the outline.
    pub fn new(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points) -> Result<Self, Vec<Conflict>> {
        let mut plane = Plane::new(&outline.corners).map_err(|conflict| vec![conflict])?;
        let mut counts: Vec<bool> = outline.segments.iter().map(|segment| segment.counts).collect();
        let mut conflicts = Vec::new();
        for (i, segment) in outline.segments.iter().enumerate() {
            match plane.constrain(segment.ends, i as u32) {
                Ok(None) => {}
                Ok(Some(other)) => {
                    let of = &outline.segments[other as usize];
                    if of.edge == segment.edge && of.piece == segment.piece {
                        counts[other as usize] ^= segment.counts;
                    } else {
                        conflicts.push(Conflict::Cross(i as u32, other));
                    }
                }
                Err(conflict) => conflicts.push(conflict),
            }
        }
        if !conflicts.is_empty() {
            return Err(conflicts);
        }
        let region = plane.region(|segment| counts[segment as usize]);
        Ok(Self::of_region(on, face, outline, points, region))
    }

    fn of_region(on: &mut OcctEvaluator, face: u32, outline: &Outline, points: &Points, region: Region) -> Self {
        let mut patch = Self {
            plane: outline.corners.clone(),
            scale: outline.scale,
            at: outline.points.iter().map(|&p| points.at[p as usize]).collect(),
            sizes: vec![f64::INFINITY; outline.corners.len()],
            points: outline.points.clone(),
            triangles: region.triangles,
            beside: region.beside,
            fixed: region.fixed,
            ..Self::default()
        };
        patch.normals = (0..patch.plane.len()).map(|i| sample(on, face, patch.uv(i as u32)).normal).collect();
        patch.is_pole = vec![false; outline.corners.len()];
        patch.pole_lines = vec![None; outline.corners.len()];
        let extent = |k: usize| {
            let all = || patch.at.iter().map(|p| p[k]);
            all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
        };
        patch.reach = norm([0, 1, 2].map(extent));
        for segment in &outline.segments {
            let [a, b] = segment.ends.map(|c| c as usize);
            if segment.piece == NONE {
                (patch.is_pole[a], patch.is_pole[b]) = (true, true);
                let [p, q] = [a, b].map(|c| patch.plane[c]);
                let far = (q[0] - p[0]).hypot(q[1] - p[1]);
                let line = (far > 0.0).then(|| [(q[0] - p[0]) / far, (q[1] - p[1]) / far]);
                (patch.pole_lines[a], patch.pole_lines[b]) = (line, line);
            }
            let length = distance(patch.at[a], patch.at[b]);
            // Pieces of a pole have no length, and say nothing.
            if length > 0.0 {
                for c in [a, b] {
                    let size = &mut patch.sizes[c];
                    *size = if size.is_finite() { size.max(length) } else { length };
                }
            }
        }
        patch
    }

    /// Triangles that are known, of corners without parameters.
    pub fn of_triangles(at: Vec<Vec3>, points: Vec<u32>, triangles: Vec<[u32; 3]>) -> Self {
        let count = at.len();
        Self {
            plane: vec![[0.0; 2]; count],
            scale: [1.0; 2],
            at,
            normals: vec![[0.0; 3]; count],
            sizes: vec![f64::INFINITY; count],
            reach: 0.0,
            points,
            is_pole: vec![false; count],
            pole_lines: vec![None; count],
            beside: vec![[NONE; 3]; triangles.len()],
            fixed: vec![[NONE; 3]; triangles.len()],
            triangles,
            is_strict: false,
            pressed: Vec::new(),
        }
    }

    /// Its plane is none of parameters.
    pub fn forget_plane(&mut self) {
        self.normals.iter_mut().for_each(|normal| *normal = [0.0; 3]);
    }

    /// Parameters of a corner.
    pub fn uv(&self, corner: u32) -> Point {
        let at = self.plane[corner as usize];
        [at[0] / self.scale[0], at[1] / self.scale[1]]
    }

    fn spot(&self, corner: u32) -> Vec3 {
        self.at[corner as usize]
    }

    fn place(&self, triangle: u32, corner: u32) -> Option<usize> {
        self.triangles[triangle as usize].iter().position(|&c| c == corner)
    }

    /// Whether two corners are one point in space.
    fn is_one(&self, a: u32, b: u32) -> bool {
        self.points[a as usize] != NONE && self.points[a as usize] == self.points[b as usize]
    }

    /// Makes it as fine as the options, the wishes and its own curvature want. Edges between the pairs of points that are `barred` are
    /// halved in any case.
    pub fn refine(
        &mut self,
        on: &mut OcctEvaluator,
        face: u32,
        options: &Options,
        wishes: &[Wish],
        barred: &BTreeSet<[u32; 2]>,
    ) {
        let all: Vec<(u32, usize)> = (0..self.triangles.len() as u32).flat_map(|t| [(t, 0), (t, 1), (t, 2)]).collect();
        self.straighten(all);
        for _ in 0..ROUNDS {
            let mut wanted = self.wanted(on, face, options, wishes, barred);
            if wanted.is_empty() || self.triangles.len() > TRIANGLES {
                return;
            }
            wanted.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut fresh = Vec::new();
            let mut poles: BTreeSet<[u32; 2]> = BTreeSet::new();
            for (_, [a, b], t) in wanted {
                let Some(i) = self.edge_in(t, a, b) else { continue };
                // Edges of a fan at a pole are one in space.
                let is_at_pole = self.is_pole[a as usize] || self.is_pole[b as usize];
                if is_at_pole && !poles.insert(sorted([self.key(a), self.key(b)])) {
                    continue;
                }
                self.halve(on, face, t, i, options.growth, &mut fresh);
            }
            if fresh.is_empty() {
                return;
            }
            self.straighten(fresh);
        }
    }

    /// The place opposite to the edge of two corners in a triangle.
    fn edge_in(&self, t: u32, a: u32, b: u32) -> Option<usize> {
        let [i, j] = [self.place(t, a)?, self.place(t, b)?];
        Some(3 - i - j)
    }

    /// Edges that are too long, with how much and a triangle.
    fn wanted(
        &self,
        on: &mut OcctEvaluator,
        face: u32,
        options: &Options,
        wishes: &[Wish],
        barred: &BTreeSet<[u32; 2]>,
    ) -> Vec<(f64, [u32; 2], u32)> {
        let twice = self.edges_met_twice();
        let mut found = Vec::new();
        for t in 0..self.triangles.len() as u32 {
            for i in 0..3 {
                let u = self.beside[t as usize][i];
                if u == NONE || self.fixed[t as usize][i] != NONE || u < t {
                    continue;
                }
                let [a, b] = [1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
                let pair = sorted([self.key(a), self.key(b)]);
                let is_barred = barred.contains(&pair) || twice.contains(&pair);
                let ratio = if is_barred { f64::MAX } else { self.excess(on, face, [a, b], options, wishes) };
                if ratio > 1.0 {
                    found.push((ratio, [a.min(b), a.max(b)], t));
                }
            }
        }
        found
    }

    /// What a corner is in space: the number of its point, or one that no point has.
    fn key(&self, corner: u32) -> u32 {
        let point = self.points[corner as usize];
        if point == NONE { corner | 1 << 31 } else { point }
    }

    /// Edges, by what their ends are in space, that are there twice or go from a point to itself: not on both sides of a seam or in the fan
    /// at a pole, where they are one.
    fn edges_met_twice(&self) -> BTreeSet<[u32; 2]> {
        let mut all: Vec<([u32; 2], [u32; 2], bool)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            for i in 0..3 {
                let ends = sorted([corners[(i + 1) % 3], corners[(i + 2) % 3]]);
                all.push((sorted(ends.map(|c| self.key(c))), ends, self.fixed[t][i] != NONE));
            }
        }
        all.sort_unstable();
        all.dedup();
        let mut twice = BTreeSet::new();
        for group in all.chunk_by(|a, b| a.0 == b.0) {
            let pair = group[0].0;
            if pair[0] == pair[1] {
                if group.iter().any(|(_, _, is_fixed)| !is_fixed) {
                    twice.insert(pair);
                }
            } else if group.len() > 1 && !self.are_one_or_fixed(group) {
                twice.insert(pair);
            }
        }
        twice
    }

    /// Whether edges between the same two points are one, or the sides of a seam: those of a fan at a pole are one.
    fn are_one_or_fixed(&self, group: &[([u32; 2], [u32; 2], bool)]) -> bool {
        let is_fan = |a: &[u32; 2], b: &[u32; 2]| {
            let apart = || a.iter().chain(b).filter(|c| !(a.contains(c) && b.contains(c)));
            apart().count() == 2 && apart().all(|&c| self.is_pole[c as usize])
        };
        // Those that are reached from the fixed ones, or from the first where there is none.
        let mut reached: Vec<bool> = group.iter().map(|(_, _, is_fixed)| *is_fixed).collect();
        if !reached.contains(&true) {
            reached[0] = true;
        }
        loop {
            let next = (0..group.len())
                .find(|&i| !reached[i] && (0..group.len()).any(|j| reached[j] && is_fan(&group[i].1, &group[j].1)));
            match next {
                Some(i) => reached[i] = true,
                None => return !reached.contains(&false),
            }
        }
    }

    /// By how much an edge is too long.
    fn excess(&self, on: &mut OcctEvaluator, face: u32, [a, b]: [u32; 2], options: &Options, wishes: &[Wish]) -> f64 {
        let [p, q] = [a, b].map(|c| self.spot(c));
        let length = distance(p, q);
        if !(length > options.least) {
            return 0.0;
        }
        let middle = self.middle(a, b);
        let here = sample(on, face, self.unscaled(middle));
        let mut size =
            options.greatest.min(self.grown(a, here.at, options.growth)).min(self.grown(b, here.at, options.growth));
        for wish in wishes {
            let far = (distance(wish.at, here.at) - wish.radius).max(0.0);
            size = size.min(wish.size.max(options.least) + options.growth * far);
        }
        let mut ratio = length / (1.4 * size);
        let off = sub(here.at, lerp(p, q, 0.5));
        if here.normal != [0.0; 3] {
            ratio = ratio.max(dot(off, here.normal).abs() / length * 8.0 * options.segments / 1.5);
            let [n, m] = [a, b].map(|c| self.normals[c as usize]);
            let is_regular = n != [0.0; 3] && m != [0.0; 3];
            let turned: f64 = [n, m].into_iter().filter(|n| *n != [0.0; 3]).map(|n| angle(n, here.normal)).sum();
            ratio = ratio.max(turned * options.segments / if is_regular { 1.5 } else { 0.8 });
            if is_regular && length > ACROSS * self.reach {
                ratio = ratio.max(length * options.segments * here.bend / STRETCH);
            }
        } else if norm(off) > 0.25 * length {
            ratio = ratio.max(2.0);
        }
        ratio
    }

    /// The size at a corner, grown up to a point.
    fn grown(&self, corner: u32, at: Vec3, growth: f64) -> f64 {
        self.sizes[corner as usize] + growth * distance(self.spot(corner), at)
    }

    /// Where an edge is halved in the plane. All of a pole's line is one point: towards it the way is across that line.
    fn middle(&self, a: u32, b: u32) -> Point {
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

    fn unscaled(&self, at: Point) -> Point {
        [at[0] / self.scale[0], at[1] / self.scale[1]]
    }

    /// Halves the edge opposite to corner i; not where rounding would turn a triangle over.
    fn halve(
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
        let of = |all: &[[u32; 3]], t: u32, k: usize| all[t as usize][k % 3];
        let [ca, ab] = [of(&self.beside, t, i + 1), of(&self.beside, t, i + 2)];
        let [bd, dc] = [of(&self.beside, u, j + 1), of(&self.beside, u, j + 2)];
        let [fixed_ca, fixed_ab] = [of(&self.fixed, t, i + 1), of(&self.fixed, t, i + 2)];
        let [fixed_bd, fixed_dc] = [of(&self.fixed, u, j + 1), of(&self.fixed, u, j + 2)];
        let [w, x] = [0, 1].map(|k| self.triangles.len() as u32 + k);
        self.triangles[t as usize] = [vertex, a, b];
        self.beside[t as usize] = [ab, u, w];
        self.fixed[t as usize] = [fixed_ab, NONE, NONE];
        self.triangles[u as usize] = [vertex, b, d];
        self.beside[u as usize] = [bd, x, t];
        self.fixed[u as usize] = [fixed_bd, NONE, NONE];
        self.triangles.extend([[vertex, c, a], [vertex, d, c]]);
        self.beside.extend([[ca, t, x], [dc, w, u]]);
        self.fixed.extend([[fixed_ca, NONE, NONE], [fixed_dc, NONE, NONE]]);
        self.relink(ca, t, w);
        self.relink(dc, u, x);
        fresh.extend([(t, 0), (u, 0), (w, 0), (x, 0)]);
    }

    fn relink(&mut self, triangle: u32, old: u32, new: u32) {
        if triangle != NONE
            && let Some(beside) = self.beside[triangle as usize].iter_mut().find(|beside| **beside == old)
        {
            *beside = new;
        }
    }

    /// Turns diagonals until the triangles in space are Delaunay: the angles opposite to an edge are no more than half a turn together.
    fn straighten(&mut self, mut stack: Vec<(u32, usize)>) {
        let mut left = 32 * (self.triangles.len() + stack.len());
        while let Some((t, i)) = stack.pop() {
            if self.is_better_turned(t, i) {
                left -= 1;
                if left == 0 {
                    return;
                }
                let u = self.beside[t as usize][i];
                self.flip(t, i);
                stack.extend([(t, 0), (t, 2), (u, 0), (u, 1)]);
            }
        }
    }

    fn is_better_turned(&self, t: u32, i: usize) -> bool {
        let u = self.beside[t as usize][i];
        if u == NONE || self.fixed[t as usize][i] != NONE {
            return false;
        }
        let Some(j) = self.beside[u as usize].iter().position(|&x| x == t) else { return false };
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let d = self.triangles[u as usize][j];
        if self.is_one(a, d) {
            return false;
        }
        let [a2, b2, c2, d2] = [a, b, c, d].map(|c| self.plane[c as usize]);
        let [p, q, r, s] = [a, b, c, d].map(|c| self.spot(c));
        let corner = |at: Vec3, x: Vec3, y: Vec3| {
            let [x, y] = [sub(x, at), sub(y, at)];
            (norm(cross(x, y)), dot(x, y))
        };
        let ((sin_a, cos_a), (sin_d, cos_d)) = (corner(p, q, r), corner(s, r, q));
        // Flat ones in one row have angles of half a turn and none.
        let is_flat = sin_a <= 1e-9 * cos_a.abs() && cos_a < 0.0 || sin_d <= 1e-9 * cos_d.abs() && cos_d < 0.0;
        // Beside the line of a pole both are the same in space: in the plane each point is to go to what is nearest of it.
        if !is_flat && [[a, b], [a, c], [d, b], [d, c]].into_iter().any(|[x, y]| self.is_one(x, y)) {
            return in_circle(a2, b2, c2, d2) > 0.0 && turn(a2, b2, d2) > 0.0 && turn(a2, d2, c2) > 0.0;
        }
        let turned = sin_a * cos_d + cos_a * sin_d;
        let size = (sin_a.hypot(cos_a)) * (sin_d.hypot(cos_d));
        if !is_flat && (!(size > 0.0) || !(turned < -1e-9 * size)) {
            return false;
        }
        if !(turn(a2, b2, d2) > 0.0 && turn(a2, d2, c2) > 0.0) {
            return false;
        }
        // They must not come to look away from the surface.
        let [n_a, n_b, n_c, n_d] = [a, b, c, d].map(|v| self.normals[v as usize]);
        let before = look([p, q, r], [n_a, n_b, n_c]).min(look([q, s, r], [n_b, n_d, n_c]));
        look([p, q, s], [n_a, n_b, n_d]).min(look([p, s, r], [n_a, n_d, n_c])) >= before.min(UPRIGHT) - 1e-12
    }

    fn flip(&mut self, t: u32, i: usize) {
        let u = self.beside[t as usize][i];
        let j = self.beside[u as usize].iter().position(|&x| x == t).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|k| self.triangles[t as usize][(i + k) % 3]);
        let d = self.triangles[u as usize][j];
        let of = |all: &[[u32; 3]], t: u32, k: usize| all[t as usize][k % 3];
        let [ca, ab] = [of(&self.beside, t, i + 1), of(&self.beside, t, i + 2)];
        let [bd, dc] = [of(&self.beside, u, j + 1), of(&self.beside, u, j + 2)];
        let [fixed_ca, fixed_ab] = [of(&self.fixed, t, i + 1), of(&self.fixed, t, i + 2)];
        let [fixed_bd, fixed_dc] = [of(&self.fixed, u, j + 1), of(&self.fixed, u, j + 2)];
        self.triangles[t as usize] = [a, b, d];
        self.beside[t as usize] = [bd, u, ab];
        self.fixed[t as usize] = [fixed_bd, NONE, fixed_ab];
        self.triangles[u as usize] = [a, d, c];
        self.beside[u as usize] = [dc, ca, t];
        self.fixed[u as usize] = [fixed_dc, fixed_ca, NONE];
        self.relink(bd, u, t);
        self.relink(ca, t, u);
    }

    /// Triangles that look away from the surface, each with the segments on its edges.
    pub fn turned_away(&self) -> Vec<(u32, [u32; 3])> {
        let mut found = Vec::new();
        for (t, corners) in self.triangles.iter().enumerate() {
            let [p, q, r] = corners.map(|c| self.spot(c));
            let is_flat = norm(area2(p, q, r)) <= 1e-12 * distance(p, q).max(distance(q, r)).powi(2);
            let is_small = distance(p, q).max(distance(q, r)) < SMALL * self.reach;
            if !is_flat && !is_small && look([p, q, r], corners.map(|c| self.normals[c as usize])) < TURNED {
                found.push((t as u32, self.fixed[t]));
            }
        }
        found
    }
}

/// The cosine between the normal of a triangle and the mean of those of its corners; 1 where there is none to compare.
fn look([p, q, r]: [Vec3; 3], normals: [Vec3; 3]) -> f64 {
    let n = area2(p, q, r);
    let mean = add(add(normals[0], normals[1]), normals[2]);
    let size = norm(n) * norm(mean);
    let is_flat = norm(n) <= 1e-12 * distance(p, q).max(distance(q, r)).powi(2);
    if !(size > 0.0) {
        1.0
    } else if is_flat {
        0.0
    } else {
        dot(n, mean) / size
    }
}

/// Two numbers in order.
pub fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
