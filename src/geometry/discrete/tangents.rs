//! Unit tangents along a chain of points, of high order where it is smooth, exact where it is straight.
use crate::mesh::vector::{Vec3, add, cross, distance, dot, norm, scale, sub, unit};

/// Points that a polynomial goes through.
const WINDOW: usize = 5;
/// A tangent may stand off the directions to its two neighbours by this many times the turn between them.
const SPREAD: f64 = 1.5;

/// The tangents at the points, which go on along the chain; a ring repeats its first point at the end. A vertex on a straight run of
/// three points within `flat` (model units) has the run's direction, and so have the ends of the two segments. Another has that of a
/// polynomial through five points around it by arc length, a chord c of curvature κ being c·(1 + κ²c²/24) long; or, where that leaves
/// the neighbours' directions, of the circle through three.
pub(crate) fn tangents(points: &[Vec3], ring: bool, flat: f64) -> Vec<Vec3> {
    let n = points.len();
    if n < 3 {
        return vec![unit(sub(points[n - 1], points[0])); n];
    }
    let chain = Chain { points, ring };
    let straight = straight_segments(&chain, flat);
    let lengths: Vec<f64> = (0..n - 1).map(|i| chain.length(i)).collect();
    let mut found: Vec<Vec3> = (0..n).map(|i| chain.tangent(i, &straight, &lengths)).collect();
    if ring {
        found[n - 1] = found[0];
    }
    found
}

struct Chain<'a> {
    points: &'a [Vec3],
    ring: bool,
}

/// Per segment whether it is one of two that go on straight.
fn straight_segments(chain: &Chain, flat: f64) -> Vec<bool> {
    let count = chain.points.len() - 1;
    let mut straight = vec![false; count];
    for i in 0..count {
        let next = if i + 1 < count { i + 1 } else { 0 };
        if next == 0 && !chain.ring {
            continue;
        }
        let (a, b, c) = (chain.points[i], chain.points[i + 1], chain.points[next + 1]);
        let (first, second) = (sub(b, a), sub(c, b));
        let off = norm(cross(first, second)) / distance(a, c);
        if dot(first, second) > 0.0 && off <= flat {
            (straight[i], straight[next]) = (true, true);
        }
    }
    straight
}

impl Chain<'_> {
    /// Point i, which may be before the first or after the last on a ring.
    fn at(&self, i: isize) -> Option<Vec3> {
        let count = self.points.len() as isize - 1;
        if self.ring {
            return Some(self.points[i.rem_euclid(count) as usize]);
        }
        (0..=count).contains(&i).then(|| self.points[i as usize])
    }

    /// Curvature vector of the circle through points i − 1, i, i + 1; none at an end.
    fn bend(&self, i: isize) -> Option<Vec3> {
        let [a, b, c] = [self.at(i - 1)?, self.at(i)?, self.at(i + 1)?];
        let (first, second) = (sub(b, a), sub(c, b));
        let around = cross(first, second);
        let product = norm(first) * norm(second) * distance(a, c);
        (product > 0.0).then(|| scale(around, 2.0 / product))
    }

    /// Arc length of segment i.
    fn length(&self, i: usize) -> f64 {
        let chord = distance(self.points[i], self.points[i + 1]);
        let ends = [self.bend(i as isize), self.bend(i as isize + 1)];
        let (sum, count) = ends.into_iter().flatten().fold(([0.0; 3], 0.0), |(sum, n), bend| (add(sum, bend), n + 1.0));
        let curvature = if count > 0.0 { norm(sum) / count } else { 0.0 };
        chord * (1.0 + (curvature * chord).powi(2).min(1.0) / 24.0)
    }

    fn tangent(&self, i: usize, straight: &[bool], lengths: &[f64]) -> Vec3 {
        let count = lengths.len();
        let before = if i > 0 { Some(i - 1) } else { self.ring.then_some(count - 1) };
        let after = if i < count { Some(i) } else { self.ring.then_some(0) };
        let direction = |segment: usize| unit(sub(self.points[segment + 1], self.points[segment]));
        let runs = [before, after].into_iter().flatten().filter(|&segment| straight[segment]);
        let run = runs.fold([0.0; 3], |sum, segment| add(sum, direction(segment)));
        if run != [0.0; 3] {
            return unit(run);
        }
        // Where the tangent must lie: between the directions at this point, or at an end about the first one.
        let middle = (i as isize).clamp(isize::from(!self.ring), count as isize - isize::from(!self.ring));
        let circle = self.circle_tangent(i as isize, middle);
        let Some(smooth) = self.polynomial_tangent(i, straight, lengths) else { return circle };
        let turn = self.turn(middle);
        let off = |segment: usize| angle(direction(segment), smooth);
        let most = [before, after].into_iter().flatten().map(off).fold(0.0, f64::max);
        if most <= SPREAD * turn { smooth } else { circle }
    }

    /// Angle between the segments at an inner point.
    fn turn(&self, i: isize) -> f64 {
        match (self.at(i - 1), self.at(i), self.at(i + 1)) {
            (Some(a), Some(b), Some(c)) => angle(unit(sub(b, a)), unit(sub(c, b))),
            _ => 0.0,
        }
    }

    /// Tangent at point i, a neighbour of `middle` or that itself, of the circle through `middle` and its neighbours.
    fn circle_tangent(&self, i: isize, middle: isize) -> Vec3 {
        let (Some(a), Some(b), Some(c)) = (self.at(middle - 1), self.at(middle), self.at(middle + 1)) else {
            return [0.0; 3];
        };
        let (d, e) = (distance(a, b), distance(b, c));
        if !(d > 0.0 && e > 0.0) {
            return unit(sub(c, a));
        }
        // The directions weighted crosswise: exact on a circle and on a parabola's middle.
        let there = unit(add(scale(sub(b, a), e / d), scale(sub(c, b), d / e)));
        // At an end the circle's tangent is the chord's mirror image of that in the middle.
        let mirrored = |chord: Vec3| unit(sub(scale(chord, 2.0 * dot(chord, there)), there));
        match i - middle {
            0 => there,
            -1 => mirrored(unit(sub(b, a))),
            _ => mirrored(unit(sub(c, b))),
        }
    }

    /// Tangent of the polynomial through the window about point i.
    fn polynomial_tangent(&self, i: usize, straight: &[bool], lengths: &[f64]) -> Option<Vec3> {
        let count = lengths.len();
        // How far it goes on to either side without an end or a straight segment.
        let mut reach = [0usize; 2];
        for (side, reach) in reach.iter_mut().enumerate() {
            while *reach < WINDOW - 1 {
                let segment = if side == 0 { i as isize - 1 - *reach as isize } else { i as isize + *reach as isize };
                let segment = if self.ring { segment.rem_euclid(count as isize) } else { segment };
                if !(0..count as isize).contains(&segment) || straight[segment as usize] {
                    break;
                }
                *reach += 1;
            }
        }
        let size = WINDOW.min(reach[0] + reach[1] + 1).min(if self.ring { count } else { count + 1 });
        if size < 3 {
            return None;
        }
        let least = i as isize - reach[0] as isize;
        let first = (i as isize - (size / 2) as isize).clamp(least, i as isize + reach[1] as isize + 1 - size as isize);
        let (mut at, mut s) = ([[0.0; 3]; WINDOW], [0.0; WINDOW]);
        for k in 0..size {
            at[k] = self.at(first + k as isize)?;
            if k > 0 {
                s[k] = s[k - 1] + lengths[(first + k as isize - 1).rem_euclid(count as isize) as usize];
            }
        }
        let here = (i as isize - first) as usize;
        // Derivative of Lagrange's polynomials at node `here`.
        let mut sum = [0.0; 3];
        for k in (0..size).filter(|&k| k != here) {
            let others = || (0..size).filter(move |&j| j != k && j != here);
            let weight = others().fold(1.0 / (s[k] - s[here]), |w, j| w * (s[here] - s[j]) / (s[k] - s[j]));
            sum = add(sum, scale(sub(at[k], at[here]), weight));
        }
        let tangent = unit(sum);
        (tangent != [0.0; 3] && tangent.iter().all(|x| x.is_finite())).then_some(tangent)
    }
}

fn angle(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_circle(angle: f64) -> Vec3 {
        [angle.cos(), angle.sin(), 2.0]
    }

    #[test]
    fn a_circle_has_its_tangents_however_uneven_the_points() {
        let uneven = |k: usize| 0.3 * k as f64 + 0.1 * (k as f64 * 2.3).sin();
        let angles: Vec<f64> = (0..14).map(uneven).collect();
        let points: Vec<Vec3> = angles.iter().map(|&a| on_circle(a)).collect();
        for (i, (t, a)) in tangents(&points, false, 1e-12).iter().zip(&angles).enumerate() {
            let off = distance(*t, [-a.sin(), a.cos(), 0.0]);
            assert!(off < if (2..12).contains(&i) { 2e-4 } else { 2e-3 }, "{i}: {off}");
            assert!(t[2].abs() < 1e-14, "a plane curve keeps to its plane");
        }
        let ring: Vec<Vec3> = (0..=12).map(|k| on_circle(std::f64::consts::TAU * f64::from(k % 12) / 12.0)).collect();
        for (t, p) in tangents(&ring, true, 1e-12).iter().zip(&ring) {
            assert!(distance(*t, [-p[1], p[0], 0.0]) < 1e-12);
        }
    }

    #[test]
    fn straight_runs_stay_straight_beside_arcs() {
        // Two segments along x, then a quarter of a circle.
        let mut points = vec![[-2.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
        let arc = |k: u32| 0.2 * f64::from(k);
        points.extend((0..8).map(|k| [arc(k).sin(), 1.0 - arc(k).cos(), 0.0]));
        let found = tangents(&points, false, 1e-10);
        for t in &found[..3] {
            assert!(distance(*t, [1.0, 0.0, 0.0]) < 1e-15);
        }
        for (k, t) in (0..8).zip(&found[2..]) {
            assert!(distance(*t, [arc(k).cos(), arc(k).sin(), 0.0]) < 1e-3, "{k}");
        }
    }

    #[test]
    fn two_points_or_equal_ones_give_a_direction_or_none() {
        assert_eq!(tangents(&[[0.0; 3], [2.0, 0.0, 0.0]], false, 0.0), [[1.0, 0.0, 0.0]; 2]);
        for t in tangents(&[[1.0; 3]; 4], false, 0.0) {
            assert!(t.iter().all(|x| x.is_finite()));
        }
        let corner = tangents(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], false, 0.0);
        assert!(distance(corner[1], unit([1.0, 1.0, 0.0])) < 1e-15 && distance(corner[0], [0.0, -0.0, 0.0]) > 0.9);
    }
}
