//! Whether two triangles of a boundary pass through each other: exact.
//!
//! Bodies may touch, in any way: those of a mesh that was split at an edge or a vertex ([`super::split_nonmanifold`]) do, and so do parts in
//! contact. It is no crossing either where rounding brings a corner through what it touches. So before two triangles are compared, both
//! draw back into their bodies by a very small distance.
use super::locate::nearest_on_triangle;
use super::predicate::orientation;
use super::vector::{Vec3, add, area2, cross, dot, lerp, norm, scale, sub, unit};
use robust::Coord;

/// A triangle, by its corners.
pub type Corners = [Vec3; 3];

/// What a triangle draws back by, in parts of its size.
pub const DRAWN_BACK: f64 = 1e-9;

/// The same in parts of its distance from the origin, which is rounded.
const ROUNDING: f64 = 4e-15;

/// A point where two triangles that look outward, of these nodes, pass through each other; none where they only touch. Those that share an
/// edge do where they are folded onto each other.
pub fn crossing<I: PartialEq>((nodes_a, a): (&[I; 3], &Corners), (nodes_b, b): (&[I; 3], &Corners)) -> Option<Vec3> {
    if are_apart(a, b) {
        return None;
    }
    let [of_a, of_b] =
        [[nodes_a, nodes_b], [nodes_b, nodes_a]].map(|[of, others]| [0, 1, 2].map(|k| others.contains(&of[k])));
    if of_a.iter().filter(|shared| **shared).count() > 1 {
        return meeting(a, b);
    }
    // What does not meet does not cross, be the body between the two thinner than they draw back.
    meeting(a, b)?;
    // Both by the same, so that two in one plane which look the same way stay in one.
    let step = drawing_back(a).max(drawing_back(b));
    meeting(&drawn_back(a, of_a, step), &drawn_back(b, of_b, step))
}

/// How far a triangle has to draw back at least.
fn drawing_back(a: &Corners) -> f64 {
    let size = norm(sub(a[1], a[0])).max(norm(sub(a[2], a[0])));
    let from = a.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    (DRAWN_BACK * size).max(ROUNDING * from)
}

/// A triangle drawn back against its normal, all but the corners that stay.
fn drawn_back(a: &Corners, stays: [bool; 3], step: f64) -> Corners {
    let step = scale(unit(area2(a[0], a[1], a[2])), -step);
    [0, 1, 2].map(|k| if stays[k] { a[k] } else { add(a[k], step) })
}

/// A point where two triangles that look outward meet, or touch, beside the corners and edges that they share, by their coordinates; none where they do not. Equal
/// triangles that face each other touch and do not meet; equal ones that look the same way do. Degenerate triangles meet nothing.
pub fn meeting(a: &Corners, b: &Corners) -> Option<Vec3> {
    if has_twice(a) || has_twice(b) || are_apart(a, b) {
        return None;
    }
    common_beside_shared(a, b).filter(|_| Plane::of(a).is_some() && Plane::of(b).is_some())
}

/// See [`meeting`]; also of flat triangles.
fn common_beside_shared(a: &Corners, b: &Corners) -> Option<Vec3> {
    // Of each corner of a the equal one of b.
    let equal = a.map(|p| b.iter().position(|q| *q == p));
    match equal {
        [Some(i), Some(j), Some(_)] => (j == (i + 1) % 3).then(|| middle(a)),
        [Some(i), Some(j), None] => folded(a, 2, b, 3 - i - j),
        [Some(i), None, Some(j)] => folded(a, 1, b, 3 - i - j),
        [None, Some(i), Some(j)] => folded(a, 0, b, 3 - i - j),
        [Some(j), None, None] => at_corner(a, 0, b, j),
        [None, Some(j), None] => at_corner(a, 1, b, j),
        [None, None, Some(j)] => at_corner(a, 2, b, j),
        [None, None, None] => edges_through(a, b, 0b111).or_else(|| edges_through(b, a, 0b111)),
    }
}

fn has_twice([p, q, r]: &Corners) -> bool {
    p == q || q == r || r == p
}

fn middle(a: &Corners) -> Vec3 {
    scale(add(add(a[0], a[1]), a[2]), 1.0 / 3.0)
}

/// A quick test: whether a guessed plane separates two triangles, up to the corner that they share. When in doubt it says no.
fn are_apart(a: &Corners, b: &Corners) -> bool {
    let shared = a.iter().find(|p| b.contains(p));
    let (from, direction) = match shared {
        // The bisector of the directions in which they leave the shared corner.
        Some(&at) => {
            let away = |of: &Corners| {
                let [u, v] = [0, 1].map(|k| sub(of.iter().filter(|p| **p != at).nth(k).copied().unwrap_or(at), at));
                let sum = add(scale(u, 1.0 / norm(u)), scale(v, 1.0 / norm(v)));
                scale(sum, 1.0 / norm(sum))
            };
            (at, sub(away(a), away(b)))
        }
        None => {
            let (from, to) = (middle(b), middle(a));
            (lerp(from, to, 0.5), sub(to, from))
        }
    };
    // Far above the rounding of a product of differences.
    let side = |p: Vec3| {
        let d = sub(p, from);
        (dot(d, direction), 1e-12 * norm(d) * norm(direction))
    };
    let is_on = |of: &Corners, sign: f64| {
        of.iter().filter(|p| Some(*p) != shared).all(|p| {
            let (side, doubt) = side(*p);
            sign * side > doubt
        })
    };
    // Without a shared corner `from` is rounded too: by so little of the coordinates.
    let is_exact = shared.is_some();
    let is_between = is_on(a, 1.0) && is_on(b, -1.0) && (is_exact || is_clear(a, b, from, direction));
    is_between || (shared.is_none() && (is_beyond_an_edge(a, b) || is_beyond_an_edge(b, a)))
}

/// Whether b lies beyond the plane through one of a's edges that stands upright on a, far above rounding: for two that are apart in one
/// plane there is such an edge of one of them.
fn is_beyond_an_edge(a: &Corners, b: &Corners) -> bool {
    let normal = area2(a[0], a[1], a[2]);
    (0..3).any(|k| {
        let outward = cross(sub(a[(k + 1) % 3], a[k]), normal);
        // How far a point is out, and the bound of its rounding.
        let out = |p: &Vec3| {
            let d = sub(*p, a[k]);
            (dot(d, outward), 1e-12 * norm(d) * norm(outward))
        };
        let of_a = a.iter().map(out).fold(0.0_f64, |most, (out, doubt)| most.max(out + doubt));
        b.iter().map(out).all(|(out, doubt)| out - doubt > of_a)
    })
}

/// Whether the distances from the plane are far above the rounding of the coordinates.
fn is_clear(a: &Corners, b: &Corners, from: Vec3, direction: Vec3) -> bool {
    let size = from.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let doubt = 1e-12 * size * norm(direction);
    a.iter().chain(b).all(|p| dot(sub(*p, from), direction).abs() > doubt)
}

/// Triangles that share an edge, by the corners that are not on it: they meet where they are folded onto each other.
fn folded(a: &Corners, i: usize, b: &Corners, j: usize) -> Option<Vec3> {
    let ([p, q, r], s) = ([a[(i + 1) % 3], a[(i + 2) % 3], a[i]], b[j]);
    // Most lie on two sides of their edge, far above the rounding: most surfaces are smooth.
    let along = unit(sub(q, p));
    let [u, v] = [sub(r, p), sub(s, p)];
    let across = |u: Vec3| sub(u, scale(along, dot(u, along)));
    if dot(across(u), across(v)) < -1e-12 * norm(u) * norm(v) || orientation(p, q, r, s) != 0.0 {
        return None;
    }
    let plane = Plane::of(&[p, q, r])?;
    let [to_r, to_s] = [plane.turn(p, q, r), plane.turn(p, q, s)];
    let is_folded = (to_r > 0.0 && to_s > 0.0) || (to_r < 0.0 && to_s < 0.0);
    is_folded.then(|| lerp(lerp(p, q, 0.5), lerp(r, s, 0.5), 0.5))
}

/// Triangles that share corner i of a, j of b: what they have in common beside it reaches to one's opposite edge.
fn at_corner(a: &Corners, i: usize, b: &Corners, j: usize) -> Option<Vec3> {
    edges_through(a, b, 1 << i).or_else(|| edges_through(b, a, 1 << j))
}

/// A point where one of the edges of `a` in the mask (by the corner opposite) meets `b`.
fn edges_through(a: &Corners, b: &Corners, mask: u8) -> Option<Vec3> {
    let plane = Plane::of(b)?;
    let sides = a.map(|p| orientation(b[0], b[1], b[2], p));
    (0..3).filter(|i| mask >> i & 1 == 1).find_map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        segment_through([a[j], a[k]], [sides[j], sides[k]], b, plane)
    })
}

/// A point where a segment meets a triangle, boundary included; `sides` are its ends' sides of the triangle's plane.
fn segment_through([p, q]: [Vec3; 2], [at_p, at_q]: [f64; 2], b: &Corners, plane: Plane) -> Option<Vec3> {
    if (at_p > 0.0 && at_q > 0.0) || (at_p < 0.0 && at_q < 0.0) {
        return None;
    }
    if at_p == 0.0 && at_q == 0.0 {
        return plane.common([p, q], b);
    }
    let turns = [0, 1, 2].map(|k| orientation(p, q, b[k], b[(k + 1) % 3]));
    let is_through = turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0);
    is_through.then(|| lerp(p, q, at_p / (at_p - at_q)))
}

/// The shortest way from a triangle to another; zero where they meet.
pub fn way(a: &Corners, b: &Corners) -> Vec3 {
    let plane_meets = |a: &Corners, b: &Corners| Plane::of(b).is_some() && edges_through(a, b, 0b111).is_some();
    if plane_meets(a, b) || plane_meets(b, a) {
        return [0.0; 3];
    }
    let to_triangle = |p: Vec3, t: &Corners| {
        let weights = nearest_on_triangle(p, *t);
        sub((0..3).fold([0.0; 3], |sum, k| add(sum, scale(t[k], weights[k]))), p)
    };
    let edge = |t: &Corners, k: usize| [t[k], t[(k + 1) % 3]];
    let from_corners = (0..3).flat_map(|k| [to_triangle(a[k], b), scale(to_triangle(b[k], a), -1.0)]);
    let between_edges = (0..9).filter_map(|k| way_between(edge(a, k / 3), edge(b, k % 3)));
    let all = from_corners.chain(between_edges);
    all.reduce(|best, way| if norm(way) < norm(best) { way } else { best }).unwrap_or_default()
}

/// The shortest way from a segment to another, where it is not at an end of one.
fn way_between([p, q]: [Vec3; 2], [r, s]: [Vec3; 2]) -> Option<Vec3> {
    let (u, v, w) = (sub(q, p), sub(s, r), sub(p, r));
    let (uu, uv, vv, uw, vw) = (dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w));
    let determinant = uu * vv - uv * uv;
    let (x, y) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
    let is_within = |x: f64| (0.0..=1.0).contains(&x);
    // No number of parallel ones, which are nearest at an end of one too.
    (is_within(x) && is_within(y)).then(|| sub(lerp(r, s, y), lerp(p, q, x)))
}

/// Two of the three coordinates: the plane that a triangle is looked at in.
#[derive(Clone, Copy)]
struct Plane([usize; 2]);

impl Plane {
    /// A coordinate plane in which the triangle's shadow has an area; none for a degenerate triangle.
    fn of(b: &Corners) -> Option<Self> {
        let [u, v] = [sub(b[1], b[0]), sub(b[2], b[0])];
        let area = |[i, j]: [usize; 2]| (u[i] * v[j] - u[j] * v[i]).abs();
        let mut axes = [[0, 1], [1, 2], [2, 0]];
        // The largest shadow first.
        axes.sort_by(|x, y| area(*y).total_cmp(&area(*x)));
        axes.into_iter().map(Plane).find(|plane| plane.turn(b[0], b[1], b[2]) != 0.0)
    }

    /// Twice the area of the shadow of a triangle; the sign is exact.
    fn turn(self, p: Vec3, q: Vec3, r: Vec3) -> f64 {
        let Self([i, j]) = self;
        let [p, q, r] = [p, q, r].map(|p| Coord { x: p[i], y: p[j] });
        robust::orient2d(p, q, r)
    }

    /// A point of a segment in a triangle's plane that is in the triangle, boundary included.
    fn common(self, [p, q]: [Vec3; 2], b: &Corners) -> Option<Vec3> {
        let is_in = |p: Vec3| {
            let turns = [0, 1, 2].map(|k| self.turn(b[k], b[(k + 1) % 3], p));
            turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0)
        };
        if let Some(inside) = [p, q].into_iter().find(|p| is_in(*p)) {
            return Some(inside);
        }
        // With both ends outside it passes through two of the edges, or through a corner and so through the edges there.
        (0..3).find_map(|k| {
            let (c, d) = (b[k], b[(k + 1) % 3]);
            let [at_p, at_q] = [self.turn(c, d, p), self.turn(c, d, q)];
            let [at_c, at_d] = [self.turn(p, q, c), self.turn(p, q, d)];
            let parts = |x: f64, y: f64| (x >= 0.0 && y <= 0.0) || (x <= 0.0 && y >= 0.0);
            let is_met = parts(at_p, at_q) && parts(at_c, at_d) && at_p != at_q;
            is_met.then(|| lerp(p, q, at_p / (at_p - at_q)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: Corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    /// Whether they meet, which does not depend on the order of the two, nor on the corner that comes first.
    fn meet(a: Corners, b: Corners) -> bool {
        let found = meeting(&a, &b).is_some();
        for k in 0..9 {
            let turned = |a: &Corners, k: usize| [a[k % 3], a[(k + 1) % 3], a[(k + 2) % 3]];
            let (a, b) = (turned(&a, k / 3), turned(&b, k));
            assert_eq!(meeting(&a, &b).is_some(), found, "{a:?} {b:?}");
            assert_eq!(meeting(&b, &a).is_some(), found, "{b:?} {a:?}");
        }
        found
    }

    #[test]
    fn triangles_without_a_common_corner() {
        let upright = |x: f64, low: f64| [[x, 1.0, low], [x, 1.0, 3.0], [x, 2.0, 3.0]];
        assert!(meet(FLAT, upright(1.0, -1.0)));
        assert!(!meet(FLAT, upright(1.0, 0.1)));
        assert!(!meet(FLAT, upright(3.5, -1.0)));
        // A corner that just touches the inside, an edge, or is off by one unit in the last place.
        assert!(meet(FLAT, upright(1.0, 0.0)));
        assert!(meet(FLAT, upright(3.0, 0.0)));
        assert!(!meet(FLAT, upright(1.0, f64::MIN_POSITIVE)));
        assert!(!meet(FLAT, upright(3.0 + 4.0 * f64::EPSILON, -1.0)));
        // An edge through an edge.
        assert!(meet(FLAT, [[2.0, -1.0, -1.0], [2.0, 1.0, 1.0], [2.0, -1.0, 1.0]]));
        assert!(!meet(FLAT, [[2.0, -1.1, -1.0], [2.0, 1.0, 1.0], [2.0, -1.0, 1.0]]));
    }

    #[test]
    fn triangles_in_one_plane() {
        let at = |x: f64, y: f64| [[x, y, 0.0], [x + 1.0, y, 0.0], [x, y + 1.0, 0.0]];
        // Inside, across an edge, a star of two, beside.
        assert!(meet(FLAT, at(0.5, 0.5)));
        assert!(meet(FLAT, at(-0.5, 1.0)));
        assert!(meet(FLAT, [[3.0, 3.0, 0.0], [-1.0, 3.0, 0.0], [3.0, -1.0, 0.0]]));
        assert!(!meet(FLAT, at(2.0, 2.5)));
        // A corner on an edge, edges on each other that are not the same.
        assert!(meet(FLAT, at(2.0, 2.0)));
        assert!(meet(FLAT, [[1.0, 0.0, 0.0], [2.0, -1.0, 0.0], [2.0, 0.0, 0.0]]));
        // In a plane that floating-point numbers do not hold exactly they are as good as apart, or do meet; but never panic.
        let askew = |c: Corners| c.map(|[x, y, _]| [0.1 * x + 0.7 * y, 0.3 * x - 0.2 * y, 0.9 * x + 0.1 * y]);
        meet(askew(FLAT), askew(at(0.5, 0.5)));
    }

    #[test]
    fn triangles_with_a_common_edge() {
        let [a, b, c] = FLAT;
        for (d, expected) in [
            ([4.0, 4.0, 0.0], false),
            ([1.0, 1.0, 0.0], true),
            ([-9.0, -9.0, 0.0], true),
            ([1.0, 1.0, 1e-300], false),
            ([1.0, 1.0, -1.0], false),
        ] {
            assert_eq!(meet(FLAT, [c, b, d]), expected, "{d:?}");
        }
        assert!(meet(FLAT, [b, c, a]), "the same triangle twice");
        assert!(!meet(FLAT, [b, a, c]), "two that face each other");
    }

    #[test]
    fn triangles_with_a_common_corner() {
        let at = |p: Vec3, q: Vec3| [FLAT[0], p, q];
        // A neighbour in a fan, flat and bent; one that stands in it; one that lies in it; one that reaches through it.
        assert!(!meet(FLAT, at([-1.0, 4.0, 0.0], [-4.0, 0.0, 0.0])));
        assert!(!meet(FLAT, at([-1.0, 4.0, 1.0], [-4.0, 0.0, -1.0])));
        assert!(!meet(FLAT, at([1.0, 1.0, 1.0], [1.0, 2.0, 1.0])));
        assert!(meet(FLAT, at([1.0, 2.0, 0.0], [2.0, 1.0, 0.0])));
        assert!(meet(FLAT, at([9.0, 2.0, 0.0], [2.0, 9.0, 0.0])));
        assert!(meet(FLAT, at([-1.0, 4.0, 0.0], [1.0, 1.0, 0.0])));
        assert!(meet(FLAT, at([1.0, 1.0, 1.0], [1.0, 1.0, -1.0])));
        assert!(meet(FLAT, at([1.0, 1.0, 0.0], [1.0, 1.0, -1.0])));
        assert!(!meet(FLAT, at([-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0])));
    }

    #[test]
    fn what_touches_does_not_cross() {
        let crosses = |b: Corners| {
            let found = crossing((&[0, 1, 2], &FLAT), (&[3, 4, 5], &b)).is_some();
            assert_eq!(crossing((&[3, 4, 5], &b), (&[0, 1, 2], &FLAT)).is_some(), found);
            found
        };
        // A corner on it, and through it by rounding, by more; FLAT looks up, so its body is below.
        for (z, expected) in [(0.0, false), (-1e-13, false), (-1e-6, true), (1e-6, false)] {
            assert_eq!(crosses([[1.0, 1.0, z], [2.0, 1.0, 1.0], [1.0, 2.0, 1.0]]), expected, "{z}");
        }
        // In its plane: one that faces it, one that looks the same way.
        assert!(!crosses([[0.5, 0.5, 0.0], [0.5, 1.5, 0.0], [1.5, 0.5, 0.0]]));
        assert!(crosses([[0.5, 0.5, 0.0], [1.5, 0.5, 0.0], [0.5, 1.5, 0.0]]));
        // Edges along each other, at an edge of two bodies that touch there; with an end in common, and with a node.
        assert!(!crosses([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]]));
        assert!(!crosses([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 2.0]]));
        let beside = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
        assert_eq!(crossing((&[0, 1, 2], &FLAT), (&[0, 4, 5], &beside)), None);
        let through = [[0.0, 0.0, 0.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
        assert!(crossing((&[0, 1, 2], &FLAT), (&[0, 4, 5], &through)).is_some());
    }

    /// A bottom and a side of a layer of 1e-18, and a layer of 1e-3 at 1e12 from the origin, were said to cross.
    #[test]
    fn sides_of_a_body_thinner_than_they_draw_back_do_not_cross() {
        for (offset, height) in [(0.0, 1e-18), (1e12, 1e-3)] {
            let at = |x: f64, y: f64, z: f64| [x, y, z].map(|x| x + offset);
            let bottom = [at(0.0, 0.5, 0.0), at(0.5, 0.5, 0.0), at(0.0, 0.0, 0.0)];
            let side = [at(0.0, 0.0, height), at(0.0, 0.5, height), at(0.0, 0.0, 0.0)];
            assert_eq!(crossing((&[4, 5, 1], &bottom), (&[10, 13, 1], &side)), None, "{height}");
            let top = [at(0.0, 0.0, height), at(0.5, 0.5, height), at(0.0, 0.5, height)];
            assert_eq!(crossing((&[4, 5, 1], &bottom), (&[10, 14, 13], &top)), None, "{height}");
        }
    }

    #[test]
    fn the_shortest_way_between_triangles() {
        let lifted = |z: f64| FLAT.map(|[x, y, _]| [x, y, z]);
        assert_eq!(way(&FLAT, &lifted(2.0)), [0.0, 0.0, 2.0]);
        assert_eq!(way(&lifted(2.0), &FLAT), [0.0, 0.0, -2.0]);
        assert_eq!(way(&FLAT, &[[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), [0.0; 3]);
        // From a corner to an edge, and from an edge to another, which pass at a distance.
        assert_eq!(way(&FLAT, &[[2.0, -1.0, 0.0], [2.0, -3.0, 1.0], [2.0, -3.0, -1.0]]), [0.0, -1.0, 0.0]);
        let over = [[2.0, -1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 0.0, 5.0]];
        assert!((norm(way(&FLAT, &over)) - 1.0).abs() < 1e-12);
        let beside = [[2.0, -2.0, 1.0], [2.0, 1.0, -2.0], [2.0, -5.0, -5.0]];
        let expected = [0.0, -0.5, -0.5];
        assert!(norm(sub(way(&FLAT, &beside), expected)) < 1e-12, "{:?}", way(&FLAT, &beside));
    }

    #[test]
    fn degenerate_triangles_meet_nothing() {
        let line = [[1.0, 1.0, -1.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        assert_eq!(meeting(&line, &line), None);
        for point in [[0.0; 3], [1.0, 1.0, 0.0]] {
            assert!(!meet([point; 3], FLAT));
            assert!(!meet([point, point, [1.0, 1.0, 1.0]], FLAT));
        }
    }

    /// Held against the plain definition in small whole numbers: some edge of one meets the other beside what is shared.
    #[test]
    fn as_by_points_of_a_grid() {
        let mut seed = 1u64;
        let mut next = |n: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) % n
        };
        let mut counts = [0; 2];
        for _ in 0..5000 {
            let mut corners = || [0, 1, 2].map(|_| [0, 1, 2].map(|_| next(4) as f64));
            let (a, b) = (corners(), corners());
            counts[usize::from(meet(a, b))] += 1;
        }
        assert!(counts[0] > 500 && counts[1] > 500, "{counts:?}");
    }
}
