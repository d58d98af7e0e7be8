//! Cubic Bezier curves and triangles: points and derivatives (Farin 2002, Curves and surfaces for CAGD, chapters 5 and 17).
use crate::mesh::vector::{Vec3, add, cross, dot, lerp, norm, scale, sub, unit};

/// The four control points of a cubic curve.
pub(crate) type CubicCurve = [Vec3; 4];

/// Point and derivatives C, C′, C″ of a cubic curve at s in [0, 1].
pub(crate) fn curve_at(b: &CubicCurve, s: f64) -> [Vec3; 3] {
    let first = [lerp(b[0], b[1], s), lerp(b[1], b[2], s), lerp(b[2], b[3], s)];
    let second = [lerp(first[0], first[1], s), lerp(first[1], first[2], s)];
    let bend = sub(sub(first[2], first[1]), sub(first[1], first[0]));
    [lerp(second[0], second[1], s), scale(sub(second[1], second[0]), 3.0), scale(bend, 6.0)]
}

/// The curve that is the straight line from a to b, at constant speed.
pub(crate) fn straight(a: Vec3, b: Vec3) -> CubicCurve {
    [a, lerp(a, b, 1.0 / 3.0), lerp(b, a, 1.0 / 3.0), b]
}

/// Greatest angle between a tangent and the chord for which a curve is made: beyond that the handle's length tells nothing.
const LEAST_COSINE: f64 = 0.7;

/// The cubic curve from a to b with unit tangents there. The handles are those with which a symmetric arc of a circle comes out within
/// 2/27·sin⁶(θ/4)/cos²(θ/4) of its radius (Dokken, Dæhlen, Lyche, Mørken 1990): 2/3 · L/(1 + cos α), L the chord and α the angle of its
/// tangent to it. Straight where a tangent stands too far off the chord.
pub(crate) fn arc(a: Vec3, b: Vec3, tangents: [Vec3; 2]) -> CubicCurve {
    let chord = sub(b, a);
    let length = norm(chord);
    let cosines = tangents.map(|t| if length > 0.0 { dot(t, chord) / length } else { 0.0 });
    // A NaN is no tangent either.
    if !(cosines[0] > LEAST_COSINE && cosines[1] > LEAST_COSINE) {
        return straight(a, b);
    }
    let handle = |cosine: f64| 2.0 / 3.0 * length / (1.0 + cosine);
    [a, add(a, scale(tangents[0], handle(cosines[0]))), sub(b, scale(tangents[1], handle(cosines[1]))), b]
}

/// A cubic Bezier triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CubicTriangle {
    /// The corners b300, b030, b003.
    pub corners: [Vec3; 3],
    /// The two inner control points of side k, which runs from corner k to corner k + 1.
    pub sides: [[Vec3; 2]; 3],
    /// b111.
    pub centre: Vec3,
}

/// Point and derivatives of a triangle by v and w, the barycentric weights of its second and third corner.
pub(crate) struct TrianglePoint {
    pub point: Vec3,
    /// S_v and S_w.
    pub first: [Vec3; 2],
    /// S_vv, S_vw, S_ww.
    pub second: [Vec3; 3],
}

impl CubicTriangle {
    /// The triangle with three boundary curves; each runs from corner k to corner k + 1. Its centre is E + (E − V)/2, with E the mean
    /// of the six inner control points and V that of the corners: what makes a quadratic patch come out (Farin 1986; Vlachos, Peters,
    /// Boyd, Mitchell 2001).
    pub fn within(curves: &[CubicCurve; 3]) -> Self {
        let corners = [0, 1, 2].map(|k| curves[k][0]);
        let sides = [0, 1, 2].map(|k| [curves[k][1], curves[k][2]]);
        let edge = scale(sides.iter().flatten().fold([0.0; 3], |sum, &b| add(sum, b)), 1.0 / 6.0);
        let flat = scale(add(add(corners[0], corners[1]), corners[2]), 1.0 / 3.0);
        Self { corners, sides, centre: lerp(flat, edge, 1.5) }
    }

    /// Moves the centre along the triangle's normal so that the patch has given normals in the middles of its sides as nearly as one number
    /// allows; none for a side that has no say. Neighbours that are given the same then meet nearly without a kink.
    pub fn lean(&mut self, middles: [Option<Vec3>; 3]) {
        let [a, b, c] = self.corners;
        let across = unit(cross(sub(b, a), sub(c, a)));
        let (mut sum, mut count) = (0.0, 0.0);
        for (k, normal) in middles.iter().enumerate() {
            let Some(normal) = normal else { continue };
            let mut weights = [0.5; 3];
            weights[(k + 2) % 3] = 0.0;
            let [sv, sw] = self.at(weights).first;
            // The derivative towards the opposite corner, of which the centre has the share 6·½·½.
            let inward = [sub(sw, scale(sv, 0.5)), scale(add(sv, sw), -1.0), sub(sv, scale(sw, 0.5))][k];
            let facing = dot(across, *normal);
            if facing > 0.5 {
                sum -= dot(inward, *normal) / (1.5 * facing);
                count += 1.0;
            }
        }
        if count > 0.0 {
            self.centre = add(self.centre, scale(across, sum / count));
        }
    }

    /// The curve along side k.
    pub fn side(&self, k: usize) -> CubicCurve {
        [self.corners[k], self.sides[k][0], self.sides[k][1], self.corners[(k + 1) % 3]]
    }

    /// All control points; their box holds the triangle.
    pub fn points(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.corners.iter().chain(self.sides.iter().flatten()).copied().chain([self.centre])
    }

    /// Point and derivatives at barycentric weights, by de Casteljau's steps.
    pub fn at(&self, weights: [f64; 3]) -> TrianglePoint {
        let [a, b, c] = weights;
        let mix = |p: Vec3, q: Vec3, r: Vec3| -> Vec3 { std::array::from_fn(|i| a * p[i] + b * q[i] + c * r[i]) };
        let [b300, b030, b003] = self.corners;
        let [[b210, b120], [b021, b012], [b102, b201]] = self.sides;
        let b111 = self.centre;
        // Quadratic control points: c200, c020, c002, c110, c011, c101.
        let c200 = mix(b300, b210, b201);
        let c020 = mix(b120, b030, b021);
        let c002 = mix(b102, b012, b003);
        let c110 = mix(b210, b120, b111);
        let c011 = mix(b111, b021, b012);
        let c101 = mix(b201, b111, b102);
        let d = [mix(c200, c110, c101), mix(c110, c020, c011), mix(c101, c011, c002)];
        let twice = |p: Vec3, q: Vec3, r: Vec3, s: Vec3| scale(sub(add(p, q), add(r, s)), 6.0);
        TrianglePoint {
            point: mix(d[0], d[1], d[2]),
            first: [scale(sub(d[1], d[0]), 3.0), scale(sub(d[2], d[0]), 3.0)],
            second: [twice(c200, c020, c110, c110), twice(c200, c011, c110, c101), twice(c200, c002, c101, c101)],
        }
    }

    /// S_v × S_w at barycentric weights.
    pub fn normal(&self, weights: [f64; 3]) -> Vec3 {
        let [v, w] = self.at(weights).first;
        cross(v, w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vector::distance;

    #[test]
    fn an_arc_of_a_circle_comes_out_to_the_sixth_order() {
        let mut last = 0.0;
        for (i, angle) in [0.8f64, 0.4, 0.2].into_iter().enumerate() {
            let at = |t: f64| [t.cos(), t.sin(), 0.0];
            let curve = arc(at(0.0), at(angle), [[0.0, 1.0, 0.0], [-angle.sin(), angle.cos(), 0.0]]);
            let off =
                (0..=20).map(|k| (norm(curve_at(&curve, f64::from(k) / 20.0)[0]) - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-5 && (i == 0 || off < last / 50.0), "{angle}: {off}");
            last = off;
        }
    }

    #[test]
    fn derivatives_are_those_of_the_points() {
        let p = |k: usize| [(k * 7 % 5) as f64, (k * 3 % 7) as f64, (k * 5 % 3) as f64];
        let triangle = CubicTriangle {
            corners: [p(0), p(1), p(2)],
            sides: [[p(3), p(4)], [p(5), p(6)], [p(7), p(8)]],
            centre: p(9),
        };
        let at = |v: f64, w: f64| triangle.at([1.0 - v - w, v, w]);
        let (v, w, h) = (0.3, 0.2, 1e-5);
        let here = at(v, w);
        let slope = |a: Vec3, b: Vec3| scale(sub(a, b), 0.5 / h);
        assert!(distance(here.first[0], slope(at(v + h, w).point, at(v - h, w).point)) < 1e-8);
        assert!(distance(here.first[1], slope(at(v, w + h).point, at(v, w - h).point)) < 1e-8);
        for (k, step) in [(0, [h, 0.0]), (1, [0.0, h])] {
            let by_w = slope(at(v + step[0], w + step[1]).first[1], at(v - step[0], w - step[1]).first[1]);
            assert!(distance(here.second[k + 1], by_w) < 1e-7);
        }
        let by_v = slope(at(v + h, w).first[0], at(v - h, w).first[0]);
        assert!(distance(here.second[0], by_v) < 1e-7);
        let side = triangle.side(2);
        let [point, along, bend] = curve_at(&side, 0.25);
        assert!(distance(point, triangle.at([0.25, 0.0, 0.75]).point) < 1e-14);
        let slope =
            |order: usize| scale(sub(curve_at(&side, 0.25 + h)[order], curve_at(&side, 0.25 - h)[order]), 0.5 / h);
        assert!(distance(along, slope(0)) < 1e-8 && distance(bend, slope(1)) < 1e-7);
    }

    #[test]
    fn a_triangle_of_straight_sides_is_flat() {
        let [a, b, c] = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.5], [0.5, 1.0, 3.0]];
        let triangle = CubicTriangle::within(&[straight(a, b), straight(b, c), straight(c, a)]);
        let at = triangle.at([0.2, 0.5, 0.3]);
        let expected: Vec3 = std::array::from_fn(|i| 0.2 * a[i] + 0.5 * b[i] + 0.3 * c[i]);
        assert!(distance(at.point, expected) < 1e-15 && at.second.iter().all(|&s| norm(s) < 1e-14));
        assert!(distance(unit(triangle.normal([0.1, 0.1, 0.8])), unit(cross(sub(b, a), sub(c, a)))) < 1e-15);
    }
}
