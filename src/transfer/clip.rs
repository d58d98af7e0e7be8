//! The part of a tetrahedron that lies in another one.
//!
//! The tetrahedron is written in the barycentric coordinates λ of the other, whose four planes are λ_k = 0, and is cut by these one after
//! the other. The part inside a plane is cut into tetrahedra again. The volume of each is the volume of the one it comes from, times the
//! ratios in which the plane cuts its edges: products of numbers in [0, 1], never differences. So no volume is negative, each is as exact
//! as the ratios, and flat or coincident tetrahedra need no special care.
use crate::mesh::vector::{Vec3, cross, dot, sub};

/// A point by its barycentric coordinates.
type Lambda = [f64; 4];

/// Rounding of a barycentric coordinate, in units of the sum of its terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The planes of a tetrahedron.
pub struct Planes {
    /// ∇λ_k, shape (4, 3), in 1/length.
    pub gradients: [Vec3; 4],
    /// A point on each plane.
    on: [Vec3; 4],
}

impl Planes {
    /// Of a tetrahedron; none of a flat or inverted one.
    pub fn of(x: [Vec3; 4]) -> Option<Self> {
        let [a, b, c] = [sub(x[1], x[0]), sub(x[2], x[0]), sub(x[3], x[0])];
        let normals = [cross(b, c), cross(c, a), cross(a, b)];
        let six_volumes = dot(a, normals[0]);
        let scale = 1.0 / six_volumes;
        if !(six_volumes > 0.0 && scale.is_finite()) {
            return None;
        }
        let [g1, g2, g3] = normals.map(|normal| normal.map(|n| n * scale));
        let g0 = cross(sub(x[3], x[1]), sub(x[2], x[1])).map(|n| n * scale);
        Some(Self { gradients: [g0, g1, g2, g3], on: [x[1], x[0], x[0], x[0]] })
    }

    /// A point in barycentric coordinates. A coordinate that may be rounding alone is 0.
    #[inline(always)]
    fn point(&self, p: Vec3) -> Point {
        let mut at = [0.0; 4];
        for k in 0..4 {
            let (g, on) = (&self.gradients[k], &self.on[k]);
            let [x, y, z] = [g[0] * (p[0] - on[0]), g[1] * (p[1] - on[1]), g[2] * (p[2] - on[2])];
            let (value, size) = (x + y + z, x.abs() + y.abs() + z.abs());
            at[k] = if value.abs() <= ROUNDING * size { 0.0 } else { value };
        }
        Point::new(at)
    }

    /// The part of a tetrahedron that lies in this one.
    #[inline]
    pub fn clip(&self, x: &[Vec3; 4]) -> Piece {
        let [a, b, c, d] = [self.point(x[0]), self.point(x[1]), self.point(x[2]), self.point(x[3])];
        let mut piece = Piece::default();
        // No corner is inside some plane: the two touch at most.
        if (a.out | a.on) & (b.out | b.on) & (c.out | c.on) & (d.out | d.on) == 0 {
            cut([&a, &b, &c, &d], 1.0, &mut piece);
            piece.beyond &= a.out | b.out | c.out | d.out;
        }
        piece
    }
}

/// A point with what is often asked.
#[derive(Clone, Copy)]
struct Point {
    at: Lambda,
    /// Bit k: λ_k < 0.
    out: u8,
    /// Bit k: λ_k = 0.
    on: u8,
}

impl Point {
    #[inline(always)]
    fn new(at: Lambda) -> Self {
        let (mut out, mut on) = (0, 0);
        for k in 0..4 {
            out |= u8::from(at[k] < 0.0) << k;
            on |= u8::from(at[k] == 0.0) << k;
        }
        Self { at, out, on }
    }
}

/// The bits that at least three of four have.
#[inline(always)]
fn three(a: u8, b: u8, c: u8, d: u8) -> u8 {
    a & b & (c | d) | c & d & (a | b)
}

/// A part of a tetrahedron.
#[derive(Clone, Copy, Debug, Default)]
pub struct Piece {
    /// Its share of the volume of the tetrahedron, 0 to 1.
    pub share: f64,
    /// Four times `share` times the barycentric coordinates of its centroid in the other.
    moments: Lambda,
    /// Bit k: the tetrahedron goes on beyond face k of the other.
    pub beyond: u8,
}

impl Piece {
    /// Barycentric coordinates of the centroid in the other tetrahedron, ≥ 0, sum 1; of a piece with a share.
    pub fn centroid(&self) -> Lambda {
        let moments = self.moments.map(|moment| moment.max(0.0));
        let sum = (moments[0] + moments[1]) + (moments[2] + moments[3]);
        moments.map(|moment| moment / sum)
    }

    #[inline(always)]
    fn add(&mut self, [a, b, c, d]: [&Point; 4], share: f64) {
        self.share += share;
        for k in 0..4 {
            self.moments[k] += share * ((a.at[k] + b.at[k]) + (c.at[k] + d.at[k]));
        }
        // Three corners on a plane: a piece of that face.
        self.beyond |= three(a.on, b.on, c.on, d.on);
    }
}

/// Which corners are inside, then those outside, by the bits of those that are outside.
const ORDER: [[u8; 4]; 16] = order();

const fn order() -> [[u8; 4]; 16] {
    let mut all = [[0; 4]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut at, mut side) = (0, 0);
        while side < 2 {
            let mut i = 0;
            while i < 4 {
                if (mask >> i) & 1 == side {
                    all[mask][at] = i as u8;
                    at += 1;
                }
                i += 1;
            }
            side += 1;
        }
        mask += 1;
    }
    all
}

/// Adds the part of a tetrahedron inside all planes. The tetrahedron is `share` of the whole one.
fn cut(corners: [&Point; 4], share: f64, piece: &mut Piece) {
    let [a, b, c, d] = corners.map(|corner| corner.out);
    if a & b & c & d != 0 {
        return;
    }
    let some = a | b | c | d;
    if some == 0 {
        return piece.add(corners, share);
    }
    // The plane that leaves least comes first: that makes fewer parts.
    let most = three(a, b, c, d);
    let two = (a & b) | (c & d) | (a | b) & (c | d);
    let first = if most != 0 {
        most
    } else if two != 0 {
        two
    } else {
        some
    };
    let k = first.trailing_zeros() as usize & 3;
    let bit = |out: u8| out >> k & 1;
    let outside = bit(a) | bit(b) << 1 | bit(c) << 2 | bit(d) << 3;
    let [a, b, c, d] = ORDER[outside as usize].map(|i| corners[i as usize & 3]);
    match outside.count_ones() {
        1 => without_one([a, b, c], d, k, share, piece),
        2 => halved([a, b], [c, d], k, share, piece),
        _ => only_one(a, [b, c, d], k, share, piece),
    }
}

/// Where the plane λ_k = 0 cuts the edge from an inner to an outer corner: the shares of the edge inside and outside, and the point.
#[inline(always)]
fn crossing(inner: &Point, outer: &Point, k: usize) -> (f64, f64, Point) {
    let per_length = 1.0 / (inner.at[k] - outer.at[k]);
    let (inside, outside) = (inner.at[k] * per_length, -outer.at[k] * per_length);
    let mut at = [0.0; 4];
    for i in 0..4 {
        at[i] = outside * inner.at[i] + inside * outer.at[i];
    }
    at[k] = 0.0;
    (inside, outside, Point::new(at))
}

/// Goes on with a part that has a volume.
#[inline(always)]
fn go_on(corners: [&Point; 4], share: f64, piece: &mut Piece) {
    if share > 0.0 {
        cut(corners, share, piece);
    }
}

/// One corner is inside.
#[inline]
fn only_one(a: &Point, [b, c, d]: [&Point; 3], k: usize, share: f64, piece: &mut Piece) {
    let (ab, _, at_b) = crossing(a, b, k);
    let (ac, _, at_c) = crossing(a, c, k);
    let (ad, _, at_d) = crossing(a, d, k);
    go_on([a, &at_b, &at_c, &at_d], share * (ab * ac * ad), piece);
}

/// Two corners are inside: a wedge, in three parts.
#[inline]
fn halved([a, b]: [&Point; 2], [c, d]: [&Point; 2], k: usize, share: f64, piece: &mut Piece) {
    let (ac, not_ac, at_ac) = crossing(a, c, k);
    let (ad, not_ad, at_ad) = crossing(a, d, k);
    let (bc, _, at_bc) = crossing(b, c, k);
    let (bd, _, at_bd) = crossing(b, d, k);
    go_on([a, &at_ac, &at_ad, b], share * (ac * ad), piece);
    go_on([&at_ac, &at_ad, b, &at_bc], share * (ad * bc * not_ac), piece);
    go_on([&at_ad, b, &at_bc, &at_bd], share * (bc * bd * not_ad), piece);
}

/// One corner is outside: a frustum, in three parts.
#[inline]
fn without_one([a, b, c]: [&Point; 3], d: &Point, k: usize, share: f64, piece: &mut Piece) {
    let (ad, _, at_a) = crossing(a, d, k);
    let (bd, not_bd, at_b) = crossing(b, d, k);
    let (cd, not_cd, at_c) = crossing(c, d, k);
    go_on([a, b, c, &at_c], share * cd, piece);
    go_on([a, b, &at_c, &at_b], share * (not_cd * bd), piece);
    go_on([a, &at_b, &at_c, &at_a], share * (not_cd * not_bd * ad), piece);
}

#[cfg(test)]
mod tests;
