//! Numbers of two doubles (about 106 bits): the sphere test of points that are nearly on one sphere, between the filter in
//! doubles and exact arithmetic.
use crate::mesh::vector::Vec3;

/// An unevaluated sum, high part first (Dekker 1971).
#[derive(Clone, Copy)]
struct Twofold(f64, f64);

/// a + b exactly, |a| ≥ |b|.
#[inline(always)]
fn quick_sum(a: f64, b: f64) -> Twofold {
    let s = a + b;
    Twofold(s, b - (s - a))
}

/// a + b exactly (Knuth).
#[inline(always)]
fn sum(a: f64, b: f64) -> Twofold {
    let s = a + b;
    let c = s - a;
    Twofold(s, (a - (s - c)) + (b - c))
}

/// The determinant of the sphere test but for a power of two, in integers, which is exact, where all differences are small
/// multiples of one power of two, as on grids; else `None`.
pub fn in_sphere_on_grid(a: Vec3, b: Vec3, c: Vec3, d: Vec3, e: Vec3) -> Option<f64> {
    let row = |p: Vec3| [sum(p[0], -e[0]), sum(p[1], -e[1]), sum(p[2], -e[2])];
    let rows = [a, b, c, d].map(row);
    let most = rows.iter().flatten().fold(0.0_f64, |m, x| m.max(x.0.abs()));
    if !(1e-100..1e100).contains(&most) {
        return None;
    }
    // 23 bits: five factors and 24 terms stay below 2¹²⁶.
    let unit = f64::from_bits(most.to_bits() & 0x7ff0_0000_0000_0000) / f64::from(1 << 22);
    let mut n = [[0_i128; 3]; 4];
    for (to, from) in n.iter_mut().flatten().zip(rows.iter().flatten()) {
        let multiple = from.0 / unit;
        if from.1 != 0.0 || multiple.fract() != 0.0 {
            return None;
        }
        *to = i128::from(multiple as i64);
    }
    let [p, q, r, s] = n;
    let triple = |u: [i128; 3], v: [i128; 3], w: [i128; 3]| {
        u[2] * (v[0] * w[1] - w[0] * v[1]) - v[2] * (u[0] * w[1] - w[0] * u[1]) + w[2] * (u[0] * v[1] - v[0] * u[1])
    };
    let square = |v: [i128; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let det = square(p) * triple(q, r, s) - square(q) * triple(p, r, s) + square(r) * triple(p, q, s)
        - square(s) * triple(p, q, r);
    Some(det as f64)
}

/// Two halves of 26 bits.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

impl Twofold {
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        let s = sum(self.0, b.0);
        quick_sum(s.0, s.1 + (self.1 + b.1))
    }

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.add(Self(-b.0, -b.1))
    }

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let p = self.0 * b.0;
        let ((ah, al), (bh, bl)) = (split(self.0), split(b.0));
        let e = al * bl - (((p - ah * bh) - al * bh) - ah * bl);
        quick_sum(p, e + (self.0 * b.1 + self.1 * b.0))
    }
}

/// The sign-carrying determinant of the sphere test (see [`super::predicates::in_sphere`]), or `None` where 106 bits do not
/// decide. `scale` is the largest |Δx·Δy·Δz·(Δx² + Δy² + Δz²)|.
pub fn in_sphere(a: Vec3, b: Vec3, c: Vec3, d: Vec3, e: Vec3, scale: f64) -> Option<f64> {
    let row = |p: Vec3| [sum(p[0], -e[0]), sum(p[1], -e[1]), sum(p[2], -e[2])];
    let (p, q, r, s) = (row(a), row(b), row(c), row(d));
    type Row = [Twofold; 3];
    let minor = |u: &Row, v: &Row| u[0].mul(v[1]).sub(v[0].mul(u[1]));
    let (pq, qr, rs, sp, pr, qs) =
        (minor(&p, &q), minor(&q, &r), minor(&r, &s), minor(&s, &p), minor(&p, &r), minor(&q, &s));
    let pqr = p[2].mul(qr).sub(q[2].mul(pr)).add(r[2].mul(pq));
    let qrs = q[2].mul(rs).sub(r[2].mul(qs)).add(s[2].mul(qr));
    let rsp = r[2].mul(sp).add(s[2].mul(pr)).add(p[2].mul(rs));
    let spq = s[2].mul(pq).add(p[2].mul(qs)).add(q[2].mul(sp));
    let square = |v: &Row| v[0].mul(v[0]).add(v[1].mul(v[1])).add(v[2].mul(v[2]));
    let left = square(&r).mul(spq).sub(square(&s).mul(pqr));
    let right = square(&p).mul(qrs).sub(square(&q).mul(rsp));
    let det = left.add(right).0;
    // 24 products, each with some twenty operations of an error of at most 2⁻¹⁰²; nothing may underflow on the way.
    (det.abs() > 2e-28 * scale && scale > 1e-200 && scale < 1e200).then_some(det)
}
