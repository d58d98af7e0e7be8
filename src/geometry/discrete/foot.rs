//! The foot of a point on cubic patches: Newton's steps that walk from triangle to triangle.
use super::cubic::{CubicTriangle, TrianglePoint, curve_at};
use super::polyline::closest_on_curve;
use crate::mesh::vector::{Vec3, cross, dot, sub};

/// Newton's steps, those over sides included.
const STEPS: usize = 24;
/// A step this short ends the search.
const SHORT: f64 = 1e-13;
/// Where there is no triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// A place on patches: triangle, barycentric weights, the point, and its distance from what was asked for, squared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub triangle: usize,
    pub weights: [f64; 3],
    pub point: Vec3,
    pub square: f64,
}

/// The closest point to p on patches near a place on one of them, found by Newton's steps for (S − p)·S_v = (S − p)·S_w = 0. What leaves
/// a triangle goes on in the neighbour (`beyond` tells 3·triangle + side across 3·triangle + side), at the surface's border along it.
/// The best of all places that it came by.
pub(crate) fn foot(
    p: Vec3,
    triangle: usize,
    weights: [f64; 3],
    net: impl Fn(usize) -> CubicTriangle,
    beyond: impl Fn(usize) -> u32,
) -> Foot {
    let mut walk = Walk { p, triangle, weights, net: net(triangle), best: None, came_by: NONE };
    for _ in 0..STEPS {
        let at = walk.net.at(walk.weights);
        if !walk.note(at.point) {
            break;
        }
        let step = newton(&at, p);
        if step[0].abs().max(step[1].abs()) < SHORT {
            break;
        }
        let Some(side) = walk.advance(step) else { continue };
        let across = beyond(3 * walk.triangle + side);
        if across != NONE && across != walk.came_by {
            walk.came_by = (3 * walk.triangle + side) as u32;
            walk.cross(side, across as usize);
            walk.net = net(walk.triangle);
        } else if !walk.slide(side) {
            break;
        }
    }
    walk.best.unwrap_or(Foot { triangle, weights, point: walk.net.corners[0], square: f64::INFINITY })
}

struct Walk {
    p: Vec3,
    triangle: usize,
    weights: [f64; 3],
    net: CubicTriangle,
    best: Option<Foot>,
    /// The side last gone over, as seen from the triangle left.
    came_by: u32,
}

/// The step of v and w towards the foot: Newton's, or where the distance is not convex that of Gauss and Newton.
fn newton(at: &TrianglePoint, p: Vec3) -> [f64; 2] {
    let away = sub(at.point, p);
    let [sv, sw] = at.first;
    let g = [dot(away, sv), dot(away, sw)];
    let metric = [dot(sv, sv), dot(sv, sw), dot(sw, sw)];
    let bend = at.second.map(|s| dot(away, s));
    let solve = |h: [f64; 3]| {
        let det = h[0] * h[2] - h[1] * h[1];
        (det, [-(h[2] * g[0] - h[1] * g[1]) / det, -(h[0] * g[1] - h[1] * g[0]) / det])
    };
    let area = metric[0] * metric[2] - metric[1] * metric[1];
    let full = [0, 1, 2].map(|i| metric[i] + bend[i]);
    let (det, step) = solve(full);
    if full[0] > 0.0 && det > 0.05 * area {
        return step;
    }
    let step = solve(metric).1;
    if area > 0.0 && step.iter().all(|x| x.is_finite()) { step } else { [0.0; 2] }
}

impl Walk {
    /// Notes a place. Returns whether the search is not lost: a step may be up and down once, no more.
    fn note(&mut self, point: Vec3) -> bool {
        let away = sub(point, self.p);
        let square = dot(away, away);
        if self.best.is_none_or(|best| square < best.square) {
            self.best = Some(Foot { triangle: self.triangle, weights: self.weights, point, square });
        }
        square.is_finite()
    }

    /// Goes by the step, at most to the border of the triangle: then tells the side.
    fn advance(&mut self, [dv, dw]: [f64; 2]) -> Option<usize> {
        let step = [-dv - dw, dv, dw];
        // Side k lies across from corner k + 2.
        let (mut share, mut side) = (1.0, None);
        for k in 0..3 {
            let corner = (k + 2) % 3;
            if step[corner] < 0.0 && self.weights[corner] + step[corner] < 0.0 {
                let to_side = -self.weights[corner] / step[corner];
                if to_side < share {
                    (share, side) = (to_side, Some(k));
                }
            }
        }
        for i in 0..3 {
            self.weights[i] = (self.weights[i] + share * step[i]).max(0.0);
        }
        if let Some(k) = side {
            self.weights[(k + 2) % 3] = 0.0;
        }
        let sum: f64 = self.weights.iter().sum();
        self.weights = self.weights.map(|w| w / sum);
        side
    }

    /// Goes over a side into the triangle beyond: 3·triangle + side there.
    fn cross(&mut self, side: usize, across: usize) {
        let (triangle, other) = (across / 3, across % 3);
        let mut weights = [0.0; 3];
        weights[other] = self.weights[(side + 1) % 3];
        weights[(other + 1) % 3] = self.weights[side];
        (self.triangle, self.weights) = (triangle, weights);
    }

    /// Goes to the closest point of a side. Returns whether from there the distance falls into the triangle.
    fn slide(&mut self, side: usize) -> bool {
        let curve = self.net.side(side);
        let s = closest_on_curve(&curve, self.weights[(side + 1) % 3], self.p);
        self.weights = [0.0; 3];
        self.weights[side] = 1.0 - s;
        self.weights[(side + 1) % 3] = s;
        self.note(curve_at(&curve, s)[0]);
        // Inward, perpendicular to the side within the patch.
        let at = self.net.at(self.weights);
        let away = sub(at.point, self.p);
        let [sv, sw] = at.first;
        let normal = cross(sv, sw);
        let along = [sv, sub(sw, sv), [-sw[0], -sw[1], -sw[2]]][side];
        let inward = cross(normal, along);
        self.came_by = NONE;
        dot(away, inward) < -SHORT * dot(away, away).sqrt() * dot(inward, inward).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::cubic::{arc, straight};
    use super::*;
    use crate::mesh::vector::{distance, norm, scale, unit};

    fn octant() -> CubicTriangle {
        let at = |k: usize| unit([[1.0, 0.2, 0.2], [0.2, 1.0, 0.2], [0.2, 0.2, 1.0]][k]);
        let side = |k: usize| {
            let (a, b) = (at(k), at((k + 1) % 3));
            let chord = sub(b, a);
            arc(a, b, [a, b].map(|n| unit(sub(chord, scale(n, dot(chord, n))))))
        };
        CubicTriangle::within(&[side(0), side(1), side(2)])
    }

    #[test]
    fn the_foot_is_where_the_distance_is_perpendicular() {
        let net = octant();
        for p in [[0.7, 0.6, 0.5], [0.3, 0.4, 0.35], [1.5, 1.0, 1.2]] {
            let found = foot(p, 0, [0.2, 0.3, 0.5], |_| net, |_| NONE);
            let at = net.at(found.weights);
            let away = sub(found.point, p);
            assert!(at.first.iter().all(|&d| dot(away, d).abs() < 1e-12 * norm(away).max(1e-3)), "{p:?} {found:?}");
        }
    }

    #[test]
    fn beyond_the_border_it_is_on_a_side_or_a_corner() {
        let net = octant();
        for (p, corner) in [([3.0, -1.0, -1.0], true), ([1.0, 1.0, -0.5], false)] {
            let found = foot(p, 0, [1.0 / 3.0; 3], |_| net, |_| NONE);
            let mut least = f64::INFINITY;
            for i in 0..=200 {
                for j in 0..=200 - i {
                    let (v, w) = (f64::from(i) / 200.0, f64::from(j) / 200.0);
                    least = least.min(distance(net.at([1.0 - v - w, v, w]).point, p));
                }
            }
            assert!(found.square.sqrt() <= least + 1e-9, "{found:?} {least}");
            assert_eq!(found.weights.contains(&1.0), corner, "{found:?}");
        }
    }

    #[test]
    fn over_a_side_it_goes_on_in_the_neighbour() {
        let flat =
            |p: [Vec3; 3]| CubicTriangle::within(&[straight(p[0], p[1]), straight(p[1], p[2]), straight(p[2], p[0])]);
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        // The second is d c b: its side 1 is c b, the first one's side 1 is b c.
        let nets = [flat([a, b, c]), flat([d, c, b])];
        let beyond = |side: usize| if side % 3 == 1 { (3 * (1 - side / 3) + 1) as u32 } else { NONE };
        let found = foot([0.8, 0.9, 0.4], 0, [0.8, 0.1, 0.1], |t| nets[t], beyond);
        assert!(found.triangle == 1 && distance(found.point, [0.8, 0.9, 0.0]) < 1e-14, "{found:?}");
        let degenerate = flat([a, a, a]);
        let found = foot([1.0; 3], 0, [1.0, 0.0, 0.0], |_| degenerate, |_| NONE);
        assert_eq!(found.point, a);
    }
}
