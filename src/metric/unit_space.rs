//! Space in which a metric is the unit tensor: there mean ratios need no metric.
use super::Sym3;
use super::batch::FACTOR;
use super::lanes::Lanes;
use crate::mesh::vector::Vec3;
use multiversion::multiversion;

/// The map x → Lᵀx to the space in which M = LLᵀ (Cholesky) is the unit tensor. Its determinant is positive, so it inverts nothing.
#[derive(Clone, Copy, Debug)]
pub struct UnitSpace {
    /// Rows of L: l00, l10, l11, l20, l21, l22.
    l: [f64; 6],
}

impl UnitSpace {
    /// That of a metric. Where rounding has made it singular, as may be for sizes of more than 1 : 10⁷, a tensor near it is taken.
    #[inline]
    pub fn of(m: &Sym3) -> Self {
        let m = m.0;
        let root = |pivot: f64, entry: f64| pivot.max(f64::EPSILON * entry).sqrt();
        let l00 = m[0].sqrt();
        let (l10, l20) = (m[1] / l00, m[3] / l00);
        let l11 = root(m[2] - l10 * l10, m[2]);
        let l21 = (m[4] - l20 * l10) / l11;
        let l22 = root(m[5] - l20 * l20 - l21 * l21, m[5]);
        Self { l: [l00, l10, l11, l20, l21, l22] }
    }

    /// The determinant of M.
    #[inline]
    pub fn det(&self) -> f64 {
        (self.l[0] * self.l[2] * self.l[5]).powi(2)
    }

    /// A vector there.
    #[inline(always)]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        let l = &self.l;
        [l[0] * v[0] + l[1] * v[1] + l[3] * v[2], l[2] * v[1] + l[4] * v[2], l[5] * v[2]]
    }
}

/// 1/Q of tetrahedra in this space, from six times their volumes and the sums of their squared edges: (S³/432 V²)^(1/3) (METHOD.md §1.4).
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub fn inverse_mean_ratios(volumes: &Lanes, sums: &Lanes) -> Lanes {
    *sums / (*volumes * *volumes * FACTOR).max(Lanes::all(f64::MIN_POSITIVE)).cbrt()
}

#[cfg(test)]
mod tests {
    use super::super::random::spd;
    use super::*;
    use crate::mesh::vector::dot;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lengths_there_are_those_in_the_metric(m in spd(3.0), v in prop::array::uniform3(-1.0..1.0f64)) {
            let space = UnitSpace::of(&m);
            let y = space.vector(v);
            prop_assert!((dot(y, y) - m.quadratic(v)).abs() <= 1e-9 * m.quadratic(v).max(1e-9 * m.trace()));
            prop_assert!((space.det() / m.det() - 1.0).abs() < 1e-5);
        }
    }
}
