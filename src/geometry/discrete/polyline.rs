//! The shape of a discrete edge: a polyline by arc length.
use super::tree::{BoxTree, box_of};
use crate::geometry::{CurveFrame, OnCurve};
use crate::mesh::vector::{Vec3, add, distance, dot, lerp, scale, sub, unit};

/// A chain of segments, parametrised by arc length from 0.
pub(crate) struct Polyline {
    /// Points, a closed line repeats the first at the end; shape (segments + 1, 3).
    points: Vec<Vec3>,
    /// Arc length at each point.
    lengths: Vec<f64>,
    /// Curvature vector C″ at each point, from the turn between its two segments.
    bends: Vec<Vec3>,
    tree: BoxTree,
    /// Whether the line is a smooth ring: its parameter has a period.
    ring: bool,
}

impl Polyline {
    /// A polyline through at least two points; `ring` when it is closed and has no corner.
    pub fn new(points: Vec<Vec3>, ring: bool) -> Self {
        let mut lengths = vec![0.0; points.len()];
        for i in 1..points.len() {
            lengths[i] = lengths[i - 1] + distance(points[i - 1], points[i]);
        }
        let boxes: Vec<_> = points.windows(2).map(|ends| box_of([ends[0], ends[1]])).collect();
        let bends = bends(&points, ring);
        Self { tree: BoxTree::new(&boxes), points, lengths, bends, ring }
    }

    /// Arc length of the whole.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Segment and fraction of it at a parameter, taken into the range.
    pub fn locate(&self, t: f64) -> (usize, f64) {
        let length = self.length();
        let t = if self.ring && length > 0.0 { t.rem_euclid(length) } else { t.clamp(0.0, length) };
        let last = self.points.len() - 2;
        let i = self.lengths.partition_point(|&at| at <= t).saturating_sub(1).min(last);
        let step = self.lengths[i + 1] - self.lengths[i];
        (i, if step > 0.0 { ((t - self.lengths[i]) / step).clamp(0.0, 1.0) } else { 0.0 })
    }

    /// Point and derivatives at arc length t.
    pub fn frame(&self, t: f64) -> CurveFrame {
        let (i, s) = self.locate(t);
        CurveFrame {
            point: lerp(self.points[i], self.points[i + 1], s),
            d1: unit(sub(self.points[i + 1], self.points[i])),
            d2: lerp(self.bends[i], self.bends[i + 1], s),
        }
    }

    /// Closest point, over all segments; the guess only bounds the search.
    pub fn closest(&self, p: Vec3, guess: Option<f64>) -> OnCurve {
        let first = guess.filter(|t| t.is_finite()).map_or(0, |t| self.locate(t).0);
        let bound = self.on_segment(first, p).distance;
        let nearer = self.tree.nearest(p, bound * bound, |i| self.on_segment(i as usize, p).distance.powi(2));
        self.on_segment(nearer.map_or(first, |i| i as usize), p)
    }

    fn on_segment(&self, i: usize, p: Vec3) -> OnCurve {
        let (a, b) = (self.points[i], self.points[i + 1]);
        let along = sub(b, a);
        let square = dot(along, along);
        let s = if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let point = lerp(a, b, s);
        let t = self.lengths[i] + s * (self.lengths[i + 1] - self.lengths[i]);
        OnCurve { t, point, distance: distance(p, point) }
    }
}

/// C″ at the points: the turn of the unit tangent over the mean length of the two segments. The ends of an
/// open line take that of their neighbours.
fn bends(points: &[Vec3], ring: bool) -> Vec<Vec3> {
    let n = points.len();
    let bend = |a: Vec3, b: Vec3, c: Vec3| {
        let span = 0.5 * (distance(a, b) + distance(b, c));
        let turn = sub(unit(sub(c, b)), unit(sub(b, a)));
        if span > 0.0 { scale(turn, 1.0 / span) } else { [0.0; 3] }
    };
    let mut bends = vec![[0.0; 3]; n];
    for i in 1..n - 1 {
        bends[i] = bend(points[i - 1], points[i], points[i + 1]);
    }
    if ring && n > 2 {
        bends[0] = bend(points[n - 2], points[0], points[1]);
        bends[n - 1] = bends[0];
    } else if n > 2 {
        bends[0] = bends[1];
        bends[n - 1] = bends[n - 2];
    }
    bends
}

/// The point of a triangle nearest to p, as barycentric weights.
pub(crate) fn closest_on_triangle([a, b, c]: [Vec3; 3], p: Vec3) -> [f64; 3] {
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let (bb, bc, cc) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
    let (pb, pc) = (dot(ap, ab), dot(ap, ac));
    let determinant = bb * cc - bc * bc;
    if determinant > 1e-24 * bb * cc {
        let v = (cc * pb - bc * pc) / determinant;
        let w = (bb * pc - bc * pb) / determinant;
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
            return [1.0 - v - w, v, w];
        }
    }
    // Outside, or too flat for a plane: the nearest of the three sides.
    let corners = [a, b, c];
    let mut best = ([1.0, 0.0, 0.0], f64::INFINITY);
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let along = sub(to, from);
        let square = dot(along, along);
        let s = if square > 0.0 { (dot(sub(p, from), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let away = distance(p, add(from, scale(along, s)));
        if away < best.1 {
            let mut weights = [0.0; 3];
            weights[k] = 1.0 - s;
            weights[(k + 1) % 3] = s;
            best = (weights, away);
        }
    }
    best.0
}
