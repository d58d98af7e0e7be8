//! Eight numbers at once: the arithmetic of the batched kernels.
//!
//! Plain arrays whose operations the compiler turns into vector instructions; the kernels that use them are compiled for the
//! baseline, for AVX2 and for AVX-512, and chosen at run time (`multiversion`). The elementary functions are polynomials
//! of our own: a call of the library's functions would take one number at a time.
//!
//! Look at the disassembly of a kernel that is new or changed (docs/decisions/kernel-speed.md):
//!
//! - A closure for `map` or `from_fn` may be compiled for the baseline. Write a loop, or the elements one by one.
//! - What is the same in all lanes is passed as a number.
//! - Operations on whole `Lanes` may become gathers. A loop over the lanes may then be vectorized.
use super::Sym3;
use crate::mesh::vector::Vec3;
use multiversion::multiversion;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers in a batch.
pub const LANES: usize = 8;

/// A number in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

/// A vector in each lane.
pub type LaneVec3 = [Lanes; 3];

/// A symmetric tensor in each lane, in the order of [`Sym3`].
pub type LaneSym3 = [Lanes; 6];

macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(std::array::from_fn(|i| self.0[i] $op other.0[i]))
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);

impl Mul<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        Self(self.0.map(|x| x * s))
    }
}

impl Add<f64> for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, s: f64) -> Self {
        Self(self.0.map(|x| x + s))
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Lanes {
    /// Zeros.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// The same number in each lane.
    #[inline(always)]
    pub const fn all(x: f64) -> Self {
        Self([x; LANES])
    }

    /// Square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    /// Absolute values.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    /// The lesser of both; `other` where self is not a number.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// The greater of both; `other` where self is not a number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// `yes` where self > limit, else `no`.
    #[inline(always)]
    pub fn above(self, limit: f64, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if self.0[i] > limit { yes.0[i] } else { no.0[i] }))
    }

    /// Self with the sign of `other`.
    #[inline(always)]
    pub fn copysign(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].copysign(other.0[i])))
    }

    /// Whether any is above the limit.
    #[inline(always)]
    pub fn any_above(self, limit: f64) -> bool {
        self.0.map(|x| x > limit).into_iter().fold(false, |any, x| any | x)
    }

    /// Whether any is below the limit.
    #[inline(always)]
    pub fn any_below(self, limit: f64) -> bool {
        self.0.map(|x| x < limit).into_iter().fold(false, |any, x| any | x)
    }

    /// Sum of all.
    #[inline(always)]
    pub fn sum(self) -> f64 {
        self.0.iter().sum()
    }

    /// e^x to 1e-15 of it, for |x| below 700.
    #[inline(always)]
    pub fn exp(self) -> Self {
        // 1.5·2^52: adding it leaves the rounded number in the low bits.
        const SHIFT: f64 = 6_755_399_441_055_744.0;
        const LN2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
        // 1/n! from n = 2: with |r| ≤ ln 2/2 the rest after n = 13 is below 1e-17.
        const TERM: [f64; 12] = [
            5e-1,
            1.666_666_666_666_666_6e-1,
            4.166_666_666_666_666_4e-2,
            8.333_333_333_333_333e-3,
            1.388_888_888_888_889e-3,
            1.984_126_984_126_984e-4,
            2.480_158_730_158_73e-5,
            2.755_731_922_398_589e-6,
            2.755_731_922_398_589e-7,
            2.505_210_838_544_172e-8,
            2.087_675_698_786_81e-9,
            1.605_904_383_682_161_3e-10,
        ];
        let shifted = self * std::f64::consts::LOG2_E + SHIFT;
        let n = shifted + -SHIFT;
        let r = self - n * LN2[0] - n * LN2[1];
        let (r2, t) = (r * r, TERM);
        let r4 = r2 * r2;
        let pair = |k: usize| r * t[k + 1] + t[k];
        let low = pair(0) + pair(2) * r2;
        let middle = pair(4) + pair(6) * r2;
        let high = pair(8) + pair(10) * r2;
        let e = (low + (middle + high * r4) * r4) * r2 + r + 1.0;
        Self(std::array::from_fn(|i| {
            e.0[i] * f64::from_bits((shifted.0[i].to_bits() << 52).wrapping_add(1.0f64.to_bits()))
        }))
    }

    /// ln x to 1e-15, for positive normal x.
    #[inline(always)]
    pub fn ln(self) -> Self {
        // x = m 2^e with m in [√½, √2): the bits are counted from those of √½.
        const HALF_ROOT: u64 = 0x3FE6_A09E_667F_3BCD;
        const MANTISSA: u64 = 0x000F_FFFF_FFFF_FFFF;
        // Bits of 2^52: a small integer in the low bits of it is that many ones above 2^52.
        const BIG: f64 = 4_503_599_627_370_496.0;
        let parts = self.0.map(|x| x.to_bits().wrapping_sub(HALF_ROOT).wrapping_add(2048 << 52));
        let exponent = Self(parts.map(|bits| f64::from_bits(bits >> 52 | BIG.to_bits()) - (BIG + 2048.0)));
        let m = Self(parts.map(|bits| f64::from_bits((bits & MANTISSA).wrapping_add(HALF_ROOT))));
        // ln m = 2 atanh((m − 1)/(m + 1)), |t| ≤ 0.1716.
        let t = (m + -1.0) / (m + 1.0);
        let t2 = t * t;
        let mut sum = Self::all(1.0 / 19.0);
        for k in (0..9).rev() {
            sum = sum * t2 + 1.0 / f64::from(2 * k + 1);
        }
        exponent * std::f64::consts::LN_2 + t * sum * 2.0
    }

    /// Cube roots of positive normal numbers to 1e-12: a guess from the exponent, then Halley's iteration, which triples the digits.
    #[inline(always)]
    pub fn cbrt(self) -> Self {
        const BIG: f64 = 4_503_599_627_370_496.0;
        // The upper half of the bits, divided by three in floating point.
        let third = self.0.map(|x| f64::from_bits(x.to_bits() >> 32 | BIG.to_bits()) - BIG).map(|x| x * (1.0 / 3.0));
        let mut y = Self(third.map(|x| f64::from_bits((x + (BIG + f64::from(0x2A9F_7893_u32))).to_bits() << 32)));
        for _ in 0..2 {
            let cube = y * y * y;
            y = y * ((cube + self * 2.0) / (cube * 2.0 + self));
        }
        y
    }
}

/// e^x of each, for |x| below 700.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub fn exponentials(x: &Lanes) -> Lanes {
    x.exp()
}

/// a − b.
#[inline(always)]
pub fn sub(a: &LaneVec3, b: &LaneVec3) -> LaneVec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a · b.
#[inline(always)]
pub fn dot(a: &LaneVec3, b: &LaneVec3) -> Lanes {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b.
#[inline(always)]
pub fn cross(a: &LaneVec3, b: &LaneVec3) -> LaneVec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The same vector in all lanes.
#[inline(always)]
pub fn everywhere(v: Vec3) -> LaneVec3 {
    [Lanes::all(v[0]), Lanes::all(v[1]), Lanes::all(v[2])]
}

/// The same tensor in all lanes.
#[inline(always)]
pub fn everywhere_tensor(m: &Sym3) -> LaneSym3 {
    let m = m.0;
    [Lanes::all(m[0]), Lanes::all(m[1]), Lanes::all(m[2]), Lanes::all(m[3]), Lanes::all(m[4]), Lanes::all(m[5])]
}

/// tr(A B).
#[inline(always)]
pub fn contract(a: &LaneSym3, b: &LaneSym3) -> Lanes {
    a[0] * b[0] + a[2] * b[2] + a[5] * b[5] + (a[1] * b[1] + a[3] * b[3] + a[4] * b[4]) * 2.0
}

/// A v.
#[inline(always)]
pub fn apply(m: &LaneSym3, v: &LaneVec3) -> LaneVec3 {
    [
        m[0] * v[0] + m[1] * v[1] + m[3] * v[2],
        m[1] * v[0] + m[2] * v[1] + m[4] * v[2],
        m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
    ]
}

/// Adds vvᵀ.
#[inline(always)]
pub fn add_dyad(g: &mut LaneSym3, v: &LaneVec3) {
    g[0] = g[0] + v[0] * v[0];
    g[1] = g[1] + v[0] * v[1];
    g[2] = g[2] + v[1] * v[1];
    g[3] = g[3] + v[0] * v[2];
    g[4] = g[4] + v[1] * v[2];
    g[5] = g[5] + v[2] * v[2];
}

/// A².
#[inline(always)]
pub fn squared(m: &LaneSym3) -> LaneSym3 {
    let [a, b, c, d, e, f] = *m;
    [
        a * a + b * b + d * d,
        a * b + b * c + d * e,
        b * b + c * c + e * e,
        a * d + b * e + d * f,
        b * d + c * e + e * f,
        d * d + e * e + f * f,
    ]
}

/// Determinant.
#[inline(always)]
pub fn det(m: &LaneSym3) -> Lanes {
    m[0] * (m[2] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[3]) + m[3] * (m[1] * m[4] - m[2] * m[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elementary_functions_of_all_magnitudes() {
        for i in -2040..2040 {
            let x = f64::from(i) * 0.3456789;
            let e = Lanes::all(x).exp().0[1];
            assert!((e / x.exp() - 1.0).abs() < 2e-15 * (1.0 + x.abs()), "exp {x}: {e}");
            let l = Lanes::all(e).ln().0[2];
            assert!((l - e.ln()).abs() < 1e-15 * (1.0 + l.abs()), "ln {e}: {l} {}", e.ln());
            let c = Lanes::all(e).cbrt().0[3];
            assert!((c / e.cbrt() - 1.0).abs() < 1e-12, "cbrt {e}: {c}");
        }
    }
}
