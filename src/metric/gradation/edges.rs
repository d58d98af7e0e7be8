//! What metrics do to each other along the edges of a few vertices, or of all.
use super::TOLERANCE;
use crate::mesh::vector::{Vec3, sub};
use crate::metric::Sym3;
use crate::metric::frame::{Frame, Relative};

/// Vertices, by places in these lists.
#[derive(Clone, Copy)]
pub(in crate::metric) struct Known<'a> {
    /// Where they are, shape (n, 3).
    pub points: &'a [Vec3],
    /// Their metrics, shape (n,), always made by [`Frame::of_log`], so that a second grading starts from the same bits.
    pub frames: &'a [Frame],
    /// ln r.
    pub growth: f64,
}

impl Known<'_> {
    /// The metric of p grown to q, relative to `of_q`, the metric of q; none when it is nowhere finer.
    #[inline]
    fn excess(&self, p: u32, of_q: &Frame, q: u32) -> Option<Relative> {
        let of_p = &self.frames[p as usize];
        // A metric that is nowhere finer changes nothing.
        if of_p.roots[2] <= of_q.roots[0] {
            return None;
        }
        let e = sub(self.points[q as usize], self.points[p as usize]);
        let grown = of_p.grown(e, self.growth);
        if grown[2] <= of_q.roots[0] {
            return None;
        }
        let relative = of_q.relative(of_p, grown);
        (!relative.is_below(1.0 + TOLERANCE)).then_some(relative)
    }

    /// The least size that changes where the metric of p, grown along the edges to these vertices, is finer than theirs; none where it is not.
    #[inline]
    pub fn least_excess(&self, p: u32, ends: impl Iterator<Item = u32>) -> Option<f64> {
        let least = ends.filter_map(|q| {
            let of_q = &self.frames[q as usize];
            self.excess(p, of_q, q).map(|relative| of_q.least_excess(&relative))
        });
        least.reduce(f64::min)
    }

    /// The intersection of the metric of q, whose ln M is `log`, with those grown from the sources among its neighbours, one after the other: its
    /// ln M, and the least size that has changed; none when that is no change.
    #[inline]
    pub fn updated(&self, q: u32, log: &Sym3, sources: impl Iterator<Item = u32>) -> Option<(Sym3, f64)> {
        let (mut now, mut least_changed) = (self.frames[q as usize], f64::INFINITY);
        for p in sources {
            let excess = self.excess(p, &now, q);
            if let Some((both, least)) = excess.and_then(|relative| now.intersection(&relative, 1.0 + TOLERANCE)) {
                (now, least_changed) = (both, least_changed.min(least));
            }
        }
        let found = (least_changed < f64::INFINITY).then(|| now.log())?;
        // An intersection raises ln det M. What does not is rounding, of sizes that differ too much for double precision.
        (found.trace() - log.trace() > 0.5 * TOLERANCE).then_some((found, least_changed))
    }
}
