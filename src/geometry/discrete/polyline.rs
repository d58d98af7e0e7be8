//! The shape of a discrete edge: a chain of segments, each straight or a cubic curve, by arc length.
use super::cubic::{CubicCurve, curve_at, straight};
use super::tree::{Box3, BoxTree, box_of};
use crate::geometry::{CurveFrame, OnCurve};
use crate::mesh::vector::{Vec3, add, distance, dot, lerp, norm, scale, sub, unit};

/// Gauss' points and weights on [0, 1], of order 6: arc length.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Newton's steps on a segment, and moves from one to the next.
const STEPS: usize = 16;
const MOVES: usize = 6;

/// A chain of segments, parametrised by arc length from 0; within a segment the parameter is that of its cubic.
pub(crate) struct Polyline {
    /// Points, a closed line repeats the first at the end; shape (segments + 1, 3).
    points: Vec<Vec3>,
    /// The curves between them; none where all are straight.
    curves: Vec<CubicCurve>,
    /// Arc length at each point.
    lengths: Vec<f64>,
    /// Curvature vector C″ at each point, from the turn between its two segments: of a line of straight segments.
    bends: Vec<Vec3>,
    tree: BoxTree,
    /// Whether the line is a smooth ring: its parameter has a period.
    ring: bool,
}

impl Polyline {
    /// A polyline through at least two points; `ring` when it is closed and has no corner. Without curves it is straight between them.
    pub fn new(points: Vec<Vec3>, curves: Vec<CubicCurve>, ring: bool) -> Self {
        let segments = points.len() - 1;
        let mut lengths = vec![0.0; points.len()];
        for i in 0..segments {
            let speed = |s: f64| norm(curve_at(&curves[i], s)[1]);
            let arc = match curves.is_empty() {
                true => distance(points[i], points[i + 1]),
                false => GAUSS.iter().map(|&(s, weight)| weight * speed(s)).sum(),
            };
            lengths[i + 1] = lengths[i] + arc;
        }
        let boxes: Vec<_> = match curves.is_empty() {
            true => points.windows(2).map(|ends| box_of([ends[0], ends[1]])).collect(),
            false => curves.iter().map(|curve| box_of(*curve)).collect(),
        };
        let bends = if curves.is_empty() { bends(&points, ring) } else { Vec::new() };
        Self { tree: BoxTree::new(&boxes), points, curves, lengths, bends, ring }
    }

    /// The box about the whole.
    pub fn bounds(&self) -> Box3 {
        self.tree.bounds()
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
        if let Some(curve) = self.curves.get(i) {
            let [point, d1, d2] = curve_at(curve, s);
            let step = self.lengths[i + 1] - self.lengths[i];
            let by = if step > 0.0 { 1.0 / step } else { 0.0 };
            return CurveFrame { point, d1: scale(d1, by), d2: scale(d2, by * by) };
        }
        CurveFrame {
            point: lerp(self.points[i], self.points[i + 1], s),
            d1: unit(sub(self.points[i + 1], self.points[i])),
            d2: lerp(self.bends[i], self.bends[i + 1], s),
        }
    }

    /// Closest point; the guess only bounds the search. On curves it is looked for from the closest chord.
    pub fn closest(&self, p: Vec3, guess: Option<f64>) -> OnCurve {
        let first = guess.filter(|t| t.is_finite()).map_or(0, |t| self.locate(t).0);
        let bound = self.on_chord(first, p).1;
        let nearer = self.tree.nearest(p, bound * bound, |i| self.on_chord(i as usize, p).1.powi(2));
        let i = nearer.map_or(first, |i| i as usize);
        let (s, distance) = self.on_chord(i, p);
        if self.curves.is_empty() {
            return self.on_segment(i, s, (lerp(self.points[i], self.points[i + 1], s), distance));
        }
        self.walk(i, s, p)
    }

    /// Fraction of the chord of segment i that is closest to p, and its distance.
    fn on_chord(&self, i: usize, p: Vec3) -> (f64, f64) {
        let (a, b) = (self.points[i], self.points[i + 1]);
        let along = sub(b, a);
        let square = dot(along, along);
        let s = if square > 0.0 { (dot(sub(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        (s, distance(p, lerp(a, b, s)))
    }

    fn on_segment(&self, i: usize, s: f64, (point, distance): (Vec3, f64)) -> OnCurve {
        OnCurve { t: self.lengths[i] + s * (self.lengths[i + 1] - self.lengths[i]), point, distance }
    }

    /// The foot of p on the curves, from a place on one of them; over the end of one to the next.
    fn walk(&self, mut i: usize, mut s: f64, p: Vec3) -> OnCurve {
        let count = self.curves.len();
        let mut best: Option<OnCurve> = None;
        for _ in 0..MOVES {
            s = closest_on_curve(&self.curves[i], s, p);
            let point = curve_at(&self.curves[i], s)[0];
            let found = self.on_segment(i, s, (point, distance(p, point)));
            if best.is_some_and(|best| best.distance <= found.distance) {
                break;
            }
            best = Some(found);
            let next = match s {
                0.0 if i > 0 => (i - 1, 1.0),
                0.0 if self.ring => (count - 1, 1.0),
                1.0 if i + 1 < count => (i + 1, 0.0),
                1.0 if self.ring => (0, 0.0),
                _ => break,
            };
            (i, s) = next;
        }
        best.unwrap_or_else(|| self.on_segment(i, s, (self.points[i], distance(p, self.points[i]))))
    }
}

/// The parameter in [0, 1] at which a curve is closest to p, from one nearby: Newton's steps for (C − p)·C′ = 0, halved until the
/// distance falls.
pub(crate) fn closest_on_curve(curve: &CubicCurve, from: f64, p: Vec3) -> f64 {
    let mut s = from;
    let mut at = curve_at(curve, s);
    for _ in 0..STEPS {
        let away = sub(at[0], p);
        let (slope, square) = (dot(away, at[1]), dot(at[1], at[1]));
        let bend = square + dot(away, at[2]);
        // Where the distance is not convex, the step of Gauss and Newton goes down all the same.
        let by = if bend > 0.1 * square { bend } else { square };
        let moves = by > 0.0;
        if !moves {
            break;
        }
        let mut next = (s - slope / by).clamp(0.0, 1.0);
        let mut there = curve_at(curve, next);
        let here = dot(away, away);
        for _ in 0..4 {
            let square = dot(sub(there[0], p), sub(there[0], p));
            if square <= here * (1.0 + 1e-12) {
                break;
            }
            next = 0.5 * (s + next);
            there = curve_at(curve, next);
        }
        let step = (next - s).abs();
        (s, at) = (next, there);
        if step < 1e-13 {
            break;
        }
    }
    s
}

/// Whether a curve is its chord, at constant speed, but for rounding.
pub(crate) fn is_straight(curve: &CubicCurve) -> bool {
    let line = straight(curve[0], curve[3]);
    let chord = distance(curve[0], curve[3]);
    distance(curve[1], line[1]).max(distance(curve[2], line[2])) <= 1e-13 * chord
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
