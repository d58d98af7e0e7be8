//! The intersection of metrics, of tensors and of whole fields.
use super::Sym3;
use super::frame::{Both, Frame, intersect};
use crate::tasks::{GRAIN, Team};
use std::cmp::Ordering;

/// A metric fits into another when their relative eigenvalues exceed 1 by no more than this: the rounding at an anisotropy of 1e6.
const ROUNDING: f64 = 1e-9;

impl Sym3 {
    /// M1 ∩ M2: the metric whose unit ball fits into both unit balls (METHOD.md §1.6). Both must be positive definite. It is exactly
    /// commutative, and where one fits into the other it is that one, to the last bit. Up to an anisotropy of 1e6 each eigenvalue is
    /// right to 1e-9 of itself for metrics given by [`Sym3::ln`] (see [`Sym3::intersect_logs`]). The least eigenvalue of a tensor
    /// itself is rounded by 1e-16 of the greatest.
    pub fn intersect(&self, other: &Self) -> Self {
        match both(self, other, Frame::of_metric) {
            Ok(one) => *one,
            Err(new) => new.metric(),
        }
    }

    /// ln (M1 ∩ M2) from ln M1 and ln M2, as [`Sym3::intersect`].
    pub fn intersect_logs(&self, other: &Self) -> Self {
        match both(self, other, Frame::of_log) {
            Ok(one) => *one,
            Err(new) => new.log(),
        }
    }
}

/// One of the two, or a new metric. The lesser in the order of the terms is always taken first, so that the result is the same both ways.
fn both<'s>(a: &'s Sym3, b: &'s Sym3, frame: impl Fn(&Sym3) -> Frame) -> Result<&'s Sym3, Frame> {
    let order = a.0.iter().zip(&b.0).map(|(x, y)| x.total_cmp(y)).find(|order| order.is_ne());
    let (a, b) = match order {
        None => return Ok(a),
        Some(Ordering::Greater) => (b, a),
        Some(_) => (a, b),
    };
    match intersect(&frame(a), &frame(b), ROUNDING) {
        Both::First => Ok(a),
        Both::Second => Ok(b),
        Both::New(new) => Err(new),
    }
}

/// Intersects ln M at each vertex with another ln M, both of shape (n,). Returns at how many vertices that changed it.
///
/// # Panics
/// When the lengths differ.
pub fn intersect_all(team: Team<'_>, logs: &mut [Sym3], others: &[Sym3]) -> usize {
    assert_eq!(logs.len(), others.len(), "as many metrics");
    let both = team.map(GRAIN / 4, logs.len(), |v| logs[v].intersect_logs(&others[v]));
    let changed = team.chunks(GRAIN, logs.len(), |range| range.filter(|&v| logs[v] != both[v]).count());
    logs.copy_from_slice(&both);
    changed.into_iter().sum()
}
