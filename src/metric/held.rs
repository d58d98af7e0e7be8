//! Which metrics doubles can hold. A metric is kept and written as the six terms of M. For sizes that are too small, too large, or too
//! different these make no positive-definite tensor any more.
use super::{Error, Sym3};
use crate::tasks::{GRAIN, Team};
use std::ops::RangeInclusive;

/// Sizes h whose eigenvalues h⁻², and the products of those of three directions, are neither infinite nor subnormal.
pub const SIZES: RangeInclusive<f64> = 1e-100..=1e100;

/// Ratio of two sizes at a point that is held whatever the directions: the least eigenvalue is then 1e-13 of the greatest, a thousand times
/// the rounding of the terms.
pub const GREATEST_RATIO: f64 = 3e6;

/// ln of the ratio of eigenvalues that belongs to [`GREATEST_RATIO`].
const SPREAD: f64 = 29.828_245_693_264_77;

/// Of the spread of a logarithm that was cut, as a part.
const ROUNDING: f64 = 1e-9;

/// The pivots are known where their shares of the diagonal have no less than this product: a thousand times the rounding. What the
/// pivots before one have lost, it has lost too.
const KNOWN: f64 = 1e-13;

/// Eigenvalues of ln M up to this belong to sizes within [`SIZES`].
const SURELY: f64 = 460.0;

/// Checks that doubles hold M for each of so many ln M.
///
/// # Errors
/// [`Error::Sizes`] of the first that is not.
pub fn check(team: Team<'_>, count: usize, log: impl Fn(usize) -> Sym3 + Sync) -> Result<(), Error> {
    let is_wrong = |&v: &usize| {
        let log = log(v);
        // Frobenius' norm is no less than any eigenvalue.
        let is_small = log.contract(&log) <= SURELY * SURELY;
        !is_small && log.held_exp().is_none()
    };
    let wrong = team.chunks(GRAIN, count, |mut range| range.find(is_wrong));
    match wrong.into_iter().flatten().next() {
        Some(v) => Err(Error::Sizes { vertex: v + 1, sizes: log(v).sizes_of_log() }),
        None => Ok(()),
    }
}

impl Sym3 {
    /// Whether the eigenvalues of ln M are so close that doubles hold M. For most they are, and this test is cheap.
    #[inline]
    pub(super) fn is_narrow_log(&self) -> bool {
        // For eigenvalues of sum 0, (s₃ − s₁)² ≤ 2 Σ s².
        let s = self.plus_identity(-self.trace() / 3.0);
        2.0 * s.contract(&s) <= SPREAD * SPREAD
    }

    /// M = exp L of this L, if six doubles hold it: sizes within [`SIZES`], that are no more than [`GREATEST_RATIO`] apart, or lie along the
    /// axes so nearly that no figures are lost.
    pub fn held_exp(&self) -> Option<Self> {
        if !self.sizes_of_log().iter().all(|h| SIZES.contains(h)) {
            return None;
        }
        let m = self.exp();
        // Of the tensor scaled to a unit diagonal the determinant is that of the cosines between its rows.
        let cosines: f64 = m.pivots().into_iter().zip(0..).map(|(pivot, axis)| pivot / m.at(axis, axis)).product();
        let is_held = self.is_narrow_log()
            || self.spread_of_log() <= SPREAD * (1.0 + ROUNDING)
            || (m.is_held() && cosines >= KNOWN);
        is_held.then_some(m)
    }

    /// Difference of the greatest and the least eigenvalue.
    fn spread_of_log(&self) -> f64 {
        let [least, _, greatest] = self.eigen().values;
        greatest - least
    }

    /// Whether a tensor is positive definite in doubles, by its pivots.
    pub fn is_held(&self) -> bool {
        self.pivots().iter().all(|x| x.is_normal() && *x > 0.0)
    }

    /// ln M; where doubles do not hold M, with sizes cut to [`GREATEST_RATIO`] times the least.
    #[inline]
    pub fn held_log(self) -> Self {
        if self.is_narrow_log() { self } else { self.cut_log() }
    }

    #[cold]
    fn cut_log(self) -> Self {
        if self.held_exp().is_some() {
            return self;
        }
        let mut eigen = self.eigen();
        let least = eigen.values[2] - SPREAD;
        eigen.values = eigen.values.map(|x| x.max(least));
        Self::from_eigen(&eigen)
    }

    /// The sizes h = e^(−x/2) of ln M, x its eigenvalues: greatest first.
    pub fn sizes_of_log(&self) -> [f64; 3] {
        self.eigen().values.map(|x| (-0.5 * x).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::spd;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_cut_is_held(m in spd(13.8), wide in 0.0..80.0f64) {
            let eigen = m.eigen_spd();
            let logs = [eigen.values[0].ln() - wide, eigen.values[1].ln(), eigen.values[2].ln()];
            let log = Sym3::from_eigen(&super::super::Eigen { values: logs, ..eigen });
            let held = log.held_log();
            let exp = held.held_exp();
            prop_assert!(exp.is_some_and(|m| m.is_spd() && m.is_held()), "{:?}", exp);
            if logs[2] - logs[0] < 29.0 {
                prop_assert_eq!(held, log);
            }
        }
    }

    #[test]
    fn along_the_axes_sizes_may_differ_as_they_like_and_elsewhere_they_are_cut() {
        let log = |sizes: [f64; 3]| sizes.map(|h| -2.0 * h.ln());
        let axes = log([1e20, 1.0, 1e-3]);
        let straight = Sym3::diagonal(axes[0], axes[1], axes[2]);
        assert_eq!(straight.held_log(), straight);
        let (c, s) = (0.6, 0.8);
        let vectors = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let turned = Sym3::from_eigen(&super::super::Eigen { values: axes, vectors });
        assert_eq!(turned.held_exp(), None);
        let sizes = turned.held_log().sizes_of_log();
        for (found, expected) in sizes.into_iter().zip([GREATEST_RATIO * 1e-3, 1.0, 1e-3]) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{sizes:?}");
        }
    }

    #[test]
    fn sizes_beyond_a_double_s_squares_are_not_held() {
        for h in [1e-160, 1e-101, 1e101, 1e160] {
            assert_eq!(Sym3::ZERO.plus_identity(-2.0 * f64::ln(h)).held_exp(), None, "{h}");
        }
        for h in [1e-99, 1.0, 1e99] {
            assert!(Sym3::ZERO.plus_identity(-2.0 * f64::ln(h)).held_exp().is_some(), "{h}");
        }
        assert_eq!(Sym3::diagonal(f64::NAN, 0.0, 0.0).held_exp(), None);
    }
}
